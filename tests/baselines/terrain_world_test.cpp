/// Where the judge of terrain takes its postings to be: wrong places would make it worthless.

#include "tools/bench/terrain_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "terrain/terrain_metadata.h"
#include "tests/hierarchy/built_file.h"

namespace cuesta::test {
namespace {

using bench::Rasters;
using bench::TerrainWorld;

/// 3 columns, 2 rows; the middle of the second has no data.
class TerrainWorldOf : public testing::Test {
 protected:
  Rasters rasters(const std::string& sidecar) {
    const std::int16_t heights[6] = {100, 200, 300, 400, -9999, 600};
    std::ofstream(path(), std::ios::binary).write(reinterpret_cast<const char*>(heights), sizeof heights);
    put_bytes(path() + ".json", sidecar);
    const std::string paths[] = {path()};
    auto opened = bench::open_rasters(paths);
    EXPECT_TRUE(opened) << opened.error().text();
    return std::move(*opened);
  }
  std::string path() const { return (folder_ / "six.i16").string(); }

  static std::string metadata(const Frame& frame, VerticalDatum heights = VerticalDatum::unknown) {
    TerrainFacts facts;
    facts.frame = frame;
    facts.heights = heights;
    return "{\"terrain\": " + terrain_json(facts) + "}";
  }

  TemporaryFolder folder_;
};

const std::string placed =
    R"({"width": 3, "height": 2, "no_data": -9999, "epsg": 32632, "vertical_datum": "orthometric",
        "placement": {"x": 500000, "y": 5000000, "x_spacing": 30, "y_spacing": 30}})";

TEST_F(TerrainWorldOf, a_file_without_a_frame_is_on_the_plane_of_its_rasters) {
  const Rasters own = rasters(placed);
  const auto world = TerrainWorld::of("{}", own, "");
  ASSERT_TRUE(world);
  EXPECT_FALSE(world->up());
  EXPECT_EQ(world->position_m(0, 2, 1, 600), (Vec3d{500'060, 4'999'970, 600}));
}

TEST_F(TerrainWorldOf, a_frame_of_another_system_is_gone_into) {
  const Rasters own = rasters(placed);
  const Crs zone32 = Crs::from_epsg(32632).value(), zone33 = Crs::from_epsg(32633).value();
  const PlanePoint p{500'060, 4'999'970};
  for (const Frame& frame :
       {Frame::projected(zone32).value(), Frame::projected(zone33).value(), Frame::ecef()}) {
    const auto world = TerrainWorld::of(metadata(frame), own, "");
    ASSERT_TRUE(world) << world.error().text();
    const LatLon at = zone32.lat_lon(p);
    const Vec3d expected = frame.position_m(Geodetic{at.lat_deg, at.lon_deg, 600});
    const Vec3d found = world->position_m(0, 2, 1, 600);
    EXPECT_LT(length(found - expected), 1e-5) << frame.description();
    ASSERT_EQ(static_cast<bool>(world->up()), frame.kind() == FrameKind::ecef);
    if (!world->up()) continue;
    EXPECT_LT(length(world->up()(found) - frame.up(found)), 1e-15);
  }
}

TEST_F(TerrainWorldOf, heights_of_the_other_kind_need_a_geoid) {
  const Rasters own = rasters(placed);
  EXPECT_TRUE(TerrainWorld::of(metadata(Frame::ecef(), VerticalDatum::orthometric), own, ""));
  const auto world =
      TerrainWorld::of(metadata(Frame::ecef(), VerticalDatum::ellipsoidal), own, "/nowhere.pgm");
  ASSERT_FALSE(world);
  EXPECT_EQ(world.error().code, ErrorCode::not_found) << world.error().text();
}

TEST_F(TerrainWorldOf, all_postings_are_visited_in_order) {
  const Rasters own = rasters(placed);
  const Frame zone32 = Frame::projected(Crs::from_epsg(32632).value()).value();
  const auto world = TerrainWorld::of(metadata(zone32), own, "");
  ASSERT_TRUE(world) << world.error().text();
  std::vector<Vec3d> all;
  ASSERT_TRUE(world->visit_postings(
      [&](std::span<const Vec3d> postings) { all.insert(all.end(), postings.begin(), postings.end()); }));
  ASSERT_EQ(all.size(), 6u);
  EXPECT_EQ(all[2], (Vec3d{500'060, 5'000'000, 300}));
  EXPECT_EQ(all[3], (Vec3d{500'000, 4'999'970, 400}));
  EXPECT_TRUE(std::isnan(all[4].z));
  EXPECT_EQ(all[5], (Vec3d{500'060, 4'999'970, 600}));
}

}  // namespace
}  // namespace cuesta::test
