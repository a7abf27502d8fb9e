/// Several files into one surface: offsets, attributes that only some have, budget, progress.

#include <string>
#include <vector>

#include "tests/ooc/mesh_files.h"

namespace cuesta {
namespace {

using Paths = std::vector<std::filesystem::path>;

const std::string plain = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string coloured =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float nx\nproperty float ny\n"
    "property float nz\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "5 0 0 9 8 7 0 0 1\n6 0 0 9 8 7 0 0 1\n6 1 0 9 8 7 0 0 1\n5 1 0 9 8 7 0 0 1\n3 0 1 3\n";

TEST(LoadMeshes, VerticesAndTrianglesFollowInOrder) {
  const test::ScratchFolder folder;
  const Paths paths{folder.write("a.obj", plain), folder.write("b.ply", coloured),
                    folder.write("c.obj", plain)};
  const auto loaded = load_meshes(paths, test::test_memory);
  ASSERT_TRUE(loaded) << loaded.error().text();
  const SurfaceMesh& mesh = loaded->mesh;
  EXPECT_TRUE(is_consistent(mesh));
  using T = std::array<std::uint32_t, 3>;
  EXPECT_EQ(mesh.triangles, (std::vector<T>{{0, 1, 2}, {3, 4, 6}, {7, 8, 9}}));
  EXPECT_EQ(mesh.positions[6], (Vec3d{5, 1, 0}));
  ASSERT_EQ(loaded->files.size(), 3u);
  EXPECT_EQ(loaded->files[1].vertices, 4u);
}

TEST(LoadMeshes, AttributesAnyFileHasAreKeptAndTheRestCounted) {
  const test::ScratchFolder folder;
  const auto a = folder.write("a.obj", plain), b = folder.write("b.ply", coloured);
  for (const Paths& paths : {Paths{a, b}, Paths{b, a}}) {
    const auto loaded = load_meshes(paths, test::test_memory);
    ASSERT_TRUE(loaded);
    const std::size_t without = paths[0] == a ? 0 : 4, with = paths[0] == a ? 3 : 0;
    EXPECT_EQ(loaded->mesh.colours[without], (Rgba8{255, 255, 255, 255}));
    EXPECT_EQ(loaded->mesh.colours[with], (Rgba8{9, 8, 7, 255}));
    EXPECT_EQ(loaded->mesh.normals[without], Vec3f{});
    EXPECT_EQ(loaded->mesh.normals[with], (Vec3f{0, 0, 1}));
    EXPECT_TRUE(loaded->mesh.texcoords.empty());
    EXPECT_EQ(loaded->missing.normals, 3u);
    EXPECT_EQ(loaded->missing.colours, 3u);
    EXPECT_EQ(loaded->missing.texcoords, 0u);
  }
  const auto all = load_meshes(Paths{b, b}, test::test_memory);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->missing.normals + all->missing.colours, 0u);
}

TEST(LoadMeshes, AMissingFileIsToldBeforeTheFirstIsRead) {
  const test::ScratchFolder folder;
  bool read = false;
  const auto loaded = load_meshes(Paths{folder.write("a.obj", plain), folder / "gone.ply"}, test::test_memory,
                                  [&](std::uint64_t, std::uint64_t) { return read = true; });
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::not_found);
  EXPECT_NE(loaded.error().file.find("gone.ply"), std::string::npos);
  EXPECT_FALSE(read);
}

TEST(LoadMeshes, TheBudgetHoldsForAllAndReadersGiveTheirsBack) {
  std::string large;
  for (int i = 0; i < 20'000; ++i) large += "v 1 2 3\n";
  const test::ScratchFolder folder;
  const auto path = folder.write("a.obj", large + "f 1 2 3\n");
  const auto fits = [&](std::size_t count, std::uint64_t memory) {
    const auto loaded = load_meshes(Paths(count, path), memory);
    if (!loaded) {
      EXPECT_EQ(loaded.error().code, ErrorCode::out_of_budget);
    }
    return loaded.has_value();
  };
  std::uint64_t one = 1 << 16;
  while (!fits(1, one)) one += one / 8;
  EXPECT_TRUE(fits(4, 8 * one));  // while arrays move they are held twice
  EXPECT_FALSE(fits(40, 8 * one));
  // What a reader held is charged once, not once per file: 24 bytes per vertex stay, half as much more while
  // growing.
  EXPECT_TRUE(fits(40, 40 * 20'000 * 24 * 5 / 2 + one));
}

TEST(LoadMeshes, ProgressIsOverAllFilesAndCancels) {
  std::string large = "OFF\n70000 1 0\n";
  for (int i = 0; i < 70'000; ++i) large += "0 1 2\n";
  const test::ScratchFolder folder;
  const auto path = folder.write("a.off", large + "3 0 1 2\n");
  const std::uint64_t size = std::filesystem::file_size(path);
  std::uint64_t last = 0;
  ASSERT_TRUE(
      load_meshes(Paths{path, path, path}, test::test_memory, [&](std::uint64_t done, std::uint64_t total) {
        EXPECT_EQ(total, 3 * size);
        EXPECT_GE(done, last);
        last = done;
        return true;
      }));
  EXPECT_GT(last, 2 * size);
  const auto stopped = load_meshes(Paths{path, path}, test::test_memory,
                                   [&](std::uint64_t done, std::uint64_t) { return done < size; });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace cuesta
