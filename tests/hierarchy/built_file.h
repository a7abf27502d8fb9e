#pragma once
/// A .cuesta file made for one test, in a folder that goes with it.

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "hierarchy/build_hierarchy.h"
#include "hierarchy/cuesta_file.h"

namespace cuesta::test {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    static std::atomic<int> count{0};
    path_ = std::filesystem::temp_directory_path() /
            ("cuesta-test-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void put_bytes(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Small cells, so that small surfaces have several rounds.
inline BuildOptions small_cells() {
  BuildOptions options;
  options.cell_triangles = 512;
  return options;
}

/// Cleans and builds; a failure is a failure of the test.
inline void build_file(SurfaceMesh surface, const std::filesystem::path& path,
                       const BuildOptions& options = small_cells()) {
  CleanReport report;
  CleanOptions clean;
  clean.make_normals = false;
  const auto mesh = clean_mesh(std::move(surface), clean, report);
  ASSERT_TRUE(mesh) << mesh.error().text();
  const auto built = build_hierarchy(*mesh, path, options);
  ASSERT_TRUE(built) << built.error().text();
}

}  // namespace cuesta::test
