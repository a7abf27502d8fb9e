#include "apps/sample/height_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>

#include "apps/sample/point_list.h"
#include "tests/apps/run_program.h"
#include "tests/apps/terrain_file.h"
#include "tests/ooc/small_meshes.h"

namespace cuesta::sample {
namespace {

using test::build_terrain;
using test::hills;
using test::TemporaryFolder;
using test::TestTerrain;

std::vector<Frame> frames() {
  return {Frame::ecef(), Frame::enu({46.02, 7.05, 900}).value(),
          Frame::projected(Crs::from_epsg(32632).value()).value()};
}

double sampled(HeightSampler& terrain, LatLon at) {
  const auto found = terrain.at(at);
  EXPECT_TRUE(found) << found.error().text();
  return found && *found ? (*found)->at.h_m : std::numeric_limits<double>::quiet_NaN();
}

TEST(HeightSampler, PostingsHaveTheirHeights) {
  const TestTerrain terrain = hills();
  for (const Frame& frame : frames()) {
    const TemporaryFolder folder;
    build_terrain(terrain, frame, folder / "hills.cuesta");
    auto sampler = HeightSampler::open(folder / "hills.cuesta");
    ASSERT_TRUE(sampler) << sampler.error().text();
    const double step = CuestaFile::open(folder / "hills.cuesta")->directory().grid.step;
    double worst_m = 0;
    int holes = 0;
    for (int row = 0; row < terrain.rows; ++row)
      for (int column = 0; column < terrain.columns; ++column) {
        const LatLon at = terrain.place(column, row);
        const double wanted = terrain.height_m(at), got = sampled(**sampler, at);
        if (std::isnan(wanted)) {
          holes += std::isnan(got) ? 1 : 0;
          continue;
        }
        worst_m = std::max(worst_m, std::isnan(got) ? 1e9 : std::abs(got - wanted));
      }
    // A vertex moves by up to 0.87 steps, and the ground under the line by its slope times that.
    EXPECT_LT(worst_m, 2 * step) << frame.description() << ", step " << step;
    EXPECT_GT(holes, 20);
  }
}

/// Linear on the triangle of the grid that `at` is in; heights of its corners.
double linear_height(const TestTerrain& t, LatLon at) {
  const double u = (at.lon_deg - t.box.west_deg) / (t.box.east_deg - t.box.west_deg) * (t.columns - 1);
  const double v = (t.box.north_deg - at.lat_deg) / (t.box.north_deg - t.box.south_deg) * (t.rows - 1);
  const int column = std::min(static_cast<int>(u), t.columns - 2),
            row = std::min(static_cast<int>(v), t.rows - 2);
  const double x = u - column, y = v - row;
  const double a = t.height_m(t.place(column, row)), b = t.height_m(t.place(column + 1, row)),
               c = t.height_m(t.place(column, row + 1)), d = t.height_m(t.place(column + 1, row + 1));
  if (std::isnan(a + b + c + d)) return std::numeric_limits<double>::quiet_NaN();
  return y > x ? a + (c - a) * y + (d - c) * x : a + (b - a) * x + (d - b) * y;
}

TEST(HeightSampler, BetweenPostingsItIsLinear) {
  const TestTerrain terrain = hills();
  for (const Frame& frame : frames()) {
    const TemporaryFolder folder;
    build_terrain(terrain, frame, folder / "hills.cuesta");
    auto sampler = HeightSampler::open(folder / "hills.cuesta");
    ASSERT_TRUE(sampler) << sampler.error().text();
    const double step = CuestaFile::open(folder / "hills.cuesta")->directory().grid.step;
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> lat(46, 46.05), lon(7, 7.1);
    int compared = 0;
    for (int i = 0; i < 3000; ++i) {
      const LatLon at{lat(random), lon(random)};
      const double wanted = linear_height(terrain, at), got = sampled(**sampler, at);
      if (std::isnan(wanted) || std::isnan(got)) {
        EXPECT_TRUE(std::isnan(wanted) && std::isnan(got)) << at.lat_deg << " " << at.lon_deg;
        continue;
      }
      // Meridians converge, so cells of the frame are not quite those of the grid: 0.05 m on these hills.
      EXPECT_NEAR(got, wanted, 2 * step + 0.05) << frame.description();
      ++compared;
    }
    EXPECT_GT(compared, 2500);
  }
}

TEST(HeightSampler, NothingOutside) {
  const TemporaryFolder folder;
  build_terrain(hills(), Frame::ecef(), folder / "hills.cuesta");
  auto sampler = HeightSampler::open(folder / "hills.cuesta");
  ASSERT_TRUE(sampler);
  for (const LatLon at : {LatLon{46.0501, 7.05}, LatLon{46.02, 6.9999}, LatLon{-46.02, -172.95},
                          LatLon{90, 0}, LatLon{0, 0}, LatLon{46.025, 7.05}})
    EXPECT_TRUE(std::isnan(sampled(**sampler, at))) << at.lat_deg << " " << at.lon_deg;
  EXPECT_FALSE(std::isnan(sampled(**sampler, {46.02, 367.02}))) << "longitudes wrap around";
}

TEST(HeightSampler, CoordinatesOfAnyProjection) {
  const TestTerrain terrain = hills();
  const Crs utm = Crs::from_epsg(32632).value(), web = Crs::from_epsg(3857).value();
  for (const Frame& frame : frames()) {
    const TemporaryFolder folder;
    build_terrain(terrain, frame, folder / "hills.cuesta");
    auto sampler = HeightSampler::open(folder / "hills.cuesta");
    ASSERT_TRUE(sampler);
    const LatLon at = terrain.place(7, 9);
    for (const Crs& crs : {utm, web}) {
      const auto found = (*sampler)->at(crs, crs.coordinates(at));
      ASSERT_TRUE(found && *found);
      EXPECT_NEAR((*found)->at.h_m, terrain.height_m(at), 2);
      EXPECT_NEAR((*found)->at.lat_deg, at.lat_deg, 1e-6);
      EXPECT_LT(length((*found)->position_m - frame.position_m((*found)->at)), 1e-4);
    }
  }
}

TEST(FinestSurface, ReadsOnlyWhatASegmentMayMeet) {
  const TemporaryFolder folder;
  TestTerrain terrain = hills();
  terrain.columns = terrain.rows = 121;
  const Frame frame = Frame::ecef();
  build_terrain(terrain, frame, folder / "hills.cuesta");
  const auto file = CuestaFile::open(folder / "hills.cuesta");
  ASSERT_TRUE(file);
  FinestSurface surface(*file);
  const auto hit =
      surface.meet(frame.position_m(Geodetic{46.01, 7.01, 0}), frame.position_m({46.01, 7.01, 3000}));
  ASSERT_TRUE(hit && *hit);
  EXPECT_GE(surface.pages_read(), 1u);
  EXPECT_LE(surface.pages_read(), 4u) << "of " << file->directory().pages.size();
  const std::uint64_t before = surface.pages_read();
  ASSERT_TRUE(
      surface.meet(frame.position_m(Geodetic{46.01, 7.01, 0}), frame.position_m({46.01, 7.01, 3000})));
  EXPECT_EQ(surface.pages_read(), before) << "they are kept";
}

TEST(FinestSurface, NearestToTheEndOfTheSegment) {
  const TemporaryFolder folder;
  test::build_file(test::joined(test::cube(), test::cube({0, 0, 3})), folder / "cubes.cuesta");
  const auto file = CuestaFile::open(folder / "cubes.cuesta");
  ASSERT_TRUE(file);
  FinestSurface surface(*file);
  const auto z_of = [&](Vec3d from, Vec3d to) {
    return surface.meet(from, to).value().value_or(Vec3d{0, 0, -99}).z;
  };
  EXPECT_NEAR(z_of({0.3, 0.6, -1}, {0.3, 0.6, 9}), 4, 0.1);
  EXPECT_NEAR(z_of({0.3, 0.6, 9}, {0.3, 0.6, -1}), 0, 0.1);
  EXPECT_NEAR(z_of({0.3, 0.6, -1}, {0.3, 0.6, 2}), 1, 0.1);
  EXPECT_NEAR(z_of({0.5, 0.5, -1}, {0.5, 0.5, 9}), 4, 0.1) << "on a diagonal";
  EXPECT_EQ(z_of({0.3, 0.6, 1.5}, {0.3, 0.6, 2.5}), -99);
  EXPECT_EQ(z_of({3, 0.6, -1}, {3, 0.6, 9}), -99);
}

TEST(PointList, AsPeopleWriteThem) {
  const std::vector<std::string> words{"46.5", "-7.25", "1e1,+2", "3;4"};
  const auto pairs = pairs_of_words(words);
  ASSERT_TRUE(pairs);
  ASSERT_EQ(pairs->size(), 3u);
  EXPECT_EQ((*pairs)[0].second, -7.25);
  EXPECT_EQ((*pairs)[1].first, 10);
  EXPECT_EQ((*pairs)[1].second, 2);
  EXPECT_EQ((*pairs)[2].second, 4);
  for (const std::vector<std::string>& bad :
       {std::vector<std::string>{"1"}, {"1", "north"}, {"1", "nan"}, {"1", "2e999"}})
    EXPECT_FALSE(pairs_of_words(bad)) << bad.back();
  std::istringstream lines("# summits\n45.8326 6.8652 Mont Blanc\n\n45.9763,7.6586\r\n");
  const auto of_lines = pairs_of_lines(lines, "summits.txt");
  ASSERT_TRUE(of_lines);
  ASSERT_EQ(of_lines->size(), 2u);
  EXPECT_EQ((*of_lines)[1].second, 7.6586);
  std::istringstream bad("1 2\n3\n");
  const auto refused = pairs_of_lines(bad, "bad.txt");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().place, "line 2");
  EXPECT_FALSE(place_of({91, 0}));
  EXPECT_FALSE(place_of({0, 400}));
}

TEST(SampleCommand, TellsHeightDatumAndPlace) {
  const test::TestFolder folder;
  const TestTerrain terrain = hills();
  build_terrain(terrain, Frame::projected(Crs::from_epsg(32632).value()).value(), folder / "hills.cuesta");
  const auto text = run(folder, {"sample", folder / "hills.cuesta", "46.05", "7", "46.025,7.05"});
  ASSERT_EQ(text.status, 0) << text.err;
  EXPECT_NE(text.out.find(" m ellipsoidal (geoid egm96-15)"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("46.025 7.05  no data there"), std::string::npos) << text.out;
  std::ofstream(folder / "points.txt") << "46.05 7\n46.025 7.05\n";
  const auto out =
      run(folder, {"sample", folder / "hills.cuesta", "--from", folder / "points.txt", "--json"});
  ASSERT_EQ(out.status, 0) << out.err;
  const auto json = nlohmann::json::parse(out.out);
  ASSERT_EQ(json["points"].size(), 2u);
  EXPECT_NEAR(json["points"][0]["height_m"].get<double>(), terrain.height_m({46.05, 7}),
              2);  // at the border, up to the step
  EXPECT_TRUE(json["points"][1]["height_m"].is_null());
  const Vec3d p = Frame::projected(Crs::from_epsg(32632).value())->position_m(Geodetic{46.05, 7, 0});
  const auto xy = run(folder, {"sample", folder / "hills.cuesta", "--xy", std::to_string(p.x + 50),
                               std::to_string(p.y - 90), "--json"});
  ASSERT_EQ(xy.status, 0) << xy.err;
  EXPECT_NEAR(nlohmann::json::parse(xy.out)["points"][0]["lat"].get<double>(), 46.05, 0.002);
}

TEST(SampleCommand, RefusesWhatIsNoTerrain) {
  const test::TestFolder folder;
  test::build_file(test::cube(), folder / "cube.cuesta");
  const auto cube = run(folder, {"sample", folder / "cube.cuesta", "1", "2"});
  EXPECT_EQ(cube.status, 5);
  EXPECT_NE(cube.err.find("is no terrain"), std::string::npos) << cube.err;
  build_terrain(hills(), Frame::ecef(), folder / "hills.cuesta");
  EXPECT_EQ(run(folder, {"sample", folder / "hills.cuesta", "7"}).status, 5);
  EXPECT_EQ(run(folder, {"sample", folder / "hills.cuesta", "91", "7"}).status, 5);
  EXPECT_EQ(run(folder, {"sample", folder / "hills.cuesta", "--xy", "1", "7"}).status, 5) << "no projection";
  EXPECT_EQ(run(folder, {"sample", folder / "hills.cuesta"}).status, 1);
  EXPECT_EQ(run(folder, {"sample", folder / "hills.cuesta", "--from", "nowhere.txt"}).status, 2);
}

}  // namespace
}  // namespace cuesta::sample
