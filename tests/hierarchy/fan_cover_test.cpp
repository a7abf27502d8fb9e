/// Balls of fans: what they are around, and that they follow from mesh and script.

#include "hierarchy/fan_cover.h"

#include <gtest/gtest.h>

#include <numeric>

#include "hierarchy/bounding_sphere.h"
#include "hierarchy/simplify_cell.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {
namespace {

/// A surface as one cell, in steps of 1/1000.
CellMesh cell_of(const SurfaceMesh& surface) {
  CellMesh cell;
  for (const Vec3d& p : surface.positions) cell.positions.push_back(vec_cast<std::int32_t>(p * 1000.0));
  cell.wedge_group.resize(cell.positions.size());
  std::iota(cell.wedge_group.begin(), cell.wedge_group.end(), 0u);
  cell.locked.resize(cell.positions.size());
  cell.triangles = surface.triangles;
  cell.births.resize(cell.triangles.size());
  return cell;
}

Sphere sphere_of(const CellMesh& cell, const Fan& fan) {
  return decode_sphere(fan.sphere, cell.positions[fan.centre]);
}

TEST(FanCover, contains_the_star_of_what_goes) {
  const CellMesh cell = cell_of(bumpy_torus(40, 20));
  const SimplifyResult result = simplify_cell(cell, SimplifyOptions{400});
  // What goes first has the star of the original surface.
  std::vector<std::uint8_t> touched(cell.positions.size(), 0);
  std::size_t looked = 0;
  for (const Fan& fan : result.script.fans) {
    const Sphere ball = sphere_of(cell, fan);
    for (std::uint32_t i = 0; i < fan.child_count; ++i) {
      const std::uint32_t u = result.script.children[fan.first_child + i].vertex;
      for (const auto& t : cell.triangles) {
        if (std::find(t.begin(), t.end(), u) == t.end()) continue;
        for (const std::uint32_t v : t) {
          if (!touched[u]) {
            EXPECT_TRUE(contains(ball, {vec_cast<float>(cell.positions[v]), 0}));
            ++looked;
          }
          touched[v] = 1;
        }
      }
    }
  }
  EXPECT_GT(looked, 200u);
}

TEST(FanCover, follows_from_mesh_and_script) {
  const CellMesh cell = cell_of(bumpy_torus(40, 20));
  const SimplifyResult result = simplify_cell(cell, SimplifyOptions{100});
  Script script = result.script;
  for (Fan& fan : script.fans) fan.sphere = {};
  std::vector<std::uint32_t> changed;
  ASSERT_TRUE(cover_fans({cell.positions, cell.wedge_group, cell.triangles, {}}, script, changed));
  for (std::size_t f = 0; f < script.fans.size(); ++f)
    EXPECT_EQ(script.fans[f].sphere, result.script.fans[f].sphere) << f;
}

/// A triangle that an earlier fan changed brings that fan's ball along, and one of an earlier round its
/// birth's.
TEST(FanCover, contains_the_balls_of_births) {
  CellMesh cell = cell_of(bumpy_torus(40, 20));
  const Vec3f far{5000, 0, 0};
  for (Birth& b : cell.births) b.sphere = {far, 10};
  const SimplifyResult result = simplify_cell(cell, SimplifyOptions{400});
  ASSERT_FALSE(result.script.fans.empty());
  for (const Fan& fan : result.script.fans) EXPECT_TRUE(contains(sphere_of(cell, fan), {far, 10}));
  for (const Birth& b : result.survivors.births) EXPECT_TRUE(contains(b.sphere, {far, 10}));
}

TEST(FanCover, the_last_word_is_given) {
  const CellMesh cell = cell_of(bumpy_torus(20, 10));
  Script script = simplify_cell(cell, SimplifyOptions{50}).script;
  std::vector<std::uint32_t> changed;
  std::size_t asked = 0;
  const auto larger = [&](std::size_t fan, SphereCode follows) {
    EXPECT_EQ(fan, asked++);
    return SphereCode{static_cast<std::uint16_t>(follows.radius + 100), 1, 2, 3};
  };
  ASSERT_TRUE(cover_fans({cell.positions, cell.wedge_group, cell.triangles, {}}, script, changed, larger));
  EXPECT_EQ(asked, script.fans.size());
  for (const Fan& fan : script.fans) EXPECT_EQ(fan.sphere.offset_z, 3);
}

}  // namespace
}  // namespace cuesta::test
