#include "terrain/terrain_metadata.h"

#include <gtest/gtest.h>

#include <bit>
#include <nlohmann/json.hpp>

namespace cuesta {
namespace {

using nlohmann::ordered_json;

std::string metadata_of(const TerrainFacts& facts) {
  ordered_json json{{"program", "cuesta"}};
  json["terrain"] = ordered_json::parse(terrain_json(facts));
  return json.dump();
}

TerrainFacts full_facts(Frame frame) {
  TerrainFacts f;
  f.frame = std::move(frame);
  f.heights = VerticalDatum::ellipsoidal;
  f.geoid = "egm96-15";
  f.least_m = -430.1;
  f.most_m = 8848.0 + 1.0 / 3;
  f.sea_level_m = -100.0 / 3;
  f.bounds = GeoBox{179.5, -20.0 / 3, 181.25, 1e-300};
  f.spacing_m = 92.6;
  f.postings = 18446744073709551615u;
  f.no_data = 7;
  f.filled = 8;
  f.raised = 9;
  f.files = {{"N27E086.hgt", "SRTM", "EPSG:4326", VerticalDatum::orthometric, "EGM96", 1442401},
             {"Großglockner \"1\".tif", "GeoTIFF", "", VerticalDatum::unknown, "", 12}};
  return f;
}

void expect_same(double a, double b, const char* what) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b)) << what << " " << a << " " << b;
}

void expect_same(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.kind(), b.kind());
  EXPECT_EQ(a.description(), b.description());
  expect_same(a.origin().lat_deg, b.origin().lat_deg, "latitude");
  expect_same(a.origin().lon_deg, b.origin().lon_deg, "longitude");
  expect_same(a.origin().h_m, b.origin().h_m, "height");
  const Vec3d p = a.position_m({45.123456789, 7.987654321, 1234.5});
  const Vec3d q = b.position_m({45.123456789, 7.987654321, 1234.5});
  expect_same(p.x, q.x, "x");
  expect_same(p.y, q.y, "y");
  expect_same(p.z, q.z, "z");
}

void expect_same(const CrsDefinition& a, const CrsDefinition& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.datum, b.datum);
  EXPECT_EQ(a.method, b.method);
  expect_same(a.datum_offset_m, b.datum_offset_m, "datum offset");
  expect_same(a.ellipsoid.equatorial_radius_m, b.ellipsoid.equatorial_radius_m, "radius");
  expect_same(a.ellipsoid.inverse_flattening, b.ellipsoid.inverse_flattening, "flattening");
  expect_same(a.unit, b.unit, "unit");
  expect_same(a.prime_meridian_deg, b.prime_meridian_deg, "prime meridian");
  expect_same(a.latitude_origin_deg, b.latitude_origin_deg, "latitude of origin");
  expect_same(a.longitude_origin_deg, b.longitude_origin_deg, "longitude of origin");
  expect_same(a.parallel_1_deg, b.parallel_1_deg, "parallel 1");
  expect_same(a.parallel_2_deg, b.parallel_2_deg, "parallel 2");
  expect_same(a.scale, b.scale, "scale");
  expect_same(a.false_easting_m, b.false_easting_m, "false easting");
  expect_same(a.false_northing_m, b.false_northing_m, "false northing");
}

TerrainFacts round_trip(const TerrainFacts& facts) {
  auto back = terrain_facts(metadata_of(facts));
  EXPECT_TRUE(back) << back.error().text();
  EXPECT_TRUE(back && *back);
  return back && *back ? **back : TerrainFacts{};
}

TEST(TerrainMetadata, NumbersSurviveBitForBit) {
  const TerrainFacts facts = full_facts(Frame::ecef());
  const TerrainFacts back = round_trip(facts);
  EXPECT_EQ(back.heights, facts.heights);
  EXPECT_EQ(back.geoid, facts.geoid);
  expect_same(back.least_m, facts.least_m, "least");
  expect_same(back.most_m, facts.most_m, "most");
  expect_same(back.sea_level_m, facts.sea_level_m, "sea level");
  EXPECT_EQ(back.bounds, facts.bounds);
  expect_same(back.spacing_m, facts.spacing_m, "spacing");
  EXPECT_EQ(back.postings, facts.postings);
  EXPECT_EQ(back.no_data, facts.no_data);
  EXPECT_EQ(back.filled, facts.filled);
  EXPECT_EQ(back.raised, facts.raised);
  EXPECT_EQ(back.files, facts.files);
  EXPECT_EQ(terrain_json(back), terrain_json(facts));
  EXPECT_FALSE(round_trip(TerrainFacts{}).bounds);
}

TEST(TerrainMetadata, FramesSurviveBitForBit) {
  const Frame globe = Frame::ecef();
  expect_same(round_trip(full_facts(globe)).frame, globe);
  for (const Geodetic origin :
       {Geodetic{46.1, 7.3, 1500.7}, Geodetic{-90, 0, 2800}, Geodetic{1.0 / 3, -180, 0}}) {
    const Frame local = Frame::enu(origin).value();
    expect_same(round_trip(full_facts(local)).frame, local);
  }
}

TEST(TerrainMetadata, ProjectedFramesSurviveBitForBit) {
  // One of each method, in metres, feet and US survey feet, with parameters that are not round.
  for (const int epsg : {32633, 2154, 5070, 3031, 3395, 3857, 2277, 32661, 27572}) {
    const auto crs = Crs::from_epsg(epsg);
    if (!crs) continue;  // a datum that is refused
    const Frame plane = Frame::projected(*crs).value();
    const Frame back = round_trip(full_facts(plane)).frame;
    ASSERT_NE(back.crs(), nullptr) << epsg;
    expect_same(back.crs()->definition(), crs->definition());
    EXPECT_EQ(back.description(), plane.description());
    const PlanePoint p{1234567.1, 5345678.9};
    EXPECT_EQ(back.position_m(*crs, p, 0.1), plane.position_m(*crs, p, 0.1)) << "the same plane: no detour";
  }
}

TEST(TerrainMetadata, APlaneThatIsNowhereSurvives) {
  CrsDefinition definition;
  definition.method = CrsMethod::plane;
  definition.name = "a plane in metres";
  const Frame plane = Frame::projected(Crs::from_definition(definition).value()).value();
  const Frame back = round_trip(full_facts(plane)).frame;
  ASSERT_NE(back.crs(), nullptr);
  expect_same(back.crs()->definition(), definition);
  EXPECT_EQ(back.position_m(*plane.crs(), {1.5, -2.5}, 3), (Vec3d{1.5, -2.5, 3}));
}

TEST(TerrainMetadata, OtherFilesAreNoTerrain) {
  for (const char* text : {"{}", "", "no JSON", "[1]", "{\"terrains\": 1}", "\"terrain\""}) {
    const auto facts = terrain_facts(text);
    ASSERT_TRUE(facts) << text;
    EXPECT_FALSE(*facts) << text;
  }
}

/// Every key of `json`, and of what is in it, by a path as JSON pointers are.
std::vector<ordered_json::json_pointer> pointers(const ordered_json& json,
                                                 const ordered_json::json_pointer& at) {
  std::vector<ordered_json::json_pointer> all;
  if (json.is_structured()) {
    for (const auto& [key, value] : json.items()) {
      const auto here = json.is_array() ? at / static_cast<std::size_t>(std::stoul(key)) : at / key;
      all.push_back(here);
      for (const auto& p : pointers(value, here)) all.push_back(p);
    }
  }
  return all;
}

TEST(TerrainMetadata, EveryKeyIsChecked) {
  for (const Frame& frame :
       {Frame::enu({46, 7, 1500}).value(), Frame::projected(Crs::from_epsg(32633).value()).value()}) {
    const ordered_json whole = ordered_json::parse(metadata_of(full_facts(frame)));
    const auto all = pointers(whole["terrain"], ordered_json::json_pointer("/terrain"));
    ASSERT_GT(all.size(), 25u);
    for (const auto& at : all) {
      if (at.back() == "description") continue;  // for people
      ordered_json wrong = whole;
      wrong[at] = nullptr;
      const auto facts = terrain_facts(wrong.dump());
      ASSERT_FALSE(facts) << at.to_string();
      EXPECT_EQ(facts.error().code, ErrorCode::corrupt);
      EXPECT_NE(facts.error().place.find("terrain"), std::string::npos) << facts.error().place;
    }
  }
}

TEST(TerrainMetadata, DamageGivesErrors) {
  const std::string whole = metadata_of(full_facts(Frame::projected(Crs::from_epsg(2154).value()).value()));
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const auto facts = terrain_facts(std::string_view(whole).substr(0, n));
    EXPECT_TRUE(facts && !*facts) << "cut at " << n << ": no JSON, so no terrain";
  }
  std::size_t refused = 0;
  for (std::size_t n = 0; n < whole.size(); ++n) {
    std::string wrong = whole;
    wrong[n] = static_cast<char>(wrong[n] ^ 5);
    refused += !terrain_facts(wrong) ? 1u : 0u;
  }
  EXPECT_GT(refused, 100u);
}

TEST(TerrainMetadata, ImpossibleFactsAreRefused) {
  ordered_json whole = ordered_json::parse(metadata_of(full_facts(Frame::enu({46, 7, 1500}).value())));
  const auto refused = [&](const char* pointer, const ordered_json& value) {
    ordered_json wrong = whole;
    wrong[ordered_json::json_pointer(pointer)] = value;
    return !terrain_facts(wrong.dump());
  };
  EXPECT_TRUE(refused("/terrain/frame/origin/lat_deg", 91));
  EXPECT_TRUE(refused("/terrain/frame/kind", "flat"));
  EXPECT_TRUE(refused("/terrain/most_m", -431));
  EXPECT_TRUE(refused("/terrain/bounds/east", 0));
  EXPECT_TRUE(refused("/terrain/postings", -1));
  EXPECT_TRUE(refused("/terrain/heights", "above sea"));
  EXPECT_TRUE(refused("/terrain/files", "many"));
  EXPECT_FALSE(refused("/terrain/most_m", 9000));
}

TEST(TerrainMetadata, NamesThatAreNoUtf8DoNotStopABuild) {
  TerrainFacts facts;
  facts.files = {{"\xff\xfe.hgt", "SRTM", "", VerticalDatum::unknown, "", 1}};
  EXPECT_EQ(round_trip(facts).files[0].name, "\uFFFD\uFFFD.hgt");
}

}  // namespace
}  // namespace cuesta
