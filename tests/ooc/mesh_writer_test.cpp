#include "ooc/mesh_writer.h"

#include "tests/ooc/mesh_files.h"

namespace cuesta {
namespace {

SurfaceMesh sample(bool attributes, double offset) {
  SurfaceMesh mesh;
  for (int i = 0; i < 300; ++i) {
    mesh.positions.push_back({offset + i * 0.25, i % 7 * 0.5, -i * 1.0});
    if (!attributes) continue;
    mesh.normals.push_back(i % 3 == 0 ? Vec3f{0, 0, 1} : i % 3 == 1 ? Vec3f{-1, 0, 0} : Vec3f{});
    const std::uint8_t level = static_cast<std::uint8_t>(i % 256);
    mesh.colours.push_back(
        {level, static_cast<std::uint8_t>(255 - level), 7, static_cast<std::uint8_t>(i % 2 ? 255 : level)});
    mesh.texcoords.push_back({static_cast<float>(i) * 0.125f, 0.25f});
  }
  for (std::uint32_t i = 0; i + 2 < 300; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  return mesh;
}

SurfaceMesh round_trip(const SurfaceMesh& mesh, const std::string& name) {
  const test::ScratchFolder folder;
  const auto written = write_mesh(folder / name, mesh);
  EXPECT_TRUE(written) << written.error().text();
  EXPECT_FALSE(std::filesystem::exists(folder / (name + ".part")));
  auto read = load_mesh(folder / name, test::test_memory);
  EXPECT_TRUE(read) << read.error().text();
  return read ? std::move(*read) : SurfaceMesh{};
}

void expect_equal(const SurfaceMesh& a, const SurfaceMesh& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.colours, b.colours);
  EXPECT_EQ(a.texcoords, b.texcoords);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(MeshWriter, WhatIsWrittenIsReadBackEqual) {
  for (const char* name : {"a.ply", "a.obj", "a.glb", "A.PLY"}) {
    for (const bool attributes : {false, true}) {
      SCOPED_TRACE(name);
      const SurfaceMesh mesh = sample(attributes, 0);
      expect_equal(round_trip(mesh, name), mesh);
    }
  }
}

TEST(MeshWriter, PositionsThatNeedDoubleKeepIt) {
  const SurfaceMesh mesh = sample(false, 500'000.1);
  expect_equal(round_trip(mesh, "a.ply"), mesh);
  expect_equal(round_trip(mesh, "a.obj"), mesh);
  const SurfaceMesh glb =
      round_trip(mesh, "a.glb");  // f32 about the centre: within half a float's step of 150
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    EXPECT_LT(length(glb.positions[i] - mesh.positions[i]), 3e-5);
}

TEST(MeshWriter, EmptyMeshesAndOtherExtensions) {
  for (const char* name : {"a.ply", "a.glb"}) EXPECT_TRUE(round_trip({}, name).positions.empty());
  const test::ScratchFolder folder;
  const auto refused = write_mesh(folder / "a.stl", {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
}

TEST(MeshWriter, AFolderThatIsNotThereIsAnError) {
  const auto refused = write_mesh("/no/such/folder/a.ply", sample(false, 0));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::not_found);
}

}  // namespace
}  // namespace cuesta
