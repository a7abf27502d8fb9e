#include "terrain/crs_geokeys.h"

#include <gtest/gtest.h>

namespace cuesta {
namespace {

using Keys = std::vector<GeoKey>;

GeoKey code(std::uint16_t id, std::uint16_t value) {
  return {id, value};
}
GeoKey number(std::uint16_t id, double value) {
  return {id, std::vector<double>{value}};
}
GeoKey text(std::uint16_t id, const char* value) {
  return {id, std::string(value)};
}

Crs crs_of_keys(const Keys& keys) {
  auto definition = crs_from_geokeys(keys);
  EXPECT_TRUE(definition) << definition.error().text();
  auto crs = Crs::from_definition(definition.value());
  EXPECT_TRUE(crs) << crs.error().text();
  return crs.value();
}

std::string refusal(const Keys& keys, ErrorCode expected) {
  const auto definition = crs_from_geokeys(keys);
  if (definition) return "accepted as " + definition->name;
  EXPECT_EQ(definition.error().code, expected) << definition.error().text();
  return definition.error().text();
}

bool has(const std::string& all, const char* part) {
  return all.find(part) != std::string::npos;
}

void expect_same_coordinates(const Crs& a, const Crs& b, LatLon at) {
  const PlanePoint p = a.coordinates(at), q = b.coordinates(at);
  EXPECT_NEAR(p.x, q.x, 1e-7) << a.definition().name;
  EXPECT_NEAR(p.y, q.y, 1e-7) << a.definition().name;
}

TEST(CrsGeoKeys, CodesOfSystems) {
  EXPECT_EQ(crs_of_keys({code(1024, 2), code(1025, 1), code(2048, 4326)}).definition().name,
            "EPSG:4326 (WGS 84)");
  const Crs utm = crs_of_keys({code(1024, 1), code(3072, 32633), code(3076, 9001), text(1026, "anything")});
  EXPECT_EQ(utm.definition().name, "EPSG:32633 (WGS 84 / UTM zone 33N)");
  EXPECT_EQ(crs_of_keys({code(2048, 4258)}).definition().datum, "ETRS89") << "without the key of the model";
}

TEST(CrsGeoKeys, UtmByProjectionCode) {
  const Crs crs =
      crs_of_keys({code(1024, 1), code(2048, 4269), code(3072, 32767), code(3074, 16012), code(3076, 9001)});
  EXPECT_EQ(crs.definition().name, "NAD83 / UTM zone 12N");
  expect_same_coordinates(crs, Crs::from_epsg(26912).value(), {40, -110});
  const Crs south = crs_of_keys({code(1024, 1), code(2048, 4326), code(3072, 32767), code(3074, 16156)});
  expect_same_coordinates(south, Crs::from_epsg(32756).value(), {-30, 151});
}

TEST(CrsGeoKeys, ParametersOfEachMethod) {
  const auto base = [](std::uint16_t datum, std::uint16_t method, Keys more) {
    Keys keys = {code(1024, 1), code(2048, datum), code(3072, 32767), code(3074, 32767), code(3075, method)};
    keys.insert(keys.end(), more.begin(), more.end());
    return keys;
  };
  // Transverse Mercator: New Zealand.
  expect_same_coordinates(crs_of_keys(base(4167, 1,
                                           {number(3080, 173), number(3081, 0), number(3092, 0.9996),
                                            number(3082, 1600000), number(3083, 10000000)})),
                          Crs::from_epsg(2193).value(), {-41, 174});
  // Lambert with two parallels, origin in the false-origin keys: France; the same in the natural-origin keys.
  expect_same_coordinates(
      crs_of_keys(base(4171, 8,
                       {number(3078, 49), number(3079, 44), number(3084, 3), number(3085, 46.5),
                        number(3086, 700000), number(3087, 6600000)})),
      Crs::from_epsg(2154).value(), {45, 6});
  expect_same_coordinates(
      crs_of_keys(base(4171, 8,
                       {number(3078, 49), number(3079, 44), number(3080, 3), number(3081, 46.5),
                        number(3082, 700000), number(3083, 6600000)})),
      Crs::from_epsg(2154).value(), {45, 6});
  // Lambert in US survey feet, with false easting in feet: Texas Central.
  expect_same_coordinates(
      crs_of_keys(base(4269, 8,
                       {number(3078, 31.883333333333333), number(3079, 30.116666666666667),
                        number(3084, -100.33333333333333), number(3085, 29.666666666666667),
                        number(3086, 2296583.333), number(3087, 9842500.0), code(3076, 9003)})),
      Crs::from_epsg(2277).value(), {31, -97});
  // Albers: the United States, and Australia south of the equator.
  expect_same_coordinates(crs_of_keys(base(4269, 11,
                                           {number(3078, 29.5), number(3079, 45.5), number(3080, -96),
                                            number(3081, 23), number(3082, 0), number(3083, 0)})),
                          Crs::from_epsg(5070).value(), {40, -105});
  expect_same_coordinates(
      crs_of_keys(base(4283, 11, {number(3078, -18), number(3079, -36), number(3080, 132)})),
      Crs::from_epsg(3577).value(), {-33, 151});
  // Polar stereographic: latitude of true scale as natural origin, with the vertical pole's longitude; UPS.
  expect_same_coordinates(crs_of_keys(base(4326, 15, {number(3081, -71), number(3095, 0), number(3092, 1)})),
                          Crs::from_epsg(3031).value(), {-75, 100});
  expect_same_coordinates(crs_of_keys(base(4326, 15, {number(3081, 70), number(3095, -45)})),
                          Crs::from_epsg(3413).value(), {75, 100});
  expect_same_coordinates(crs_of_keys(base(4326, 15,
                                           {number(3081, 90), number(3095, 0), number(3092, 0.994),
                                            number(3082, 2000000), number(3083, 2000000)})),
                          Crs::from_epsg(5041).value(), {85, 10});
  expect_same_coordinates(crs_of_keys(base(4326, 7, {number(3080, 0), number(3081, 0), number(3092, 1)})),
                          Crs::from_epsg(3395).value(), {60, 10});
}

TEST(CrsGeoKeys, Units) {
  const Crs grads = crs_of_keys({code(1024, 2), code(2048, 4326), code(2054, 9105)});
  EXPECT_NEAR(grads.lat_lon({100, 50}).lon_deg, 90, 1e-12);
  const Crs paris = crs_of_keys({code(1024, 2), code(2048, 4326), number(2061, 2.5)});
  EXPECT_NEAR(paris.lat_lon({10, 50}).lon_deg, 12.5, 1e-12);
  EXPECT_NEAR(paris.coordinates({50, -178}).x, 179.5, 1e-12);
  // A zone of UTM in units of the user's own: links of 0.2 m.
  const Crs own =
      crs_of_keys({code(1024, 1), code(2048, 4326), code(3074, 16033), code(3076, 32767), number(3077, 0.2)});
  EXPECT_NEAR(own.coordinates({0, 15}).x, 2500000, 1e-6);
  const std::string both =
      refusal({code(1024, 1), code(3072, 26912), code(3076, 9003)}, ErrorCode::invalid_input);
  EXPECT_TRUE(has(both, "EPSG:26912") && has(both, "--crs")) << both;
  EXPECT_TRUE(has(refusal({code(1024, 1), code(2048, 4326), code(3074, 16033), code(3076, 9999)},
                          ErrorCode::unsupported_version),
                  "EPSG:9999"));
}

TEST(CrsGeoKeys, Datums) {
  EXPECT_EQ(crs_of_keys({code(1024, 2), code(2048, 32767), code(2050, 6269)}).definition().datum, "NAD83");
  const Crs unnamed = crs_of_keys({code(1024, 2), code(2048, 32767), code(2050, 32767), code(2056, 7019)});
  EXPECT_TRUE(has(unnamed.description(), "how far it is away is not known")) << unnamed.description();
  EXPECT_NEAR(unnamed.definition().ellipsoid.inverse_flattening, 298.257222101, 1e-12);
  const Crs axes =
      crs_of_keys({code(1024, 2), code(2048, 32767), number(2057, 6378137), number(2058, 6356752.314245)});
  EXPECT_NEAR(axes.definition().ellipsoid.inverse_flattening, 298.257223563, 1e-6);

  EXPECT_TRUE(has(refusal({code(1024, 2), code(2048, 4267)}, ErrorCode::unsupported_version), "NAD27"));
  EXPECT_TRUE(
      has(refusal({code(1024, 2), code(2048, 32767), code(2050, 6267)}, ErrorCode::unsupported_version),
          "NAD27"));
  EXPECT_TRUE(
      has(refusal({code(1024, 2), code(2048, 32767), number(2057, 6378206.4), number(2059, 294.9786982)},
                  ErrorCode::unsupported_version),
          "6378206.4"));
  EXPECT_TRUE(has(refusal({code(1024, 2), code(2048, 32767), number(2057, 3396190), number(2058, 3396190)},
                          ErrorCode::unsupported_version),
                  "not the Earth's"));
  const GeoKey shift{2062, std::vector<double>{-87, -98, -121}};
  EXPECT_TRUE(has(
      refusal({code(1024, 2), code(2048, 32767), code(2056, 7030), shift}, ErrorCode::unsupported_version),
      "shifted"));
  const GeoKey none{2062, std::vector<double>{0, 0, 0, 0, 0, 0, 0}};
  EXPECT_TRUE(crs_from_geokeys(Keys{code(1024, 2), code(2048, 32767), code(2056, 7030), none}));
}

TEST(CrsGeoKeys, RefusedByName) {
  const auto by_method = [](std::uint16_t method) {
    return refusal({code(1024, 1), code(2048, 4326), code(3072, 32767), code(3075, method)},
                   ErrorCode::unsupported_version);
  };
  EXPECT_TRUE(has(by_method(10), "Lambert azimuthal equal area is not supported")) << by_method(10);
  EXPECT_TRUE(has(by_method(3), "oblique Mercator")) << by_method(3);
  EXPECT_TRUE(has(by_method(999), "projection method 999")) << by_method(999);
  EXPECT_TRUE(has(refusal({code(1024, 1), code(3072, 3035)}, ErrorCode::unsupported_version), "LAEA Europe"));
  EXPECT_TRUE(has(refusal({code(1024, 3)}, ErrorCode::unsupported_version), "geocentric"));
  EXPECT_TRUE(has(refusal({}, ErrorCode::not_found), "--crs"));
  EXPECT_TRUE(
      has(refusal({code(1024, 1), code(2048, 4326), code(3075, 8)}, ErrorCode::not_found), "GeoKey 3078"));
}

TEST(CrsGeoKeys, ValuesOfTheWrongType) {
  EXPECT_TRUE(has(refusal({text(1024, "1")}, ErrorCode::corrupt), "GeoKey 1024"));
  const GeoKey two{3080, std::vector<double>{1, 2}};
  EXPECT_TRUE(
      has(refusal({code(1024, 1), code(2048, 4326), code(3075, 1), two}, ErrorCode::corrupt), "GeoKey 3080"));
}

TEST(CrsGeoKeys, DescriptionsOfReaders) {
  CrsDescription said;
  EXPECT_EQ(crs_of(said).error().code, ErrorCode::not_found);
  said.kind = CrsDescription::Kind::geographic_wgs84;
  EXPECT_EQ(crs_of(said)->definition().name, "EPSG:4326 (WGS 84)");
  said.kind = CrsDescription::Kind::epsg;
  said.epsg = 3857;
  EXPECT_EQ(crs_of(said)->definition().method, CrsMethod::web_mercator);
  said.epsg = 4294967295U;
  EXPECT_EQ(crs_of(said).error().code, ErrorCode::not_found);
  said.kind = CrsDescription::Kind::geo_keys;
  said.geo_keys = {code(1024, 1), code(3072, 32601)};
  EXPECT_EQ(crs_of(said)->definition().longitude_origin_deg, -177);
  said.kind = CrsDescription::Kind::wkt;
  EXPECT_EQ(crs_of(said).error().code, ErrorCode::invalid_input);
  said.text = "PROJCS[\"WGS_1984_UTM_Zone_33N\",GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\"]]]";
  EXPECT_EQ(crs_of(said)->definition().name, "EPSG:32633 (WGS 84 / UTM zone 33N)");
}

}  // namespace
}  // namespace cuesta
