/// The viewer's parts that need no window: keys, recorded flights, shares of budgets, rays, statistics.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "apps/view/budget_shares.h"
#include "apps/view/flight_player.h"
#include "apps/view/flight_recorder.h"
#include "apps/view/statistics_text.h"
#include "apps/view/surface_ray.h"
#include "apps/view/view_keys.h"
#include "apps/view/view_script.h"

namespace cuesta::test {
namespace {

using namespace cuesta::view;

TEST(ViewKeys, NamesKeysAndActionsMeet) {
  const auto press = [](const std::string& name, bool control = false) {
    WindowEvent e;
    e.kind = WindowEvent::Kind::key_down;
    e.key = key_named(name);
    e.control = control;
    return action_of(e);
  };
  EXPECT_EQ(press("h"), Action::help);
  EXPECT_EQ(press("f1"), Action::help);
  EXPECT_EQ(press("f12"), Action::screenshot);
  EXPECT_EQ(press("["), Action::tau_finer);
  EXPECT_EQ(press("space"), Action::play);
  EXPECT_EQ(press("home"), Action::fit);
  EXPECT_EQ(press("q", true), Action::quit);
  for (const char* moves : {"w", "a", "s", "d", "q", "e", "up", "left"})
    EXPECT_EQ(press(moves), Action::none) << moves;
  EXPECT_EQ(key_named("f13"), Key::unknown);
  EXPECT_EQ(key_named("nonsense"), Key::unknown);
}

TEST(ViewKeys, HelpFitsAnOrdinaryWindow) {
  EXPECT_LT(help_lines().size(), 45u);
  for (const std::string& line : help_lines()) {
    EXPECT_LT(line.size(), 60u) << line;
    for (const char c : line) EXPECT_TRUE(c >= ' ' && c <= '~') << line;
  }
}

View at(double x) {
  View view;
  view.eye = {x, 0, 10};
  view.target = {x, 0, 0};
  return view;
}

TEST(FlightRecorder, PlaysBackWhatWasFlown) {
  FlightRecorder recorder;
  recorder.start(100);
  for (int i = 0; i <= 200; ++i) recorder.add(100 + i * 0.016, at(i * 0.016 * 2));
  const auto flight = recorder.finish();
  ASSERT_TRUE(flight);
  EXPECT_FALSE(recorder.recording());
  EXPECT_LE(flight->keyframes.size(), 34u);
  EXPECT_EQ(flight->keyframes.front().time_s, 0);
  EXPECT_NEAR(flight->keyframes.back().time_s, 3.2, 1e-9);
  for (const double t : {0.0, 0.5, 1.234, 3.2})
    EXPECT_NEAR(flight_view(*flight, t, at(0)).eye.x, 2 * t, 1e-6) << t;
}

TEST(FlightRecorder, APauseIsAPause) {
  FlightRecorder recorder;
  recorder.start(0);
  recorder.add(0, at(0));
  for (int i = 1; i <= 10; ++i) recorder.add(0.1 * i, at(0.1 * i));
  // Nothing is added while the viewer rests; then it goes on.
  for (int i = 0; i <= 10; ++i) recorder.add(5 + 0.1 * i, at(1 + 0.1 * i));
  const auto flight = recorder.finish();
  ASSERT_TRUE(flight);
  for (const double t : {2.0, 3.0, 4.5}) EXPECT_NEAR(flight_view(*flight, t, at(0)).eye.x, 1, 0.06) << t;
  EXPECT_NEAR(flight_view(*flight, 6, at(0)).eye.x, 2, 0.01);
  for (std::size_t i = 1; i < flight->keyframes.size(); ++i)
    EXPECT_GT(flight->keyframes[i].time_s, flight->keyframes[i - 1].time_s);
}

TEST(FlightRecorder, NothingRecordedIsNoFlight) {
  FlightRecorder recorder;
  recorder.add(1, at(1));
  EXPECT_FALSE(recorder.finish());
  recorder.start(0);
  recorder.add(0, at(1));
  const auto still = recorder.finish();
  ASSERT_TRUE(still);
  EXPECT_EQ(still->keyframes.size(), 1u);
}

TEST(FlightPlayer, EndsWhereTheFlightEnds) {
  FlightPlayer player;
  EXPECT_FALSE(player.has_flight());
  player.set({30, {{0, {0, 0, 10}, {0, 0, 0}}, {2, {4, 0, 10}, {4, 0, 0}}}});
  EXPECT_FALSE(player.playing());
  player.start(100);
  EXPECT_NEAR(player.view(101, {}).eye.x, 2, 1e-9);
  EXPECT_TRUE(player.playing());
  EXPECT_NEAR(player.view(103, {}).eye.x, 4, 1e-9);
  EXPECT_FALSE(player.playing());
}

TEST(ViewScript, GoesStepByStep) {
  auto script = ViewScript::of({"x f2", true, true, true}).value();
  EXPECT_EQ(script.next(true), ScriptStep::press);
  EXPECT_EQ(script.key(), key_of('X'));
  EXPECT_EQ(script.next(true), ScriptStep::press);
  EXPECT_EQ(script.key(), Key::f2);
  EXPECT_EQ(script.next(false), ScriptStep::fly) << "keys and flights do not wait";
  EXPECT_EQ(script.next(false), ScriptStep::none) << "a picture does";
  EXPECT_TRUE(script.busy());
  EXPECT_EQ(script.next(true), ScriptStep::picture);
  EXPECT_EQ(script.next(true), ScriptStep::close);
  EXPECT_FALSE(script.busy());
  EXPECT_EQ(ViewScript::of({"x f99", false, false, false}).error().code, ErrorCode::invalid_input);
}

TEST(BudgetShares, SumsNeverExceedTheWhole) {
  const Budgets total{.adapt_ms = 4, .triangles = 1000001, .page_loads = 7};
  const std::vector<double> weights{1, 0.02, 0.3, 0.17};
  const auto shares = share_budgets(total, weights);
  ASSERT_EQ(shares.size(), 4u);
  double ms = 0;
  std::uint64_t triangles = 0;
  for (const Budgets& b : shares) {
    ms += b.adapt_ms;
    triangles += b.triangles;
    EXPECT_GE(b.page_loads, 1u);
  }
  EXPECT_NEAR(ms, 4, 1e-9);
  EXPECT_LE(triangles, total.triangles);
  EXPECT_GT(triangles, total.triangles - 8);
  EXPECT_GT(shares[0].triangles, shares[2].triangles);
  EXPECT_EQ(share_budgets(total, std::vector<double>{0.4})[0].triangles, total.triangles);
  EXPECT_EQ(share_budgets({}, weights)[1].triangles, Budgets{}.triangles) << "no limit stays no limit";
}

TEST(BudgetShares, WhatCoversMoreOfThePictureWeighsMore) {
  const View view = at(0);
  const double near = visible_weight(view, {0, 0, 0}, 2), far = visible_weight(view, {0, 0, -40}, 2);
  EXPECT_GT(near, far);
  EXPECT_GT(far, 0);
  EXPECT_EQ(visible_weight(view, {0, 0, 9}, 2), 1) << "the eye is in it";
  EXPECT_LT(visible_weight(view, {0, 0, 20}, 2), near) << "behind the camera";
}

TEST(SurfaceRay, MeetsTheNearestTriangleInWorldUnits) {
  const Grid grid{{100, 0, 0}, 0.5};
  std::vector<DrawVertex> vertices;
  for (const std::int32_t z : {0, -20})
    for (const auto& [x, y] : {std::pair(-10, -10), std::pair(10, -10), std::pair(0, 10)})
      vertices.push_back({x, y, z, 0, 0, {}});
  const std::vector<std::uint32_t> indices{3, 4, 5, 0, 1, 2}, pages{0, 1};
  const std::vector<Range> draws{{0, 3}, {3, 3}};
  DrawList list{grid, vertices, {}, indices, draws, {}, {}};
  Directory directory;
  directory.pages.resize(2);
  directory.pages[0].bound = {{0, 0, -20}, 15};
  directory.pages[1].bound = {{0, 0, 0}, 15};
  for (const bool pages_known : {false, true}) {
    if (pages_known) list.draw_pages = pages;
    EXPECT_NEAR(distance_along(list, directory, {100, 0, 7}, {0, 0, -1}).value_or(-1), 7, 1e-9);
    EXPECT_NEAR(distance_along(list, directory, {100, 0, -3}, {0, 0, -1}).value_or(-1), 7, 1e-9)
        << "past the first";
    EXPECT_FALSE(distance_along(list, directory, {100, 0, 7}, {0, 0, 1})) << "behind";
    EXPECT_FALSE(distance_along(list, directory, {104.9, 4, 7}, {0, 0, -1})) << "beside";
    Relief relief;  // z is up, heights above -2
    relief.origin = {0, 0, -2};
    relief.exaggeration = 3;
    EXPECT_NEAR(distance_along(list, directory, {100, 0, 7}, {0, 0, -1}, relief).value_or(-1), 3, 1e-9)
        << "drawn at 4";
    EXPECT_NEAR(distance_along(list, directory, {100, 0, 3}, {0, 0, -1}, relief).value_or(-1), 29, 1e-9)
        << "drawn at -26";
  }
}

TEST(StatisticsText, TellsBudgetsOnlyWhereThereAreAny) {
  FrameStatistics s;
  s.title = "a.cuesta";
  s.adapt.triangles = 1234567;
  const auto free = statistics_lines(s);
  EXPECT_NE(std::find(free.begin(), free.end(), "triangles  1,234,567"), free.end());
  s.budgets.triangles = 2000000;
  const auto bound = statistics_lines(s);
  EXPECT_NE(std::find(bound.begin(), bound.end(), "triangles  1,234,567 of 2,000,000"), bound.end());
}

TEST(StatisticsText, OnTerrainItTellsPlacesAndMetres) {
  FrameStatistics s;
  s.mode = ControlMode::fly;
  s.speed = 12;
  const auto contains = [&](const std::string& words) {
    const auto lines = statistics_lines(s);
    return std::any_of(lines.begin(), lines.end(),
                       [&](const std::string& line) { return line.find(words) != line.npos; });
  };
  EXPECT_TRUE(contains("fly, 12 units/s"));
  s.places = {"camera     46.1 N 7.2 E"};
  EXPECT_TRUE(contains("fly, 12 m/s"));
  EXPECT_TRUE(contains("46.1 N"));
}

}  // namespace
}  // namespace cuesta::test
