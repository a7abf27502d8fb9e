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
#include "tests/ooc/grid_mesh.h"

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

/// What must not change the bytes of a file, but for the size of chunks and the step.
struct BuildWith {
  std::uint32_t chunk_triangles = 1u << 18;
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;
  std::uint64_t block_vertices = 0;
  double step = 0;  ///< of the grid, world units; 0 chooses
};

/// Ingests and builds in a work folder beside the file.
inline Result<BuildReport> try_build(const SurfaceMesh& mesh, const std::filesystem::path& path,
                                     const BuildOptions& options = small_cells(), const BuildWith& with = {},
                                     const BuildProgress& progress = {}) {
  auto folder = WorkFolder::open(path.string() + ".work", "test");
  if (!folder) return fail(folder.error());
  MemoryBudget memory(with.memory_bytes);
  const auto surface = ingest(*folder, {with.step, false, with.chunk_triangles, with.block_vertices}, memory,
                              [&](RawSurface& sink) { return feed(mesh, sink); });
  if (!surface) return fail(surface.error());
  auto report = build_hierarchy(*surface, path, options, *folder, memory, progress);
  if (report) folder->remove();
  return report;
}

/// A failure is a failure of the test.
inline void build_file(const SurfaceMesh& surface, const std::filesystem::path& path,
                       const BuildOptions& options = small_cells(), const BuildWith& with = {}) {
  const auto built = try_build(surface, path, options, with);
  ASSERT_TRUE(built) << built.error().text();
}

}  // namespace cuesta::test
