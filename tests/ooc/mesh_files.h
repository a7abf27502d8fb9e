#pragma once
/// What the tests of mesh files share: files made of bytes, and sinks that keep or only count.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "ooc/mesh_reader.h"

namespace cuesta::test {

/// A folder of its own for one test, removed with it.
class ScratchFolder {
 public:
  ScratchFolder() {
    static int made = 0;
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ =
        std::filesystem::temp_directory_path() / ("cuesta-" + std::string(info->name()) + "-" +
                                                  std::to_string(::getpid()) + "-" + std::to_string(++made));
    std::filesystem::create_directories(path_);
  }
  ~ScratchFolder() { std::filesystem::remove_all(path_); }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream file(path_ / name, std::ios::binary);
    EXPECT_TRUE(file << bytes) << name;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

constexpr std::uint64_t test_memory = std::uint64_t{256} << 20;

/// Loads `bytes` as a file called `name`; a failure is a test failure and an empty mesh.
inline SurfaceMesh load_bytes(const std::string& name, const std::string& bytes,
                              ReadReport* report = nullptr) {
  const ScratchFolder folder;
  auto mesh = load_mesh(folder.write(name, bytes), test_memory, report);
  if (mesh) return std::move(*mesh);
  ADD_FAILURE() << mesh.error().text();
  return {};
}
inline Error load_error(const std::string& name, const std::string& bytes,
                        std::uint64_t memory = test_memory) {
  const ScratchFolder folder;
  auto mesh = load_mesh(folder.write(name, bytes), memory);
  if (!mesh) return mesh.error();
  ADD_FAILURE() << name << " was read, expected an error";
  return {};
}

/// Counts, and checks what the header promises of every block. Gives up after `most` elements, as hostile
/// files may repeat a mesh any number of times.
class CheckingSink : public MeshSink {
 public:
  explicit CheckingSink(std::uint64_t most = std::uint64_t{1} << 28) : most_(most) {}
  Result<void> vertices(const VertexBlock& b) override {
    const std::size_t n = b.positions.size();
    EXPECT_GT(n, 0u);
    EXPECT_LE(n, 65536u);
    const auto fits = [n](std::size_t size) { return size == 0 || size == n; };
    EXPECT_TRUE(fits(b.normals.size()) && fits(b.colours.size()) && fits(b.texcoords.size()));
    vertex_count += n;
    return enough();
  }
  Result<void> triangles(TriangleBlock b) override {
    EXPECT_LE(b.size(), 65536u);
    for (const auto& t : b) highest_index = std::max({highest_index, t[0], t[1], t[2]});
    triangle_count += b.size();
    return enough();
  }
  void expect_in_range() const {
    if (triangle_count > 0) {
      EXPECT_LT(highest_index, vertex_count);
    }
  }

  std::uint64_t vertex_count = 0, triangle_count = 0, highest_index = 0;

 private:
  Result<void> enough() const {
    if (vertex_count + triangle_count <= most_) return {};
    return fail(ErrorCode::cancelled, "", "", "enough for a test");
  }
  std::uint64_t most_;
};

}  // namespace cuesta::test
