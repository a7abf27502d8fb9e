/// Rasters through the built executable: build, info, sample, and when a file is up to date.

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"

namespace cuesta::test {
namespace {

using nlohmann::json;
using Heights = std::function<int(int column, int row)>;

constexpr int side = 61;
constexpr int no_data = -32768;

class TerrainCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream file(path(name), std::ios::binary);
    ASSERT_TRUE(file << bytes) << name;
  }
  /// A tile of a degree; rows run from the north.
  void write_hgt(const std::string& name, const Heights& height_m) const {
    std::string bytes;
    for (int row = 0; row < side; ++row)
      for (int column = 0; column < side; ++column) {
        const auto h = static_cast<std::uint16_t>(height_m(column, row));
        bytes += {static_cast<char>(h >> 8), static_cast<char>(h & 0xFF)};
      }
    write(name, bytes);
  }
  /// One undulation everywhere, in GeographicLib's format.
  void write_geoid(const std::string& name, double undulation_m) const {
    std::string text = "P5\n# Offset -108\n# Scale 0.003\n36 19\n65535\n";
    const auto sample = static_cast<std::uint16_t>(std::lround((undulation_m + 108) / 0.003));
    for (int i = 0; i < 36 * 19; ++i)
      text += {static_cast<char>(sample >> 8), static_cast<char>(sample & 0xFF)};
    write(name, text);
  }
  Outcome cuesta(std::vector<std::string> words) const { return run(folder_, std::move(words)); }
  Outcome build(std::vector<std::string> words) const {
    words.insert(words.begin(), "build");
    words.insert(words.end(), {"-o", path("out.cuesta"), "--quiet", "--threads", "2"});
    return cuesta(std::move(words));
  }
  /// Must succeed. @return the metadata's "terrain"
  json built(std::vector<std::string> words) const {
    const Outcome outcome = build(std::move(words));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const json info = json::parse(cuesta({"info", path("out.cuesta"), "--json"}).out, nullptr, false);
    EXPECT_TRUE(info.contains("metadata") && info["metadata"].contains("terrain")) << info.dump(1);
    return info["metadata"]["terrain"];
  }
  /// NaN where there is no data.
  double sampled(double lat_deg, double lon_deg) const {
    const Outcome outcome =
        cuesta({"sample", path("out.cuesta"), std::to_string(lat_deg), std::to_string(lon_deg), "--json"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const json found = json::parse(outcome.out, nullptr, false);
    EXPECT_EQ(found["points"].size(), 1u) << outcome.out;
    const json& height_m = found["points"][0]["height_m"];
    return height_m.is_number() ? height_m.get<double>() : std::nan("");
  }
  static bool is_up_to_date(const Outcome& outcome) {
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out.find("up to date") != std::string::npos;
  }

  TestFolder folder_;
};

/// A slope with a void of 3 × 3 postings in its middle.
int slope(int column, int row) {
  const bool is_void = std::abs(column - 30) <= 1 && std::abs(row - 30) <= 1;
  return is_void ? no_data : 1000 + 10 * column - 5 * row;
}

TEST_F(TerrainCommand, a_tile_is_built_told_about_and_sampled) {
  write_hgt("N46E007.hgt", slope);
  const json terrain = built({path("N46E007.hgt")});
  EXPECT_EQ(terrain["frame"]["kind"], "enu");
  EXPECT_EQ(terrain["heights"], "orthometric");
  EXPECT_EQ(terrain["postings"], side * side - 9);
  EXPECT_EQ(terrain["no_data"], 9);
  EXPECT_EQ(terrain["least_m"], 700);
  EXPECT_EQ(terrain["most_m"], 1600);
  EXPECT_NEAR(terrain["bounds"]["north"].get<double>(), 47, 1e-9);
  EXPECT_NEAR(terrain["bounds"]["west"].get<double>(), 7, 1e-9);
  EXPECT_NEAR(sampled(46.75, 7.25), 1000 + 150 - 75, 0.5);
  EXPECT_NEAR(sampled(46.1, 7.9), 1000 + 540 - 270, 0.5);
  EXPECT_TRUE(std::isnan(sampled(46.5, 7.5)));
  EXPECT_TRUE(std::isnan(sampled(45, 7.5)));
  const Outcome text = cuesta({"info", path("out.cuesta")});
  // 3600 cells; of 16 around the void those at its corners have 3 postings.
  EXPECT_NE(text.out.find("7,172 triangles"), std::string::npos) << text.out;
  EXPECT_EQ(cuesta({"verify", path("out.cuesta")}).status, 0);
}

TEST_F(TerrainCommand, voids_are_filled_or_flooded_and_counted) {
  write_hgt("N46E007.hgt", slope);
  json terrain = built({path("N46E007.hgt"), "--fill", "4"});
  EXPECT_EQ(terrain["filled"], 9);
  EXPECT_EQ(terrain["no_data"], 0);
  EXPECT_NEAR(sampled(46.5, 7.5), 1000 + 300 - 150, 0.5);
  terrain = built({path("N46E007.hgt"), "--sea-level", "1100"});
  EXPECT_EQ(terrain["least_m"], 1100);
  EXPECT_EQ(terrain["no_data"], 0);
  EXPECT_NEAR(sampled(46.5, 7.5), 1100, 0.5);
  int raised = 9;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      raised += slope(column, row) > 0 && slope(column, row) < 1100;
  EXPECT_EQ(terrain["raised"], raised);
}

TEST_F(TerrainCommand, frames_and_geoids) {
  write_hgt("N46E007.hgt", [](int, int) { return 500; });
  write_geoid("forty.pgm", 40);
  for (const char* frame : {"ecef", "enu"}) {
    const json terrain = built({path("N46E007.hgt"), "--frame", frame, "--geoid", path("forty.pgm")});
    EXPECT_EQ(terrain["frame"]["kind"], frame);
    EXPECT_EQ(terrain["heights"], "ellipsoidal");
    EXPECT_EQ(terrain["geoid"], "forty");
    EXPECT_NEAR(terrain["most_m"].get<double>(), 540, 0.01);
    EXPECT_NEAR(sampled(46.5, 7.5), 540, 0.6);
  }
  const Outcome projected = build({path("N46E007.hgt"), "--frame", "projected"});
  EXPECT_NE(projected.status, 0);
  EXPECT_NE(projected.err.find("projected"), std::string::npos) << projected.err;
  const Outcome absent = build({path("N46E007.hgt"), "--geoid", path("absent.pgm")});
  EXPECT_NE(absent.status, 0);
  EXPECT_NE(absent.err.find("absent.pgm"), std::string::npos) << absent.err;
}

TEST_F(TerrainCommand, several_tiles_are_one_surface) {
  const auto hill = [](int first_column) {
    return [first_column](int column, int row) {
      return int(std::lround(2000 - 0.4 * (std::pow(first_column + column - 60, 2) + std::pow(row - 30, 2))));
    };
  };
  write_hgt("N46E007.hgt", hill(0));
  write_hgt("N46E008.hgt", hill(60));
  const json terrain = built({path("N46E007.hgt"), path("N46E008.hgt")});
  EXPECT_EQ(terrain["postings"], side * (2 * side - 1));
  EXPECT_EQ(terrain["files"].size(), 2u);
  EXPECT_NEAR(sampled(46.5, 8), 2000, 0.5);
  const Outcome text = cuesta({"info", path("out.cuesta")});
  EXPECT_NE(text.out.find("14,400 triangles"), std::string::npos) << text.out;  // no crack: all cells
}

TEST_F(TerrainCommand, what_decides_about_a_file_makes_it_out_of_date) {
  write_geoid("geoid.pgm", 40);
  std::string text = "ncols 30\nnrows 20\nxllcenter 500000\nyllcenter 5000000\ncellsize 30\n";
  for (int i = 0; i < 600; ++i) text += std::to_string(i * 37 % 113) + ' ';
  write("a.asc", text);
  write("a.asc.json", R"({"epsg": 32632})");
  const std::vector<std::string> words{path("a.asc"),     "--frame",   "enu",        "--geoid",
                                       path("geoid.pgm"), "--heights", "orthometric"};
  EXPECT_FALSE(is_up_to_date(build(words)));
  EXPECT_TRUE(is_up_to_date(build(words)));
  auto flooded = words;
  flooded.insert(flooded.end(), {"--sea-level", "20"});
  EXPECT_FALSE(is_up_to_date(build(flooded)));
  EXPECT_FALSE(is_up_to_date(build(words)));
  write("a.asc.json", R"({"epsg": 32633})");
  EXPECT_FALSE(is_up_to_date(build(words)));
  write("a.prj", "PROJCS[\"unused\"]");
  EXPECT_FALSE(is_up_to_date(build(words)));
  write_geoid("geoid.pgm", 41);
  EXPECT_FALSE(is_up_to_date(build(words)));
  EXPECT_TRUE(is_up_to_date(build(words)));
}

TEST_F(TerrainCommand, sidecars_of_packed_rasters_count) {
  std::string text = "ncols 5\nnrows 4\nxllcenter 500000\nyllcenter 5000000\ncellsize 30\n";
  for (int i = 0; i < 20; ++i) text += std::to_string(i * 37 % 113) + ' ';
  write("a.asc", text);
  ASSERT_EQ(std::system(("gzip '" + path("a.asc") + "'").c_str()), 0);
  EXPECT_FALSE(is_up_to_date(build({path("a.asc.gz")})));
  EXPECT_TRUE(is_up_to_date(build({path("a.asc.gz")})));
  write("a.prj", "PROJCS[\"WGS 84 / UTM zone 32N\",AUTHORITY[\"EPSG\",\"32632\"]]");
  EXPECT_FALSE(is_up_to_date(build({path("a.asc.gz")})));
}

TEST_F(TerrainCommand, meshes_and_rasters_together_are_refused) {
  write_hgt("N46E007.hgt", slope);
  write("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const Outcome outcome = build({path("a.off"), path("N46E007.hgt")});
  EXPECT_NE(outcome.status, 0);
  EXPECT_NE(outcome.err.find("N46E007.hgt"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("build them apart"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(path("out.cuesta")));
}

TEST_F(TerrainCommand, what_cannot_be_a_terrain_is_refused_with_its_name) {
  write("N46E007.hgt", "not a square of samples");
  const Outcome cut = build({path("N46E007.hgt")});
  EXPECT_NE(cut.status, 0);
  EXPECT_NE(cut.err.find("N46E007.hgt"), std::string::npos) << cut.err;
  write_hgt("N46E008.hgt", [](int, int) { return no_data; });
  const Outcome empty = build({path("N46E008.hgt")});
  EXPECT_NE(empty.status, 0);
  EXPECT_NE(empty.err.find("no triangle"), std::string::npos) << empty.err;
  EXPECT_FALSE(std::filesystem::exists(path("out.cuesta")));
  EXPECT_FALSE(std::filesystem::exists(path("out.cuesta.work")));
}

}  // namespace
}  // namespace cuesta::test
