#include "runtime/flight.h"

#include <gtest/gtest.h>

#include <numbers>

#include "runtime/flight_file.h"
#include "runtime/view_fit.h"

namespace cuesta::test {
namespace {

Flight straight_flight() {
  Flight flight;
  for (const double t : {0.0, 1.0, 2.0, 4.0}) flight.keyframes.push_back({t, {t, 0, 5}, {t, 0, 0}});
  return flight;
}

Result<Flight> parse(std::string_view text) {
  return parse_flight(text, "flight.json");
}

/// Camera coordinates over the frustum's half-width: inside the picture if both are in ±1 and the depth is
/// positive.
std::array<double, 3> in_picture(const View& view, Vec3d p) {
  const auto [right, up, back] = view.frame();
  const Vec3d d = p - view.eye;
  const double tan_y = std::tan(view.fov_y_rad / 2), depth = -dot(d, back);
  return {dot(d, right) / (depth * tan_y * view.width_px / view.height_px), dot(d, up) / (depth * tan_y),
          depth};
}

TEST(Flight, PassesThroughItsKeyframes) {
  Flight flight = straight_flight();
  flight.keyframes[2].eye = {7, 3, 1};
  for (const Keyframe& k : flight.keyframes)
    EXPECT_LT(length(flight_view(flight, k.time_s, {}).eye - k.eye), 1e-12);
}

TEST(Flight, EvenMotionStaysEven) {
  const Flight flight = straight_flight();
  for (const double t : {0.25, 0.5, 1.75, 3.0, 3.9})
    EXPECT_NEAR(flight_view(flight, t, {}).eye.x, t, 1e-12) << t;
}

TEST(Flight, EndsAreClamped) {
  const Flight flight = straight_flight();
  EXPECT_EQ(flight_view(flight, -3, {}).eye.x, 0);
  EXPECT_EQ(flight_view(flight, 99, {}).eye.x, 4);
}

TEST(Flight, FramesCountBothEnds) {
  Flight flight = straight_flight();
  flight.fps = 30;
  EXPECT_EQ(frame_count(flight), 121u);
  flight.keyframes.resize(1);
  EXPECT_EQ(frame_count(flight), 1u);
}

TEST(Flight, GeneratedFlightsHaveTheFramesAskedFor) {
  const std::vector<Vec3d> points{{-1, -2, -3}, {1, 2, 3}, {0, 0, 1}};
  for (const auto kind : {FlightKind::orbit, FlightKind::zoom_in, FlightKind::fly_over}) {
    const Flight flight = make_flight(kind, {points, {0, 0, 1}}, {}, 77);
    EXPECT_EQ(frame_count(flight), 77u);
    const auto again = parse(flight_text(flight));
    ASSERT_TRUE(again) << again.error().text();
    EXPECT_EQ(frame_count(*again), 77u);
    EXPECT_EQ(again->keyframes.back().eye, flight.keyframes.back().eye);
  }
}

TEST(Flight, AnOrbitKeepsEverythingInThePicture) {
  const std::vector<Vec3d> points{{-1, -2, -3}, {1, 2, 3}, {4, 0, 1}};
  const Flight flight = make_flight(FlightKind::orbit, {points, {}}, {}, 50);
  for (std::uint64_t i = 0; i < 50; ++i) {
    const View view = flight_view(flight, frame_time(flight, i), {});
    for (const Vec3d& p : points) {
      const auto [x, y, depth] = in_picture(view, p);
      EXPECT_TRUE(depth > 0 && std::abs(x) < 1 && std::abs(y) < 1) << i;
    }
  }
}

TEST(ViewFit, FillsThePictureWithAllPointsInside) {
  const std::vector<Vec3d> points{{100, 5, 0}, {103, 5, 0}, {101, 9, 2}, {100, 6, -4}};
  for (const Vec3d up : {Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, Vec3d{1, 0, 0}}) {
    View size;
    size.up = up;
    const View view = fit_view(points, three_quarter_direction(up), size);
    double most = 0;
    for (const Vec3d& p : points) {
      const auto [x, y, depth] = in_picture(view, p);
      EXPECT_GT(depth, 0);
      most = std::max({most, std::abs(x), std::abs(y)});
    }
    EXPECT_LT(most, 1);
    EXPECT_GT(most, 0.8);
  }
}

TEST(ViewFit, OnePointHasACamera) {
  const std::vector<Vec3d> points{{1, 2, 3}};
  const View view = fit_view(points, {0, 0, 1}, {});
  EXPECT_EQ(view.target, points[0]);
  EXPECT_GT(length(view.eye - view.target), 0);
}

/// What is behind someone in the middle comes into view within a few frames.
TEST(MakeFlight, AWalkThroughTurnsInTheMiddle) {
  std::vector<Vec3d> points;
  for (int corner = 0; corner < 8; ++corner)
    points.push_back({corner & 1 ? 2.0 : -2.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 3.0 : -3.0});
  for (const Vec3d up : {Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
    View view;
    view.up = up;
    const Flight flight = make_flight(FlightKind::walk_through, {points, points[0]}, view, 301, 30);
    EXPECT_EQ(frame_count(flight), 301u);
    double least = 1e9, most_turn = 0;
    Vec3d last{};
    for (std::uint64_t i = 0; i < 301; ++i) {
      const View at = flight_view(flight, frame_time(flight, i), view);
      const Vec3d looks = normalized(at.target - at.eye);
      if (i > 0) most_turn = std::max(most_turn, std::acos(std::min(1.0, dot(looks, last))));
      last = looks;
      least = std::min(least, length(at.eye));
    }
    EXPECT_LT(least, 2);
    EXPECT_GT(most_turn, 0.05);
    EXPECT_NEAR(length(flight.keyframes.front().eye), length(flight.keyframes[3].eye), 1e-9);
  }
}

TEST(FlightFile, LeavesOutWhatHasADefault) {
  const auto flight = parse(R"({"keyframes": [{"t": 0, "eye": [0,0,1], "target": [0,0,0]}]})");
  ASSERT_TRUE(flight) << flight.error().text();
  EXPECT_EQ(flight->fps, 30);
  EXPECT_EQ(flight->keyframes[0].up, (Vec3d{0, 1, 0}));
  EXPECT_EQ(flight->keyframes[0].fov_deg, 60);
}

TEST(FlightFile, SaysOnWhichLineAKeyframeIsWrong) {
  const auto flight = parse(
      "{\"keyframes\": [\n"
      "  {\"t\": 0, \"eye\": [0,0,1], \"target\": [0,0,0]},\n"
      "  {\"t\": 1, \"eye\": [0,0], \"target\": [0,0,0]}]}\n");
  ASSERT_FALSE(flight);
  EXPECT_EQ(flight.error().code, ErrorCode::invalid_input);
  EXPECT_EQ(flight.error().place, "line 3, keyframe 1");
}

TEST(FlightFile, SaysOnWhichLineTheJsonBreaks) {
  const auto flight = parse("{\n\"fps\": 30,\n\"keyframes\" [");
  ASSERT_FALSE(flight);
  EXPECT_EQ(flight.error().code, ErrorCode::corrupt);
  EXPECT_EQ(flight.error().place, "line 3");
}

TEST(FlightFile, RefusesWhatIsNoFlight) {
  const std::string key = R"({"t": 0, "eye": [0,0,1], "target": [0,0,0])";
  for (const std::string& text :
       {std::string(""), std::string("[]"), std::string("null"), std::string("{}"),
        std::string(R"({"keyframes": []})"), std::string(R"({"keyframes": {}})"),
        std::string(R"({"keyframes": [1]})"), R"({"fps": 0, "keyframes": [)" + key + "}]}",
        R"({"fps": "a", "keyframes": [)" + key + "}]}", R"({"speed": 1, "keyframes": [)" + key + "}]}",
        R"({"keyframes": [)" + key + R"(, "fov_deg": 180}]})",
        R"({"keyframes": [)" + key + R"(, "up": [0,0,0]}]})",
        R"({"keyframes": [)" + key + "}, " + key + "}]}",
        std::string(R"({"keyframes": [{"t": 0, "eye": [0,0,0], "target": [0,0,0]}]})"),
        std::string(R"({"keyframes": [{"t": 1e999, "eye": [0,0,1], "target": [0,0,0]}]})"),
        R"({"keyframes": [)" + key + R"(}, {"t": 1e9, "eye": [0,0,1], "target": [0,0,0]}]})",
        std::string(100000, '['), std::string("{\"keyframes\": \"\xff\xfe\"}")}) {
    EXPECT_FALSE(parse(text)) << text.substr(0, 80);
  }
}

TEST(FlightFile, EveryTruncationIsRefused) {
  const std::string text =
      R"({"fps": 25, "keyframes": [{"t": 0, "eye": [0,0,1], "target": [0,0,0], "up": [0,1,0]}]})";
  ASSERT_TRUE(parse(text));
  for (std::size_t n = 0; n < text.size(); ++n) EXPECT_FALSE(parse(text.substr(0, n))) << n;
}

}  // namespace
}  // namespace cuesta::test
