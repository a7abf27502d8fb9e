/// How terrain files are looked at: up, first cameras, flights over ground, and pictures by the command.

#include <gtest/gtest.h>

#include <cmath>

#include "apps/terrain_view/ground_flight.h"
#include "apps/terrain_view/terrain_look.h"
#include "runtime/draw/picture_compare.h"
#include "runtime/draw/png_file.h"
#include "runtime/flight_file.h"
#include "tests/apps/run_program.h"
#include "tests/apps/terrain_file.h"

namespace cuesta::terrain_view {
namespace {

using test::build_terrain;
using test::hills;
using test::run;
using test::TestFolder;
using test::TestTerrain;

std::vector<Frame> frames() {
  return {Frame::ecef(), Frame::enu({46.02, 7.05, 900}).value(),
          Frame::projected(Crs::from_epsg(32632).value()).value()};
}

TerrainLook look_at(const Frame& frame) {
  return {test::facts_of(hills(), frame), relief_of(frame), false};
}

TEST(TerrainLook, ReliefAgreesWithTheFrame) {
  for (const Frame& frame :
       {Frame::ecef(), Frame::enu({46.02, 7.05, 900}).value(), Frame::enu({-70, 178, 0}).value(),
        Frame::projected(Crs::from_epsg(32632).value()).value()}) {
    const Relief relief = relief_of(frame);
    for (const double h_m : {-430.0, 0.0, 8848.0}) {
      const Geodetic at{46.3, 7.4, h_m};
      const Vec3d p = frame.position_m(at);
      EXPECT_NEAR(relief.height(p), h_m, 0.1) << frame.description();
      EXPECT_LT(length(relief.up(p) - frame.up(p)), 1e-5) << frame.description();
      const Vec3d north = normalized(frame.position_m(Geodetic{46.301, 7.4, h_m}) - p);
      EXPECT_GT(dot(relief.north(p), north), 0.999) << frame.description();
    }
  }
}

TEST(TerrainLook, FirstViewIsFromTheSouthWithLocalUp) {
  for (const Frame& frame : frames()) {
    TerrainLook look = look_at(frame);
    for (const double exaggeration : {1.0, 4.0}) {
      look.relief.exaggeration = exaggeration;
      const SurfaceMesh mesh = test::surface_of(hills(), frame);
      const View view = first_view(look, mesh.positions, {});
      const Vec3d middle = middle_of(look, mesh.positions);
      EXPECT_LT(length(view.up - frame.up(middle)), 1e-4);
      const auto [right, up, back] = view.frame();
      EXPECT_GT(dot(right, normalized(frame.position_m(Geodetic{46.025, 7.06, 1150}) -
                                      frame.position_m(Geodetic{46.025, 7.05, 1150}))),
                0.999)
          << "east is to the right";
      EXPECT_GT(frame.geodetic(view.eye).h_m, 2000);
      for (const Vec3d& p : mesh.positions) {  // all is in the picture
        const Vec3d d = look.relief.raised(p) - view.eye;
        const double ahead = -dot(d, back), k = view.pixels_per_unit() / ahead;
        ASSERT_GT(ahead, 0);
        ASSERT_LT(std::abs(k * dot(d, right)), view.width_px / 2.0);
        ASSERT_LT(std::abs(k * dot(d, up)), view.height_px / 2.0);
      }
    }
  }
}

TEST(TerrainLook, AGlobeHasItsPoleUp) {
  TerrainLook look = look_at(Frame::ecef());
  look.facts.bounds = GeoBox{-180, -90, 180, 90};
  const std::vector<Vec3d> points{
      {6.4e6, 0, 0}, {-6.4e6, 0, 0}, {0, 6.4e6, 0}, {0, -6.4e6, 0}, {0, 0, 6.4e6}};
  const View view = first_view(look, points, {});
  EXPECT_EQ(view.up, (Vec3d{0, 0, 1}));
  EXPECT_GT(view.eye.x, 1e7) << "of the meridian in the middle of the bounds";
}

TEST(TerrainLook, PlacesAsText) {
  TerrainLook look = look_at(Frame::ecef());
  look.relief.exaggeration = 5;
  const Vec3d p = look.facts.frame.position_m(Geodetic{-46.25, 7.5, 1234.5});
  EXPECT_EQ(place_text(look, p), "46.25000 S 7.50000 E, 1234.5 m");
  EXPECT_EQ(place_text(look, look.relief.lowered(look.relief.raised(p))), place_text(look, p));
}

TEST(GroundFlight, KeepsItsHeightAboveTheGround) {
  for (const Frame& frame : frames()) {
    const TestFolder folder;
    build_terrain(hills(), frame, folder / "hills.cuesta");
    auto terrain = sample::HeightSampler::open(folder / "hills.cuesta");
    ASSERT_TRUE(terrain);
    for (const double exaggeration : {1.0, 3.0}) {
      TerrainLook look = look_at(frame);
      look.relief.exaggeration = exaggeration;
      const auto flight = ground_flight(**terrain, look, {.above_ground_m = 200}, {}, 100, 30);
      ASSERT_TRUE(flight) << flight.error().text();
      EXPECT_EQ(frame_count(*flight), 100u);
      double lowest = 1e9, highest = 0, way = 0;
      std::optional<View> before;
      for (double t = 0; t < 3.3; t += 0.05) {
        const View view = flight_view(*flight, t, {});
        if (before) way += length(view.eye - before->eye);
        before = view;
        const Geodetic at = frame.geodetic(view.eye);
        const auto ground = (*terrain)->at(at.lat_lon());
        ASSERT_TRUE(ground);
        if (!*ground) continue;  // the hole
        const double above = at.h_m - exaggeration * (*ground)->at.h_m;
        lowest = std::min(lowest, above);
        highest = std::max(highest, above);
        EXPECT_GT(dot(view.up, frame.up(view.eye)), 0.9999);
        EXPECT_LT(dot(view.target - view.eye, view.up), 0) << "it looks a little down";
      }
      EXPECT_GT(lowest, 195) << frame.description();
      EXPECT_LT(highest, 200 + 250 * exaggeration);
      EXPECT_GT(way, 5000) << "most of the 7.7 km from west to east";
    }
  }
}

TEST(GroundFlight, FollowsARouteOrRefusesIt) {
  const TestFolder folder;
  build_terrain(hills(), Frame::ecef(), folder / "hills.cuesta");
  auto terrain = sample::HeightSampler::open(folder / "hills.cuesta");
  ASSERT_TRUE(terrain);
  const TerrainLook look = look_at(Frame::ecef());
  const GroundRoute route{{{46.01, 7.01}, {46.04, 7.02}, {46.04, 7.09}}, 100};
  const auto flight = ground_flight(**terrain, look, route, {}, 50, 25);
  ASSERT_TRUE(flight);
  const Geodetic first = look.facts.frame.geodetic(flight->keyframes.front().eye),
                 last = look.facts.frame.geodetic(flight->keyframes.back().eye);
  EXPECT_NEAR(first.lat_deg, 46.01, 1e-6);
  EXPECT_NEAR(last.lon_deg, 7.09, 1e-6);
  EXPECT_FALSE(ground_flight(**terrain, look, {{{46, 7}, {46, 7}}, 100}, {}, 50, 25)) << "no length";
}

class TerrainPictures : public testing::Test {
 protected:
  void SetUp() override { build_terrain(hills(), Frame::ecef(), file()); }
  std::string file() const { return folder / "hills.cuesta"; }
  Picture rendered(const std::string& name, std::vector<std::string> more) const {
    std::vector<std::string> words{"render", file(), "--size", "320x240", "--quiet", "-o", folder / name};
    words.insert(words.end(), more.begin(), more.end());
    const auto done = run(folder, std::move(words));
    EXPECT_EQ(done.status, 0) << done.err;
    auto picture = read_png(folder / name);
    EXPECT_TRUE(picture);
    return picture ? *picture : Picture{1, 1, {{}}};
  }
  TestFolder folder;
};

TEST_F(TerrainPictures, ReliefIsWhatTerrainIsDrawnWith) {
  const Picture usual = rendered("usual.png", {});
  EXPECT_GE(compare(usual, rendered("relief.png", {"--shading", "relief"})).fraction_within(0), 1);
  EXPECT_LT(compare(usual, rendered("lit.png", {"--shading", "lit"})).fraction_within(8), 0.9);
  // The low south is at the bottom, greener than the high north.
  const auto at = [&](int x, int y) { return usual.pixels[static_cast<std::size_t>(y * 320 + x)]; };
  int top = 0, bottom = 239;
  while (at(160, top) == Rgba8{255, 255, 255, 255} && top < 238) ++top;
  while (at(160, bottom) == Rgba8{255, 255, 255, 255} && bottom > top) --bottom;
  ASSERT_GT(bottom - top, 40);
  const Rgba8 north = at(160, top + 8), south = at(160, bottom - 8);
  EXPECT_GT(int{south[1]} - south[0], int{north[1]} - north[0]);
}

TEST_F(TerrainPictures, ExaggerationAndTau) {
  const std::vector<std::string> camera{"--camera",
                                        "eye 4378000,541000,4580000 target 4403800,543600,4568400"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), camera.begin(), camera.end());
    return more;
  };
  const Picture steep = rendered("steep.png", with({"--exaggerate", "3", "--tau", "0.5"}));
  const Picture exact = rendered("exact.png", with({"--exaggerate", "3", "--tau", "0"}));
  EXPECT_GE(compare(steep, exact).fraction_within(24), 0.97) << "half a pixel is half a pixel";
  EXPECT_LT(compare(exact, rendered("flat.png", with({}))).fraction_within(8), 0.98);
}

TEST_F(TerrainPictures, FlightsOverGround) {
  const auto made = run(folder, {"flight", file(), "--kind", "fly-over", "--route", "46.01", "7.02", "46.04",
                                 "7.08", "--height", "150", "--frames", "3", "-o", folder / "fly.json"});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto flight = read_flight(folder / "fly.json");
  ASSERT_TRUE(flight);
  EXPECT_EQ(frame_count(*flight), 3u);
  const auto drawn = run(folder, {"render", file(), "--flight", folder / "fly.json", "--size", "160x120",
                                  "--quiet", "-o", folder / "frames"});
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "frames/frame-00002.png"));
  for (const char* kind : {"orbit", "zoom-in"})
    EXPECT_EQ(run(folder, {"flight", file(), "--kind", kind, "-o", folder / "other.json"}).status, 0);
  EXPECT_EQ(run(folder, {"flight", file(), "--height", "9", "-o", folder / "other.json"}).status, 5);
}

TEST(TerrainOptions, AreRefusedWhereThereIsNoTerrain) {
  const TestFolder folder;
  test::build_file(test::surface_of(hills(), Frame::ecef()), folder / "mesh.cuesta");
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--shading", "relief"}, std::vector<std::string>{"--exaggerate", "2"}}) {
    std::vector<std::string> words{"render", folder / "mesh.cuesta", "-o", folder / "a.png"};
    words.insert(words.end(), more.begin(), more.end());
    const auto refused = run(folder, std::move(words));
    EXPECT_EQ(refused.status, 5);
    EXPECT_NE(refused.err.find("is no terrain"), std::string::npos) << refused.err;
  }
}

}  // namespace
}  // namespace cuesta::terrain_view
