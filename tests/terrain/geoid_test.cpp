#include "terrain/geoid.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <thread>

namespace cuesta {
namespace {

namespace fs = std::filesystem;

/// A folder of the test's own, removed at the end.
class GeoidTest : public testing::Test {
 protected:
  GeoidTest()
      : folder_(fs::temp_directory_path() / ("cuesta_geoid_" + std::to_string(::getpid()) + "_" +
                                             testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(folder_);
  }
  ~GeoidTest() override { fs::remove_all(folder_); }

  fs::path file(const std::string& name) const { return folder_ / name; }
  GeoidOptions here() const {
    GeoidOptions options;
    options.folders = {folder_};
    return options;
  }
  /// Runs the converter; true if it ends well.
  static bool convert(const fs::path& gtx, const fs::path& pgm) {
    const std::string tool = std::string(CUESTA_SOURCE_DIR) + "/tools/geoid_from_gtx";
    return std::system(("python3 '" + tool + "' '" + gtx.string() + "' '" + pgm.string() + "' >'" +
                        pgm.string() + ".log' 2>&1")
                           .c_str()) == 0;
  }

  fs::path folder_;
};

/// N = 100·sin φ·(1 + cos λ)/2, in metres: smooth, and different in every direction.
double model_m(double lat_deg, double lon_deg) {
  const double degree = 0.017453292519943295;
  return 50 * std::sin(lat_deg * degree) * (1 + std::cos(lat_deg * degree) * std::cos(lon_deg * degree));
}

template <class T>
void put_big_endian(std::ostream& out, T value) {
  using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t,
                                  std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint16_t>>;
  Bits bits = std::bit_cast<Bits>(value);
  for (int shift = 8 * (static_cast<int>(sizeof(T)) - 1); shift >= 0; shift -= 8) {
    out.put(static_cast<char>((bits >> shift) & 0xff));
  }
}

/// The model in steps of a degree, as a .gtx that begins at `west_deg`.
void write_gtx(const fs::path& path, double west_deg, int columns = 360) {
  std::ofstream out(path, std::ios::binary);
  for (const double value : {-90.0, west_deg, 1.0, 1.0}) put_big_endian(out, value);
  put_big_endian(out, std::int32_t(181));
  put_big_endian(out, std::int32_t(columns));
  for (int row = 0; row < 181; ++row) {
    for (int column = 0; column < columns; ++column) {
      put_big_endian(out, static_cast<float>(model_m(row - 90, west_deg + column)));
    }
  }
}

/// The model in GeographicLib's format, without the converter, in steps of whole degrees.
void write_pgm(const fs::path& path, int step_deg = 1) {
  std::ofstream out(path, std::ios::binary);
  out << "P5\n# Description a model\n# Offset -108\n# Scale 0.003\n# MaxCubicError 0.25\n"
      << 360 / step_deg << ' ' << 180 / step_deg + 1 << "\n65535\n";
  for (int row = 0; row <= 180; row += step_deg) {
    for (int column = 0; column < 360; column += step_deg) {
      put_big_endian(out, static_cast<std::uint16_t>(std::lround((model_m(90 - row, column) + 108) / 0.003)));
    }
  }
}

const LatLon samples[] = {{0, 0},   {45.3, 10.7}, {-77.2, 179.99}, {12, -180},       {12, 180},
                          {90, 33}, {-90, 0},     {89.99, 270.4},  {-0.4667, 359.5}, {33, -122.25}};

TEST_F(GeoidTest, InterpolatesASmoothModel) {
  write_pgm(file("model.pgm"));
  const auto geoid = Geoid::open(file("model.pgm").string());
  ASSERT_TRUE(geoid) << geoid.error().text();
  EXPECT_TRUE(geoid->in_memory());
  EXPECT_EQ(geoid->name(), "model");
  EXPECT_EQ(geoid->max_error_m(), 0.25);
  EXPECT_NE(geoid->description().find("a model"), std::string::npos);
  for (const LatLon at : samples) {
    const double expected_m = model_m(at.lat_deg, at.lon_deg);
    EXPECT_NEAR(geoid->undulation_m(at), expected_m, 0.005) << at.lat_deg << ", " << at.lon_deg;
    EXPECT_NEAR(geoid->ellipsoidal_m(at, 1000), 1000 + expected_m, 0.005);
    EXPECT_NEAR(geoid->orthometric_m({at.lat_deg, at.lon_deg, 1000}), 1000 - expected_m, 0.005);
  }
}

TEST_F(GeoidTest, BoundedMemoryGivesTheSameHeights) {
  write_pgm(file("model.pgm"));
  const auto all = Geoid::open(file("model.pgm").string()).value();
  GeoidOptions small;
  small.memory_bytes = 20000;  // the file has 130,000
  auto some = Geoid::open(file("model.pgm").string(), small).value();
  EXPECT_FALSE(some.in_memory());
  for (const LatLon at : samples) EXPECT_EQ(some.undulation_m(at), all.undulation_m(at));
  ASSERT_TRUE(some.read_area(40, 170, 60, -170));  // across the antimeridian
  for (double lon = 165; lon < 195; lon += 0.37) {
    EXPECT_EQ(some.undulation_m({51.3, lon}), all.undulation_m({51.3, lon})) << lon;
  }
  for (const LatLon at : samples)
    EXPECT_EQ(some.undulation_m(at), all.undulation_m(at)) << "outside of the area";
  EXPECT_EQ(some.read_area(-90, -180, 90, 180).error().code, ErrorCode::out_of_budget);
}

TEST_F(GeoidTest, CallsAreConcurrent) {
  write_pgm(file("model.pgm"));
  GeoidOptions small;
  small.memory_bytes = 1;
  for (const GeoidOptions& options : {GeoidOptions{}, small}) {
    const auto geoid = Geoid::open(file("model.pgm").string(), options).value();
    std::vector<LatLon> at(3000);
    for (std::size_t i = 0; i < at.size(); ++i)
      at[i] = {std::fmod(double(i) * 7.3, 180) - 90, double(i) * 11.7};
    std::vector<double> rows(at.size());
    std::vector<double> points(at.size());
    std::thread other([&] { geoid.undulations_m(at, rows); });
    for (std::size_t i = 0; i < at.size(); ++i) points[i] = geoid.undulation_m(at[i]);
    other.join();
    EXPECT_EQ(rows, points);
  }
}

TEST_F(GeoidTest, NaNWhereThereIsNoPlace) {
  write_pgm(file("model.pgm"));
  const auto geoid = Geoid::open(file("model.pgm").string()).value();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const LatLon at : {LatLon{90.1, 0}, LatLon{nan, 0}, LatLon{0, nan},
                          LatLon{0, std::numeric_limits<double>::infinity()}}) {
    EXPECT_TRUE(std::isnan(geoid.undulation_m(at)));
  }
}

TEST_F(GeoidTest, NamesFindTheFinestDataSet) {
  write_pgm(file("egm96-15.pgm"));
  write_pgm(file("egm84-30.pgm"));
  EXPECT_EQ(Geoid::open("egm96", here())->name(), "egm96-15");
  EXPECT_EQ(Geoid::open("egm84", here())->name(), "egm84-30");
  write_pgm(file("egm96-5.pgm"));
  EXPECT_EQ(Geoid::open("egm96", here())->name(), "egm96-5");
  EXPECT_EQ(Geoid::open("egm96-15", here())->name(), "egm96-15");
}

TEST_F(GeoidTest, AMissingDataSetSaysWhatToDo) {
  const auto missing = Geoid::open("egm96", here());
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::not_found);
  const std::string text = missing.error().text();
  for (const std::string& part :
       {folder_.string(), std::string("egm96-5.pgm, egm96-15.pgm"),
        std::string("geographiclib-get-geoids egm96-5"), std::string("tools/geoid_from_gtx")}) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  EXPECT_EQ(Geoid::open("egm2008", here()).error().code, ErrorCode::not_found);
  EXPECT_EQ(Geoid::open("egm77", here()).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(Geoid::open("", here()).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(Geoid::open(file("no.pgm").string()).error().code, ErrorCode::not_found);
  EXPECT_EQ(Geoid::open("/usr/share/proj/egm96_15.gtx").error().code, ErrorCode::invalid_input);
}

TEST_F(GeoidTest, DamagedFilesAreRefused) {
  write_pgm(file("good.pgm"), 10);
  std::ifstream in(file("good.pgm"), std::ios::binary);
  const std::string good((std::istreambuf_iterator<char>(in)), {});
  const auto open = [&](const std::string& bytes) {
    fs::remove(file("bad.pgm"));  // ext4 writes a file that is cut and filled anew to disk at once: 4 ms
    std::ofstream(file("bad.pgm"), std::ios::binary) << bytes;
    return Geoid::open(file("bad.pgm").string());
  };
  const auto refused = [&](const std::string& bytes) {
    const auto geoid = open(bytes);
    return !geoid && geoid.error().code == ErrorCode::corrupt;
  };
  for (std::size_t length = 0; length < 200; ++length) EXPECT_TRUE(refused(good.substr(0, length))) << length;
  EXPECT_TRUE(refused(good.substr(0, good.size() - 1)));
  EXPECT_TRUE(refused(good + " "));
  const auto with = [&](const char* from, const char* to) {
    std::string bytes = good;
    return bytes.replace(bytes.find(from), std::strlen(from), to);
  };
  EXPECT_TRUE(refused(with("P5", "P6")));
  EXPECT_TRUE(refused(with("Scale 0.003", "Scale -0.003")));
  EXPECT_TRUE(refused(with("Scale 0.003", "Scale nan")));
  EXPECT_TRUE(refused(with("Scale 0.003", "Scale x")));
  EXPECT_TRUE(refused(with("Offset -108", "Offset inf")));
  EXPECT_TRUE(refused(with("36 19", "2000000000 2000000001")));
  EXPECT_TRUE(refused(with("36 19", "-36 19")));
  EXPECT_TRUE(refused(with("36 19", "19 36")));
  EXPECT_TRUE(refused(with("65535", "255")));
  for (std::size_t i = 0; i < 100; ++i) {  // every bit of the header: refused or a geoid, never a crash
    for (int bit = 0; bit < 8; ++bit) {
      std::string bytes = good;
      bytes[i] = static_cast<char>(bytes[i] ^ (1 << bit));
      if (const auto geoid = open(bytes)) (void)geoid->undulation_m({51, 7});
    }
  }
}

TEST_F(GeoidTest, ConverterTurnsGridsToGreenwich) {
  write_pgm(file("expected.pgm"));
  const auto expected = Geoid::open(file("expected.pgm").string()).value();
  for (const auto& [west_deg, columns] :
       {std::pair(-180.0, 360), std::pair(0.0, 360), std::pair(-180.0, 361)}) {
    write_gtx(file("model.gtx"), west_deg, columns);
    ASSERT_TRUE(convert(file("model.gtx"), file("model.pgm")));
    const auto geoid = Geoid::open(file("model.pgm").string());
    ASSERT_TRUE(geoid) << geoid.error().text();
    for (const LatLon at : samples) EXPECT_NEAR(geoid->undulation_m(at), expected.undulation_m(at), 1e-3);
  }
}

TEST_F(GeoidTest, ConverterRefusesWhatIsNoGridOfTheEarth) {
  write_gtx(file("regional.gtx"), -180, 300);
  EXPECT_FALSE(convert(file("regional.gtx"), file("out.pgm")));
  write_gtx(file("cut.gtx"), -180);
  fs::resize_file(file("cut.gtx"), fs::file_size(file("cut.gtx")) - 1);
  EXPECT_FALSE(convert(file("cut.gtx"), file("out.pgm")));
  EXPECT_FALSE(convert(file("absent.gtx"), file("out.pgm")));
  EXPECT_FALSE(fs::exists(file("out.pgm")));
}

// The test points that NGA publishes with EGM96: INPUT.DAT, and OUTPUT.DAT of F477, which sums the harmonic
// series.
TEST_F(GeoidTest, Egm96AtPublishedPoints) {
  const fs::path gtx = "/usr/share/proj/egm96_15.gtx";
  if (!fs::exists(gtx)) GTEST_SKIP() << gtx << " is not there (Debian package proj-data)";
  ASSERT_TRUE(convert(gtx, file("egm96-15.pgm")));
  const auto geoid = Geoid::open("egm96", here()).value();
  struct Point {
    LatLon at;
    double undulation_m;
  };
  const Point points[] = {{{38.6281550, 269.7791550}, -31.628}, {{-14.6212170, 305.0211140}, -2.969},
                          {{46.8743190, 102.4487290}, -43.575}, {{-23.6174460, 133.8747120}, 15.871},
                          {{38.6254730, 359.9995000}, 50.066},  {{-0.4667440, 0.0023000}, 17.329}};
  double worst_m = 0;
  for (const Point& point : points) {
    EXPECT_NEAR(geoid.undulation_m(point.at), point.undulation_m, 0.01);
    worst_m = std::max(worst_m, std::abs(geoid.undulation_m(point.at) - point.undulation_m));
  }
  std::printf("EGM96 at NGA's test points: worst %.4f m\n", worst_m);
}

}  // namespace
}  // namespace cuesta
