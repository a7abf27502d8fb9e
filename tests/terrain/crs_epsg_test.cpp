#include "terrain/crs_epsg.h"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "terrain/crs_datum.h"
#include "terrain/crs_epsg_table.h"

// The table against the EPSG dataset itself, as Debian's package proj-data has it: an SQLite file, read as
// such.
namespace cuesta {
namespace {

constexpr const char* dataset_path = "/usr/share/proj/proj.db";

using Row = std::map<std::string, std::string>;

class Dataset {
 public:
  Dataset() {
    EXPECT_EQ(sqlite3_open_v2(dataset_path, &db_, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
    for (const Row& row : rows("SELECT code, conv_factor FROM unit_of_measure WHERE auth_name = 'EPSG'")) {
      factors_[row.at("code")] = std::atof(row.at("conv_factor").c_str());
    }
  }
  ~Dataset() { sqlite3_close(db_); }
  Dataset(const Dataset&) = delete;
  Dataset& operator=(const Dataset&) = delete;

  std::vector<Row> rows(const std::string& sql) const {
    std::vector<Row> all;
    sqlite3_stmt* statement = nullptr;
    EXPECT_EQ(sqlite3_prepare_v2(db_, sql.c_str(), -1, &statement, nullptr), SQLITE_OK)
        << sqlite3_errmsg(db_);
    while (sqlite3_step(statement) == SQLITE_ROW) {
      Row& row = all.emplace_back();
      for (int i = 0; i < sqlite3_column_count(statement); ++i) {
        const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, i));
        row[sqlite3_column_name(statement, i)] = text ? text : "";
      }
    }
    sqlite3_finalize(statement);
    return all;
  }
  Row row(const std::string& sql) const {
    const auto all = rows(sql);
    return all.empty() ? Row{} : all.front();
  }
  double factor(const std::string& unit) const { return factors_.at(unit); }

  /// Degrees of a value; unit 9110 is degrees, minutes and seconds in decimal places.
  double degrees(double value, const std::string& unit) const {
    if (unit != "9110") return unit == "9102" ? value : value * factor(unit) * 57.295779513082323;
    const double whole = std::trunc(value + std::copysign(1e-9, value));
    const double hundredths = (value - whole) * 100;
    const double minutes = std::trunc(hundredths + std::copysign(1e-7, hundredths));
    return whole + minutes / 60 + (hundredths - minutes) * 100 / 3600;
  }

 private:
  sqlite3* db_ = nullptr;
  std::map<std::string, double> factors_;
};

/// Parameters of a conversion by EPSG's numbers, in degrees, metres and 1.
std::map<int, double> parameters(const Dataset& data, const Row& conversion) {
  std::map<int, double> all;
  for (int i = 1; i <= 7; ++i) {
    const std::string param = "param" + std::to_string(i) + "_";
    if (conversion.at(param + "code").empty()) continue;
    const int code = std::atoi(conversion.at(param + "code").c_str());
    const double value = std::atof(conversion.at(param + "value").c_str());
    const std::string unit = conversion.at(param + "uom_code");
    const std::set<int> angles = {8801, 8802, 8821, 8822, 8823, 8824, 8832, 8833};
    const std::set<int> lengths = {8806, 8807, 8826, 8827};
    all[code] = angles.contains(code)    ? data.degrees(value, unit)
                : lengths.contains(code) ? value * data.factor(unit)
                                         : value;
  }
  return all;
}

/// What the method's parameters mean in a CrsDefinition.
CrsDefinition meaning(int method, std::map<int, double> p) {
  const auto first_of = [&p](int a, int b, int c) {
    return p.contains(a) ? p[a] : p.contains(b) ? p[b] : p[c];
  };
  CrsDefinition d;
  d.latitude_origin_deg = first_of(8801, 8821, 0);
  d.longitude_origin_deg = first_of(8802, 8822, 8833);
  d.scale = p.contains(8805) ? p[8805] : 1;
  d.false_easting_m = first_of(8806, 8826, 0);
  d.false_northing_m = first_of(8807, 8827, 0);
  d.parallel_1_deg = p[8823];
  d.parallel_2_deg = p[8824];
  switch (method) {
    case 9801:
      d.method = CrsMethod::lambert_conformal;
      d.parallel_1_deg = d.parallel_2_deg = d.latitude_origin_deg;
      break;
    case 9802:
      d.method = CrsMethod::lambert_conformal;
      break;
    case 9807:
      d.method = CrsMethod::transverse_mercator;
      break;
    case 9822:
      d.method = CrsMethod::albers;
      break;
    case 9804:
      d.method = CrsMethod::mercator;
      break;
    case 1024:
      d.method = CrsMethod::web_mercator;
      break;
    case 9810:
      d.method = CrsMethod::polar_stereographic;
      d.parallel_1_deg = d.latitude_origin_deg;
      break;
    case 9829:
      d.method = CrsMethod::polar_stereographic;
      d.parallel_1_deg = p[8832];
      d.latitude_origin_deg = std::copysign(90.0, d.parallel_1_deg);
      break;
    default:
      ADD_FAILURE() << "method " << method;
  }
  return d;
}

void expect_same(const CrsDefinition& ours, const CrsDefinition& theirs) {
  EXPECT_EQ(ours.method, theirs.method);
  EXPECT_NEAR(ours.latitude_origin_deg, theirs.latitude_origin_deg, 1e-11);
  EXPECT_NEAR(std::remainder(ours.longitude_origin_deg - theirs.longitude_origin_deg, 360), 0, 1e-11);
  EXPECT_NEAR(ours.parallel_1_deg, theirs.parallel_1_deg, 1e-11);
  EXPECT_NEAR(ours.parallel_2_deg, theirs.parallel_2_deg, 1e-11);
  EXPECT_NEAR(ours.scale, theirs.scale, 1e-15);
  EXPECT_NEAR(ours.false_easting_m, theirs.false_easting_m, 1e-6);
  EXPECT_NEAR(ours.false_northing_m, theirs.false_northing_m, 1e-6);
}

class CrsEpsg : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(dataset_path)) {
      GTEST_SKIP() << dataset_path << " is not there (Debian package proj-data)";
    }
  }
};

TEST_F(CrsEpsg, ProjectedSystemsAreThoseOfTheDataset) {
  const Dataset data;
  std::size_t compared = 0;
  for (const int code : supported_epsg_codes()) {
    const Row system =
        data.row("SELECT * FROM projected_crs WHERE auth_name = 'EPSG' AND code = " + std::to_string(code));
    if (system.empty() || code == 3785) continue;  // geographic; a former code of 3857
    SCOPED_TRACE("EPSG:" + std::to_string(code) + " " + system.at("name"));
    const auto ours = crs_from_epsg(code).value();
    const Row conversion = data.row("SELECT * FROM conversion WHERE auth_name = 'EPSG' AND code = " +
                                    system.at("conversion_code"));
    const int method = std::atoi(conversion.at("method_code").c_str());
    expect_same(ours, meaning(method, parameters(data, conversion)));
    const Row axis = data.row(
        "SELECT uom_code FROM axis WHERE coordinate_system_auth_name = 'EPSG' AND "
        "coordinate_system_code = " +
        system.at("coordinate_system_code"));
    EXPECT_NEAR(ours.unit, data.factor(axis.at("uom_code")), 1e-15);
    const Datum* datum = find_datum(std::atoi(system.at("geodetic_crs_code").c_str()));
    ASSERT_NE(datum, nullptr);
    EXPECT_EQ(ours.datum, datum->name);
    EXPECT_NE(ours.name.find(system.at("name")), std::string::npos) << ours.name;
    ++compared;
  }
  EXPECT_GT(compared, 700U);
  std::printf("%zu projected systems agree with the EPSG dataset\n", compared);
}

TEST_F(CrsEpsg, DatumsAreThoseOfTheDataset) {
  const Dataset data;
  std::size_t compared = 0;
  for (const Row& row : data.rows(
           "SELECT g.code AS code, g.name AS name, g.type AS type, d.code AS datum, e.semi_major_axis AS a, "
           "e.inv_flattening AS f FROM geodetic_crs g JOIN geodetic_datum d ON g.datum_auth_name = "
           "d.auth_name AND "
           "g.datum_code = d.code JOIN ellipsoid e ON d.ellipsoid_auth_name = e.auth_name AND "
           "d.ellipsoid_code = e.code "
           "WHERE g.auth_name = 'EPSG' AND g.type <> 'geocentric'")) {
    const int code = std::atoi(row.at("code").c_str());
    SCOPED_TRACE("EPSG:" + row.at("code") + " " + row.at("name"));
    if (const char* refused = refused_datum(code)) {
      EXPECT_EQ(row.at("name"), refused);
      EXPECT_EQ(find_datum(code), nullptr);
      continue;
    }
    const Datum* datum = find_datum(code);
    if (!datum) continue;
    EXPECT_EQ(row.at("type"), is_geographic_3d(code) ? "geographic 3D" : "geographic 2D");
    EXPECT_EQ(std::atoi(row.at("datum").c_str()), datum->datum_epsg);
    EXPECT_EQ(row.at("name"), datum->name);
    EXPECT_EQ(std::atof(row.at("a").c_str()), datum->ellipsoid.equatorial_radius_m);
    EXPECT_EQ(std::atof(row.at("f").c_str()), datum->ellipsoid.inverse_flattening);
    ++compared;
  }
  EXPECT_GT(compared, 70U);
}

TEST_F(CrsEpsg, RefusedCodesHaveTheirNames) {
  const Dataset data;
  for (const EpsgRefused& refused : epsg_refused()) {
    const Row system = data.row("SELECT name FROM projected_crs WHERE auth_name = 'EPSG' AND code = " +
                                std::to_string(refused.code));
    ASSERT_FALSE(system.empty()) << refused.code;
    EXPECT_EQ(system.at("name"), refused.name);
    const auto result = crs_from_epsg(refused.code);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::unsupported_version);
  }
}

TEST(CrsEpsgTable, IsSortedWithoutDuplicates) {
  const auto rows = epsg_projected();
  for (std::size_t i = 1; i < rows.size(); ++i) EXPECT_LT(rows[i - 1].code, rows[i].code);
  for (const EpsgProjected& row : rows) {
    EXPECT_NE(find_datum(row.geographic_epsg), nullptr) << row.code;
    for (const EpsgUtmRun& run : epsg_utm_runs())
      EXPECT_FALSE(row.code >= run.first && row.code <= run.last) << row.code;
  }
}

}  // namespace
}  // namespace cuesta
