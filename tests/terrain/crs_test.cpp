#include "terrain/crs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "terrain/crs_epsg.h"

namespace cuesta {
namespace {

double dms(double d, double m, double s) {
  return d + m / 60 + s / 3600;
}

CrsDefinition make(CrsMethod method, Ellipsoid ellipsoid, double lat0, double lon0, double p1, double p2,
                   double k, double fe, double fn, double unit = 1) {
  CrsDefinition d;
  d.name = "example";
  d.method = method;
  d.ellipsoid = ellipsoid;
  d.unit = unit;
  d.latitude_origin_deg = lat0;
  d.longitude_origin_deg = lon0;
  d.parallel_1_deg = p1;
  d.parallel_2_deg = p2;
  d.scale = k;
  d.false_easting_m = fe;
  d.false_northing_m = fn;
  return d;
}

struct Published {
  const char* what;
  CrsDefinition definition;
  LatLon at;
  PlanePoint p;
  double tolerance;  // in units of the system: half of the last printed digit, doubled
};

constexpr Ellipsoid clarke1866{6378206.4, 294.9786982};
constexpr Ellipsoid airy1830{6377563.396, 299.3249646};
constexpr Ellipsoid bessel1841{6377397.155, 299.1528128};
constexpr Ellipsoid krassowsky{6378245, 298.3};
constexpr Ellipsoid grs80{6378137, 298.257222101};

// IOGP Publication 373-7-2, "Geomatics guidance note 7, part 2: coordinate conversions and transformations
// including formulas": the examples of §3.2 (numbers of methods in brackets). Their datums are not supported,
// the formulas are.
std::vector<Published> published() {
  using M = CrsMethod;
  return {
      {"9802 Lambert 2SP, NAD27 / Texas South Central",
       make(M::lambert_conformal, clarke1866, dms(27, 50, 0), -99, dms(28, 23, 0), dms(30, 17, 0), 1,
            2000000 * us_survey_foot_m, 0, us_survey_foot_m),
       {28.5, -96},
       {2963503.91, 254759.80},
       0.01},
      {"9801 Lambert 1SP, JAD69 / Jamaica National Grid",
       make(M::lambert_conformal, clarke1866, 18, -77, 18, 18, 1, 250000, 150000),
       {dms(17, 55, 55.80), -dms(76, 56, 37.26)},
       {255966.58, 142493.51},
       0.01},
      {"9807 transverse Mercator, OSGB36 / British National Grid",
       make(M::transverse_mercator, airy1830, 49, -2, 0, 0, 0.9996012717, 400000, -100000),
       {50.5, 0.5},
       {577274.99, 69740.50},
       0.01},
      {"9804 Mercator A, Makassar / NEIEZ",
       make(M::mercator, bessel1841, 0, 110, 0, 0, 0.997, 3900000, 900000),
       {-3, 120},
       {5009726.58, 569150.82},
       0.01},
      {"9805 Mercator B, Pulkovo 1942 / Caspian Sea Mercator",
       make(M::mercator, krassowsky, 0, 51, 42, 0, 1, 0, 0),
       {53, 53},
       {165704.29, 5171848.07},
       0.01},
      {"1024 Web Mercator, WGS 84 / Pseudo-Mercator",
       make(M::web_mercator, {}, 0, 0, 0, 0, 1, 0, 0),
       {dms(24, 22, 54.433), -dms(100, 20, 0)},
       {-11169055.58, 2800000.00},
       0.01},
      {"9810 polar stereographic A, WGS 84 / UPS North",
       make(M::polar_stereographic, {}, 90, 0, 90, 0, 0.994, 2000000, 2000000),
       {73, 44},
       {3320416.75, 632668.43},
       0.01},
      {"9829 polar stereographic B, WGS 84 / Australian Antarctic Polar",
       make(M::polar_stereographic, {}, -90, 70, -71, 0, 1, 6000000, 6000000),
       {-75, 120},
       {7255380.79, 7053389.56},
       0.01},
      {"9822 Albers, NAD83 / Great Lakes Albers",
       make(M::albers, grs80, 45.568977, -84.455955, 42.122774, 49.01518, 1, 1000000, 1000000),
       {42.75, -78.75},
       {1466493.492, 702903.006},
       0.002},
      // Snyder, "Map Projections: A Working Manual", USGS 1395, 1987, pp. 292 and 296: to 0.1 m.
      {"Albers, Snyder p. 292",
       make(M::albers, clarke1866, 23, -96, 29.5, 45.5, 1, 0, 0),
       {35, -75},
       {1885472.7, 1535925.0},
       0.1},
      {"Lambert, Snyder p. 296",
       make(M::lambert_conformal, clarke1866, 23, -96, 33, 45, 1, 0, 0),
       {35, -75},
       {1894410.9, 1564649.5},
       0.1},
  };
}

TEST(Crs, AgreesWithPublishedExamplesOfEachMethod) {
  for (const Published& example : published()) {
    SCOPED_TRACE(example.what);
    const auto crs = Crs::from_definition(example.definition);
    ASSERT_TRUE(crs) << crs.error().text();
    const PlanePoint p = crs->coordinates(example.at);
    EXPECT_NEAR(p.x, example.p.x, example.tolerance);
    EXPECT_NEAR(p.y, example.p.y, example.tolerance);
    const LatLon at = crs->lat_lon(example.p);
    EXPECT_NEAR(at.lat_deg, example.at.lat_deg, example.tolerance / 100000);
    EXPECT_NEAR(at.lon_deg, example.at.lon_deg, example.tolerance / 50000);
  }
}

/// Metres on the ground between two places, to first order.
double apart_m(LatLon a, LatLon b) {
  const double m_per_deg = 111320;
  const double east = std::remainder(a.lon_deg - b.lon_deg, 360) * std::cos(a.lat_deg * 0.017453292519943295);
  return m_per_deg * std::hypot(a.lat_deg - b.lat_deg, east);
}

/// Forward after inverse, and inverse after forward, at one place; false where the system has no coordinates
/// there.
bool comes_back(const Crs& crs, LatLon at, double& worst_m) {
  const PlanePoint p = crs.coordinates(at);
  if (std::isnan(p.x)) return false;
  const LatLon back = crs.lat_lon(p);
  const PlanePoint again = crs.coordinates(back);
  const double unit_m = crs.geographic() ? 111320 * crs.definition().unit : crs.definition().unit;
  const double size = std::max(1.0, std::hypot(p.x, p.y) * unit_m * 1e-3);  // 1e-9 relative, at least 1e-6 m
  const bool seam =
      std::abs(std::remainder(at.lon_deg - crs.definition().longitude_origin_deg - 180, 360)) < 1e-9;
  const double plane_m = seam ? 0 : std::hypot(again.x - p.x, again.y - p.y) * unit_m;
  const double ground_m = apart_m(at, back);
  const bool flat_pole = crs.definition().method == CrsMethod::albers && std::abs(at.lat_deg) > 89;
  worst_m = std::max({worst_m, plane_m / size, flat_pole ? 0 : ground_m});
  EXPECT_LE(plane_m, 1e-6 * size) << crs.definition().name << " at " << at.lat_deg << ", " << at.lon_deg;
  EXPECT_LE(ground_m, flat_pole ? 0.2 : 1e-3)
      << crs.definition().name << " at " << at.lat_deg << ", " << at.lon_deg;
  return true;
}

/// Where a system is used: near its origin. Its far side has huge coordinates, which double cannot hold to 1
/// mm.
std::vector<LatLon> places_of(const CrsDefinition& d, std::mt19937_64& random) {
  const double lon0 = d.longitude_origin_deg;
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<LatLon> places;
  switch (d.method) {
    case CrsMethod::polar_stereographic:
      places = {{d.latitude_origin_deg, 0}, {d.latitude_origin_deg, 180}};
      for (int i = 0; i < 40; ++i) {
        places.push_back({std::copysign(std::min(90.0, 45 + 45 * std::sqrt(std::abs(unit(random)))),
                                        d.latitude_origin_deg),
                          180 * unit(random)});
      }
      break;
    case CrsMethod::transverse_mercator:
      for (const double edge : {-3.0, 3.0, -1e-9, 0.0, 6.0}) {  // a zone's edges, and its centre
        places.push_back({84, lon0 + edge});
        places.push_back({-80, lon0 + edge});
        places.push_back({0, lon0 + edge});
        places.push_back({90, lon0 + edge});
        places.push_back({-90, lon0 + edge});
      }
      for (int i = 0; i < 40; ++i) places.push_back({90 * unit(random), lon0 + 20 * unit(random)});
      break;
    case CrsMethod::mercator:
    case CrsMethod::web_mercator:
      places = {{85.05112877980659, 180}, {0, -180}, {-85, 179.999999999}};
      for (int i = 0; i < 40; ++i) places.push_back({85 * unit(random), 180 * unit(random)});
      break;
    case CrsMethod::geographic:
      places = {{90, 0}, {-90, 17}, {0, 180}, {12, -180}, {12, 179.9999999999}};
      for (int i = 0; i < 40; ++i) places.push_back({90 * unit(random), 180 * unit(random)});
      break;
    case CrsMethod::plane:
      break;  // is nowhere, and no code's
    case CrsMethod::lambert_conformal:
    case CrsMethod::albers: {
      const double middle = (d.parallel_1_deg + d.parallel_2_deg) / 2;
      places = {{std::copysign(90.0, middle), lon0}, {middle, lon0 + 179.9999}, {middle, lon0 - 179.9999}};
      for (int i = 0; i < 40; ++i) {
        const double lat = std::max(-90.0, std::min(90.0, middle + 40 * unit(random)));
        places.push_back({lat, lon0 + 170 * unit(random)});
      }
      break;
    }
  }
  return places;
}

TEST(Crs, RoundTripsOfAllSupportedCodes) {
  const std::vector<int> codes = supported_epsg_codes();
  ASSERT_GT(codes.size(), 600U);
  const std::uint64_t seed = 20240611;
  std::mt19937_64 random(seed);
  double worst_m = 0;
  for (const int code : codes) {
    const auto crs = Crs::from_epsg(code);
    ASSERT_TRUE(crs) << crs.error().text();
    std::size_t in_domain = 0;
    const auto places = places_of(crs->definition(), random);
    for (const LatLon at : places) in_domain += comes_back(*crs, at, worst_m);
    EXPECT_EQ(in_domain, places.size()) << crs->definition().name;
  }
  RecordProperty("worst_m", std::to_string(worst_m));
  std::printf("%zu codes, worst round trip %.2e m, seed %llu\n", codes.size(), worst_m,
              static_cast<unsigned long long>(seed));
}

// GeographicLib 2.1.2 loses the sign of latitudes in southern Albers.
TEST(Crs, SouthernConicsMirrorNorthernOnes) {
  for (const CrsMethod method : {CrsMethod::albers, CrsMethod::lambert_conformal}) {
    const auto north = Crs::from_definition(make(method, grs80, 10, 132, 18, 36, 1, 1000, 2000)).value();
    const auto south = Crs::from_definition(make(method, grs80, -10, 132, -18, -36, 1, 1000, -2000)).value();
    for (const LatLon at : {LatLon{30, 140}, LatLon{18, 50}, LatLon{-60, 100}, LatLon{0, 132}}) {
      const PlanePoint n = north.coordinates(at), s = south.coordinates({-at.lat_deg, at.lon_deg});
      EXPECT_DOUBLE_EQ(n.x, s.x);
      EXPECT_DOUBLE_EQ(n.y, -s.y);
    }
  }
}

TEST(Crs, AxisOrderIsEastThenNorth) {
  const auto wgs84 = Crs::from_name("EPSG:4326").value();
  EXPECT_NEAR(wgs84.lat_lon({10, 50}).lat_deg, 50, 1e-12);
  EXPECT_NEAR(wgs84.lat_lon({10, 50}).lon_deg, 10, 1e-12);
  // EPSG:32661 and 5041 differ in the order that EPSG lists; here both are east, north.
  const PlanePoint n_e = Crs::from_epsg(32661)->coordinates({73, 44});
  const PlanePoint e_n = Crs::from_epsg(5041)->coordinates({73, 44});
  EXPECT_EQ(n_e.x, e_n.x);
  EXPECT_EQ(n_e.y, e_n.y);
  EXPECT_NEAR(n_e.x, 3320416.75, 0.01);
}

TEST(Crs, AntarcticGridHasGreenwichUp) {
  const auto crs = Crs::from_epsg(3031).value();
  EXPECT_NEAR(crs.coordinates({-80, 0}).x, 0, 1e-6);
  EXPECT_GT(crs.coordinates({-80, 0}).y, 1e6);
  EXPECT_GT(crs.coordinates({-80, 90}).x, 1e6);
  const auto arctic = Crs::from_epsg(3413).value();
  EXPECT_NEAR(arctic.coordinates({80, -45}).x, 0, 1e-6);
  EXPECT_LT(arctic.coordinates({80, -45}).y, -1e6);
  EXPECT_GT(arctic.coordinates({80, 45}).x, 1e6);
}

TEST(Crs, WebMercatorSquareEndsAtTheAntimeridian) {
  const auto crs = Crs::from_name("epsg:3857").value();
  const double half_m = 20037508.342789244;
  EXPECT_NEAR(crs.coordinates({85.0511287798066, 180}).x, half_m, 1e-6);
  EXPECT_NEAR(crs.coordinates({85.0511287798066, 180}).y, half_m, 1e-5);
  EXPECT_NEAR(crs.lat_lon({-half_m, -half_m}).lat_deg, -85.0511287798066, 1e-12);
}

TEST(Crs, UtmCentralMeridians) {
  EXPECT_NEAR(Crs::from_epsg(32631)->coordinates({0, 3}).x, 500000, 1e-6);
  EXPECT_NEAR(Crs::from_epsg(32701)->coordinates({0, -177}).y, 10000000, 1e-6);
  EXPECT_NEAR(Crs::from_epsg(32660)->coordinates({10, -180}).x,
              Crs::from_epsg(32660)->coordinates({10, 180}).x, 1e-6);
  // A zone's neighbour beyond the antimeridian.
  const PlanePoint p = Crs::from_epsg(32660)->coordinates({10, -179});
  EXPECT_GT(p.x, 500000);
  EXPECT_NEAR(Crs::from_epsg(32660)->lat_lon(p).lon_deg, -179, 1e-11);
}

TEST(Crs, NaNOutsideOfTheDomain) {
  const auto no_place = [](const Crs& crs, PlanePoint p) {
    const LatLon at = crs.lat_lon(p);
    return std::isnan(at.lat_deg) && std::isnan(at.lon_deg);
  };
  const auto no_point = [](const Crs& crs, LatLon at) {
    const PlanePoint p = crs.coordinates(at);
    return std::isnan(p.x) && std::isnan(p.y);
  };
  const auto wgs84 = Crs::from_epsg(4326).value();
  EXPECT_TRUE(no_place(wgs84, {0, 90.001}));
  EXPECT_EQ(wgs84.lat_lon({0, 90 + 1e-10}).lat_deg, 90);
  const auto utm = Crs::from_epsg(32633).value();
  EXPECT_TRUE(no_place(utm, {6e6, 5e6}));
  EXPECT_TRUE(no_place(utm, {5e5, 2.1e7}));
  EXPECT_TRUE(no_point(utm, {0, 15 + 45}));
  EXPECT_TRUE(no_point(utm, {0, 15 + 90}));
  EXPECT_FALSE(no_point(utm, {89, 15 + 90}));
  EXPECT_FALSE(no_point(utm, {0, 15 - 32}));
  const auto france = Crs::from_epsg(2154).value();  // the fan is open above the pole
  EXPECT_TRUE(no_place(france, {700000, 6600000 + 9e6}));
  EXPECT_FALSE(no_place(france, {700000, 6600000}));
  const auto conus = Crs::from_epsg(5070).value();
  EXPECT_TRUE(no_place(conus, {0, 2e7}));
  EXPECT_TRUE(no_place(conus, {0, -2e7}));
  for (const Crs& crs :
       {wgs84, utm, france, conus, Crs::from_epsg(3857).value(), Crs::from_epsg(3031).value()}) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(no_point(crs, {91, 0})) << crs.definition().name;
    EXPECT_TRUE(no_point(crs, {nan, 0})) << crs.definition().name;
    EXPECT_TRUE(no_point(crs, {0, std::numeric_limits<double>::infinity()})) << crs.definition().name;
    EXPECT_TRUE(no_place(crs, {nan, 0})) << crs.definition().name;
    EXPECT_TRUE(no_place(crs, {0, nan})) << crs.definition().name;
  }
}

TEST(Crs, UnsupportedCodesAreRefusedByName) {
  const auto text = [](int code) {
    const auto crs = Crs::from_epsg(code);
    EXPECT_FALSE(crs);
    return crs ? std::string() : crs.error().text();
  };
  const auto has = [](const std::string& all, const char* part) {
    return all.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(text(3035),
                  "EPSG:3035 (ETRS89-extended / LAEA Europe): Lambert Azimuthal Equal Area is not supported"))
      << text(3035);
  EXPECT_TRUE(has(text(27700), "EPSG:27700 (OSGB36 / British National Grid): datum OSGB36")) << text(27700);
  EXPECT_TRUE(has(text(2056), "Hotine Oblique Mercator")) << text(2056);
  EXPECT_TRUE(has(text(4267), "EPSG:4267 (NAD27)")) << text(4267);
  EXPECT_TRUE(has(text(26712), "NAD27 / UTM zone 12N")) << text(26712);
  EXPECT_TRUE(has(text(32233), "WGS 72 / UTM zone 33N")) << text(32233);
  EXPECT_EQ(Crs::from_epsg(3035).error().code, ErrorCode::unsupported_version);
  EXPECT_EQ(Crs::from_epsg(31999).error().code, ErrorCode::not_found);
  EXPECT_TRUE(has(text(31999), "EPSG:31999: this code is not in the table"));
  for (const char* name : {"", "EPSG:", "EPSG:x", "EPSG:43 26", "utm33", "-4326", "EPSG:99999999999"}) {
    EXPECT_EQ(Crs::from_name(name).error().code, ErrorCode::invalid_input) << name;
  }
}

TEST(Crs, DescriptionNamesWhatIsTakenAsWgs84) {
  EXPECT_EQ(Crs::from_epsg(4326)->description(), "EPSG:4326 (WGS 84), latitude and longitude, degrees");
  EXPECT_EQ(Crs::from_epsg(5070)->description(),
            "EPSG:5070 (NAD83 / Conus Albers), Albers equal area, metres; NAD83 is taken as WGS 84, from "
            "which it is up "
            "to 2 m away");
  EXPECT_NE(Crs::from_epsg(2277)->description().find("US survey feet"), std::string::npos);
}

TEST(Crs, ParametersWithoutMeaningAreRefused) {
  const CrsDefinition good = utm_zone(33, false, 4326);
  ASSERT_TRUE(Crs::from_definition(good));
  const auto refused = [&](auto change) {
    CrsDefinition bad = good;
    change(bad);
    const auto crs = Crs::from_definition(bad);
    return !crs && crs.error().code == ErrorCode::invalid_input;
  };
  EXPECT_TRUE(refused([](CrsDefinition& d) { d.scale = 0; }));
  EXPECT_TRUE(refused([](CrsDefinition& d) { d.scale = std::nan(""); }));
  EXPECT_TRUE(refused([](CrsDefinition& d) { d.unit = -1; }));
  EXPECT_TRUE(refused([](CrsDefinition& d) { d.latitude_origin_deg = 91; }));
  EXPECT_TRUE(refused([](CrsDefinition& d) { d.ellipsoid.equatorial_radius_m = -1; }));
  EXPECT_TRUE(refused([](CrsDefinition& d) { d.ellipsoid.inverse_flattening = 0.5; }));
  EXPECT_TRUE(refused([](CrsDefinition& d) { d.method = CrsMethod::polar_stereographic; }));
  EXPECT_TRUE(refused([](CrsDefinition& d) {
    d.method = CrsMethod::lambert_conformal;  // one of two parallels is a pole
    d.parallel_1_deg = 90;
    d.parallel_2_deg = 45;
  }));
}

}  // namespace
}  // namespace cuesta
