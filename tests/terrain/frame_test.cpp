#include "terrain/frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace cuesta {
namespace {

constexpr long double pi = 3.141592653589793238462643383279503L;

/// ECEF by the closed formula (EPSG guidance note 7-2, §4.1.1), with numbers of its own: WGS 84's a and 1/f.
Vec3d closed_form(Geodetic at) {
  const long double a = 6378137.0L, f = 1 / 298.257223563L, e2 = f * (2 - f);
  const long double lat = at.lat_deg * pi / 180, lon = at.lon_deg * pi / 180;
  const long double n = a / std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
  return {static_cast<double>((n + at.h_m) * std::cos(lat) * std::cos(lon)),
          static_cast<double>((n + at.h_m) * std::cos(lat) * std::sin(lon)),
          static_cast<double>((n * (1 - e2) + at.h_m) * std::sin(lat))};
}

double apart(Vec3d a, Vec3d b) {
  return length(a - b);
}

double dms(double d, double m, double s) {
  return d + m / 60 + s / 3600;
}

std::vector<Geodetic> places(std::uint64_t seed, int count) {
  std::vector<Geodetic> all = {{90, 0, 0},    {-90, 0, 8000},         {0, 180, 0},
                               {0, -180, 0},  {45, 179.9999999, 100}, {0, 0, -430},
                               {0, 90, 8848}, {89.9999999, -77, 10}};
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < count; ++i) {
    all.push_back({std::asin(unit(random)) * 180 / static_cast<double>(pi), 180 * unit(random),
                   45000 + 55000 * unit(random)});
  }
  return all;
}

TEST(Frame, EcefOfKnownPoints) {
  const Frame globe = Frame::ecef();
  EXPECT_LT(apart(globe.position_m({0, 0, 0}), {6378137, 0, 0}), 1e-9);
  EXPECT_LT(apart(globe.position_m({0, 90, 0}), {0, 6378137, 0}), 1e-8);
  EXPECT_LT(apart(globe.position_m({90, 0, 0}), {0, 0, 6356752.314245}), 1e-6);
  // EPSG guidance note 7-2, §4.1.1: 53°48'33.820"N, 2°07'46.380"E, 73.0 m.
  const Vec3d published{3771793.968, 140253.342, 5124304.349};
  EXPECT_LT(apart(globe.position_m({dms(53, 48, 33.820), dms(2, 7, 46.380), 73}), published), 1e-3);
  const Geodetic back = globe.geodetic(published);
  EXPECT_NEAR(back.lat_deg, dms(53, 48, 33.820), 1e-8);
  EXPECT_NEAR(back.lon_deg, dms(2, 7, 46.380), 2e-8);
  EXPECT_NEAR(back.h_m, 73, 1e-3);
}

TEST(Frame, EcefAgreesWithTheClosedFormula) {
  const Frame globe = Frame::ecef();
  double worst_m = 0;
  for (const Geodetic at : places(7, 100000)) {
    worst_m = std::max(worst_m, apart(globe.position_m(at), closed_form(at)));
  }
  EXPECT_LT(worst_m, 1e-3);
  std::printf("ECEF against the closed formula: worst %.2e m\n", worst_m);
}

TEST(Frame, EnuOfAPublishedPoint) {
  // EPSG guidance note 7-2, §4.1.2: topocentric origin 55°N 5°E 200 m, the point above.
  const Frame local = Frame::enu({55, 5, 200}).value();
  const Vec3d p = local.position_m({dms(53, 48, 33.820), dms(2, 7, 46.380), 73});
  EXPECT_LT(apart(p, {-189013.869, -128642.040, -4220.171}), 2e-3);
}

TEST(Frame, EnuIsARotationOfEcef) {
  const Frame globe = Frame::ecef(), local = Frame::enu({-33.9, 151.2, 40}).value();
  EXPECT_LT(apart(local.position_m({-33.9, 151.2, 40}), {0, 0, 0}), 1e-9);
  const auto all = places(9, 200);
  for (std::size_t i = 1; i < all.size(); ++i) {
    const double in_ecef = apart(globe.position_m(all[i]), globe.position_m(all[i - 1]));
    EXPECT_NEAR(apart(local.position_m(all[i]), local.position_m(all[i - 1])), in_ecef, 1e-6);
  }
  const Vec3d east = local.position_m({-33.9, 151.201, 40}), north = local.position_m({-33.899, 151.2, 40});
  EXPECT_GT(east.x, 90);
  EXPECT_NEAR(east.y, 0, 0.01);
  EXPECT_GT(north.y, 110);
  EXPECT_NEAR(local.position_m({-33.9, 151.2, 1040}).z, 1000, 1e-9);
}

TEST(Frame, RoundTrips) {
  const Crs utm = Crs::from_epsg(32633).value();
  const Frame frames[] = {Frame::ecef(), Frame::enu({46, 7, 1500}).value(),
                          Frame::enu({-90, 0, 2800}).value(), Frame::enu({0, 180, 0}).value(),
                          Frame::projected(utm).value()};
  double worst_m = 0;
  for (const Frame& frame : frames) {
    for (const Geodetic at : places(11, 5000)) {
      const Vec3d p = frame.position_m(at);
      if (std::isnan(p.x)) continue;  // far from the zone
      const Geodetic back = frame.geodetic(p);
      worst_m = std::max(worst_m, apart(closed_form(at), closed_form(back)));
    }
  }
  EXPECT_LT(worst_m, 1e-5);
  std::printf("frames: worst round trip %.2e m, seeds 7, 9, 11\n", worst_m);
}

TEST(Frame, UpIsTheEllipsoidsNormal) {
  const Frame globe = Frame::ecef(), local = Frame::enu({46, 7, 1500}).value();
  const Frame plane = Frame::projected(Crs::from_epsg(32633).value()).value();
  for (const Geodetic at : places(13, 300)) {
    const Geodetic higher{at.lat_deg, at.lon_deg, at.h_m + 1000};
    for (const Frame* frame : {&globe, &local}) {
      const Vec3d p = frame->position_m(at), up = frame->up(p);
      EXPECT_NEAR(length(up), 1, 1e-14);
      EXPECT_LT(apart(up * 1000.0, frame->position_m(higher) - p), 1e-5);
    }
  }
  EXPECT_LT(apart(local.up({0, 0, 0}), {0, 0, 1}), 1e-12);
  EXPECT_EQ(plane.up({500000, 5000000, 12}), (Vec3d{0, 0, 1}));
}

TEST(Frame, PostingsOfTheSameProjectionAreExact) {
  const Crs utm = Crs::from_epsg(25832).value();
  const Frame plane = Frame::projected(utm).value();
  EXPECT_EQ(plane.position_m(utm, {691234.5, 5334567.25}, 512.125), (Vec3d{691234.5, 5334567.25, 512.125}));
  const Crs feet = Crs::from_epsg(2277).value();
  const Vec3d p = Frame::projected(feet)->position_m(feet, {2296583.333, 1e7}, 100);
  EXPECT_NEAR(p.x, 699999.9998984, 1e-6);
  EXPECT_NEAR(p.y, 1e7 * us_survey_foot_m, 1e-6);
  EXPECT_EQ(p.z, 100) << "heights are metres, whatever the unit of x and y";
}

TEST(Frame, PostingsOfOtherSystemsMeet) {
  // The same place given in two zones and in degrees, in each frame.
  const Geodetic at{45.5, 12.0, 250};  // the edge of zones 32 and 33
  const Crs systems[] = {Crs::from_epsg(32632).value(), Crs::from_epsg(32633).value(),
                         Crs::from_epsg(4326).value(), Crs::from_epsg(3857).value(),
                         Crs::from_epsg(3034).value()};
  const Frame frames[] = {Frame::ecef(), Frame::enu({45, 12, 0}).value(),
                          Frame::projected(systems[0]).value()};
  for (const Frame& frame : frames) {
    for (const Crs& crs : systems) {
      const Vec3d p = frame.position_m(crs, crs.coordinates(at.lat_lon()), at.h_m);
      EXPECT_LT(apart(p, frame.position_m(at)), crs.definition().datum == "WGS 84" ? 1e-6 : 1e-3)
          << frame.description() << " from " << crs.description();
    }
  }
}

TEST(Frame, NaNAndRefusals) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(Frame::ecef().position_m({91, 0, 0}).x));
  EXPECT_TRUE(std::isnan(Frame::ecef().position_m({0, nan, 0}).z));
  EXPECT_TRUE(std::isnan(Frame::projected(Crs::from_epsg(32633).value())->position_m({0, 105, 0}).x));
  EXPECT_TRUE(std::isnan(Frame::ecef().position_m(Crs::from_epsg(32633).value(), {1e8, 0}, 0).x));
  EXPECT_EQ(Frame::enu({0, 0, nan}).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(Frame::enu({-91, 0, 0}).error().code, ErrorCode::invalid_input);
  const auto degrees = Frame::projected(Crs::from_epsg(4326).value());
  ASSERT_FALSE(degrees);
  EXPECT_NE(degrees.error().text().find("EPSG:4326 (WGS 84)"), std::string::npos);
}

}  // namespace
}  // namespace cuesta
