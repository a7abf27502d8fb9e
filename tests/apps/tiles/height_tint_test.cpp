/// Colours of heights: those of the relief's ramps, and of a terrain without colours only.

#include "apps/tiles/height_tint.h"

#include <algorithm>

#include "ooc/mesh_reader.h"
#include "tests/apps/tiles/made_tiles.h"

namespace cuesta {
namespace {

using tiles::HeightTint;

TerrainFacts heights(double least_m, double most_m, double sea_level_m) {
  TerrainFacts facts;
  facts.least_m = least_m;
  facts.most_m = most_m;
  facts.sea_level_m = sea_level_m;
  return facts;
}

Grid metres() {
  Grid grid;
  grid.step = 1;
  return grid;
}

TEST(HeightTint, ends_of_the_ramps) {
  const HeightTint inland(heights(210, 1210, 0), metres());
  EXPECT_EQ(inland.colour(210), (Rgba8{97, 132, 85, 255}));
  EXPECT_EQ(inland.colour(1210), (Rgba8{246, 248, 250, 255}));
  EXPECT_EQ(inland.colour(9000), inland.colour(1210));
  const HeightTint coast(heights(-100, 500, 20), metres());
  EXPECT_EQ(coast.colour(-100), (Rgba8{29, 69, 121, 255}));
  EXPECT_EQ(coast.colour(-5000), coast.colour(-100));
  EXPECT_EQ(coast.colour(500), inland.colour(1210));
  EXPECT_EQ(coast.colour(20.5), coast.colour(20));  // the shore is as wide as a step of the grid
  EXPECT_GT(coast.colour(20)[2], coast.colour(20)[0]);
  EXPECT_GT(coast.colour(22)[1], coast.colour(22)[2]);
}

TEST(HeightTint, contents_of_terrain_have_the_colours_of_their_heights) {
  test::TemporaryFolder folder;
  test::build_terrain(test::hills(), Frame::ecef(), folder / "hills.cuesta");
  test::build_file(test::bumpy_sphere(20, 30), folder / "sphere.cuesta");
  for (const char* name : {"hills.cuesta", "sphere.cuesta"}) {
    auto producer = test::open_tiles(folder / name, {});
    auto root = producer->root();
    ASSERT_TRUE(root && *root);
    std::vector<Rgba8> expected;
    const auto facts = terrain_facts(producer->directory().metadata);
    ASSERT_TRUE(facts);
    if (*facts) {
      const HeightTint tint(**facts, producer->directory().grid);
      for (const DrawVertex& v : (*root)->mesh.vertices)
        expected.push_back(tint.colour(producer->placement().geodetic({v.x, v.y, v.z}).h_m));
    }
    const auto bytes = producer->content(std::move(**root));
    test::put_bytes(folder / "root.glb", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const auto mesh = load_mesh(folder / "root.glb", std::uint64_t{1} << 30);
    ASSERT_TRUE(mesh) << mesh.error().text();
    ASSERT_EQ(mesh->colours.size(), expected.size()) << name;
    // Linear light in 8 bits, as sRGB again; in the order of drawing.
    std::vector<Rgba8> found(mesh->colours.begin(), mesh->colours.end());
    std::sort(found.begin(), found.end());
    std::sort(expected.begin(), expected.end());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i][0], expected[i][0], 4) << name;
  }
}

}  // namespace
}  // namespace cuesta
