#include "terrain/crs_wkt.h"

#include <gtest/gtest.h>

#include <string>

namespace cuesta {
namespace {

TEST(CrsWkt, CodeOfTheOutermostNode) {
  EXPECT_EQ(epsg_of_wkt(R"(PROJCS["WGS 84 / UTM zone 33N",
    GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,AUTHORITY["EPSG","7030"]],
      AUTHORITY["EPSG","6326"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]],
    PROJECTION["Transverse_Mercator"],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AXIS["Easting",EAST],
    AUTHORITY["EPSG","32633"]])"),
            32633);
  EXPECT_EQ(epsg_of_wkt(R"(GEOGCRS["NAD83", DATUM["North American Datum 1983", ELLIPSOID["GRS 1980", 6378137,
    298.257222101]], CS[ellipsoidal,2], ID["EPSG",4269]])"),
            4269);
  EXPECT_EQ(epsg_of_wkt(R"(geogcs("a name with [ and , in it",authority("EPSG","4258")))"), 4258);
  // The code of an inner node is not that of the system.
  EXPECT_EQ(
      epsg_of_wkt(R"(PROJCS["own grid",GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]],PROJECTION["Krovak"]])"),
      std::nullopt);
}

TEST(CrsWkt, NamesOfEsri) {
  EXPECT_EQ(
      epsg_of_wkt(R"(GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137,298.257223563]]])"),
      4326);
  EXPECT_EQ(epsg_of_wkt(R"(PROJCS["WGS_1984_UTM_Zone_7S",GEOGCS["GCS_WGS_1984"]])"), 32707);
  EXPECT_EQ(epsg_of_wkt(R"(PROJCS["NAD_1983_UTM_Zone_12N",GEOGCS["GCS_North_American_1983"]])"), 26912);
  EXPECT_EQ(epsg_of_wkt(R"(PROJCS["British_National_Grid",GEOGCS["GCS_OSGB_1936"]])"), 27700);
  for (const char* name :
       {"WGS_1984_UTM_Zone_61N", "WGS_1984_UTM_Zone_N", "WGS_1984_UTM_Zone_", "WGS_1984_UTM_Zone_1",
        "NAD_1983_UTM_Zone_12S", "ETRS_1989_UTM_Zone_5N", "WGS_1984_UTM_Zone_033N", ""}) {
    EXPECT_EQ(epsg_of_wkt(std::string("PROJCS[\"") + name + "\"]"), std::nullopt) << name;
  }
}

TEST(CrsWkt, DamagedTexts) {
  const std::string good = R"(PROJCS["WGS 84 / UTM zone 33N",GEOGCS["WGS 84"],AUTHORITY["EPSG","32633"]])";
  for (std::size_t length = 0; length < good.size(); ++length) (void)epsg_of_wkt(good.substr(0, length));
  for (const char* text :
       {"", "\"", "[", "]]]]", "PROJCS[", "PROJCS[\"", "A[\"x\",AUTHORITY[\"EPSG\",\"99999999999\"]]",
        "A[\"x\",AUTHORITY[\"EPSG\",\"-1\"]]", "A[\"x\",ID[\"EPSG\",]]"}) {
    EXPECT_EQ(epsg_of_wkt(text), std::nullopt) << text;
  }
  EXPECT_EQ(epsg_of_wkt(std::string(1 << 20, '[')), std::nullopt);
}

}  // namespace
}  // namespace cuesta
