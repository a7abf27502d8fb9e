/// USGS DEM, and the sidecars of Esri that place images.

#include <fmt/format.h>
#include <png.h>

#include "tests/shared_data.h"
#include "tests/terrain/memory_file.h"
#include "tests/terrain/raster_files.h"
#include "tests/terrain/tiff_files.h"

namespace cuesta {
namespace {

const double none = std::nan("");

struct Profile {
  double x, y;
  std::vector<int> heights;  ///< from the south
};

struct Recipe {
  int system = 1, zone = 10, ground_unit = 2, height_unit = 2, datum = 0;
  double dx = 30, dy = 30, dz = 1;
  std::vector<Profile> profiles = {{500010, 4000000, {1, 2, 3}}, {500040, 4000030, {12, -32767, 14}}};
};

std::string fortran(double value, int width, int digits) {
  std::string text = fmt::format("{:{}.{}E}", value, width, digits);
  std::ranges::replace(text, 'E', 'D');
  return text;
}

std::string dem(const Recipe& r) {
  std::string out = fmt::format("{:<144}{:6}{:6}{:6}{:6}", "MADE UP", 1, 1, r.system, r.zone);
  for (int i = 0; i < 15; ++i) out += fortran(0, 24, 15);
  out += fmt::format("{:6}{:6}{:6}", r.ground_unit, r.height_unit, 4);
  for (int i = 0; i < 11; ++i) out += fortran(0, 24, 15);
  out += fmt::format("{:6}{:12.6E}{:12.6E}{:12.6E}{:6}{:6}", 1, r.dx, r.dy, r.dz, 1, r.profiles.size());
  out.resize(888, ' ');
  out += r.datum == 0 ? "    " : fmt::format("{:2}{:2}", 3, r.datum);
  out.resize(1024, ' ');
  for (std::size_t i = 0; i < r.profiles.size(); ++i) {
    const Profile& p = r.profiles[i];
    out += fmt::format("{:6}{:6}{:6}{:6}", 1, i + 1, p.heights.size(), 1) + fortran(p.x, 24, 15) +
           fortran(p.y, 24, 15) + fortran(0, 24, 15) + fortran(0, 24, 15) + fortran(0, 24, 15);
    std::size_t left = 146;
    for (const int height : p.heights) {
      if (left-- == 0) {
        out.resize((out.size() + 1023) / 1024 * 1024, ' ');
        left = 169;
      }
      out += fmt::format("{:6}", height);
    }
    out.resize((out.size() + 1023) / 1024 * 1024, ' ');
  }
  return out;
}

TEST(UsgsDem, ProfilesRunNorthAndBeginWhereTheQuadrangleDoes) {
  const test::ScratchFolder folder;
  const auto raster = test::open_raster(folder.write("a.dem", dem({})));
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().map, (PostingMap{500010, 4000090, 30, 0, 0, -30}));
  EXPECT_EQ(raster->info().crs.epsg, 32610u);
  EXPECT_EQ(raster->info().vertical_datum, VerticalDatum::orthometric);
  EXPECT_EQ(raster->info().warnings.size(), 1u);
  test::expect_heights(*raster, {none, 14, 3, none, 2, 12, 1, none});
  test::expect_windows_equal_whole(*raster);
}

TEST(UsgsDem, LongProfilesGoOnInFurtherRecords) {
  const test::ScratchFolder folder;
  for (const std::size_t count : {145u, 146u, 147u, 316u, 317u, 700u}) {
    Recipe recipe{.profiles = {{0, 0, {}}, {30, 0, {5}}}};
    for (std::size_t i = 0; i < count; ++i) recipe.profiles[0].heights.push_back(int(i * 7 % 1000));
    std::string bytes = dem(recipe);
    bytes.resize(bytes.find_last_not_of(' ') + 1);  // the last record may be cut off
    const auto raster = test::open_raster(folder.write("a.dem", bytes));
    ASSERT_TRUE(raster);
    ASSERT_EQ(raster->info().height, count);
    for (std::size_t i = 0; i < count; ++i)
      ASSERT_EQ(test::height_at(*raster, 0, count - 1 - i), double(i * 7 % 1000));
    EXPECT_EQ(test::height_at(*raster, 1, count - 1), 5);
  }
}

TEST(UsgsDem, UnitsAndSystems) {
  const test::ScratchFolder folder;
  const auto degrees = test::open_raster(
      folder.write("a.dem", dem({.system = 0,
                                 .zone = 0,
                                 .ground_unit = 3,
                                 .height_unit = 1,
                                 .datum = 4,
                                 .dx = 3,
                                 .dy = 3,
                                 .profiles = {{-439200, 165600, {10, 20}}, {-439197, 165600, {30, 40}}}})));
  ASSERT_TRUE(degrees);
  EXPECT_NEAR(degrees->info().map.x0, -122, 1e-12);
  EXPECT_NEAR(degrees->info().map.y0, 46 + 3.0 / 3600, 1e-12);
  EXPECT_EQ(degrees->info().crs.epsg, 4269u);
  EXPECT_TRUE(degrees->info().warnings.empty());
  EXPECT_NEAR(test::height_at(*degrees, 0, 1), 3.048, 1e-12);
  EXPECT_EQ(test::open_error(folder.write("b.dem", dem({.system = 2}))).code, ErrorCode::unsupported_version);
  const auto old = test::open_raster(folder.write("c.dem", dem({.datum = 1})));
  ASSERT_TRUE(old);
  EXPECT_EQ(old->info().crs.epsg, 26710u);  // NAD27: the Crs of it is refused by name
}

TEST(UsgsDem, WhatIsWrongIsToldWithItsPlace) {
  const test::ScratchFolder folder;
  Recipe uneven;
  uneven.profiles[1].x += 10;
  EXPECT_EQ(test::open_error(folder.write("a.dem", dem(uneven))).place, "byte 2048");
  std::string bytes = dem({});
  bytes.replace(1024 + 144 + 6, 6, "  what");
  const auto raster = test::open_raster(folder.write("b.dem", bytes));
  ASSERT_TRUE(raster);
  std::vector<double> heights(8);
  const auto read = raster->read({0, 0, 2, 4}, heights);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().place, "byte 1174");
}

TEST(UsgsDem, CutOffAnywhereOrChangedItIsReadOrRefused) {
  const std::string whole = dem({});
  const auto try_it = [](const std::string& bytes) {
    const auto raster = open_usgs_dem(test::memory_file("a.dem", bytes), {});
    if (!raster) {
      EXPECT_FALSE(raster.error().message.empty());
      return;
    }
    const RasterInfo& info = (*raster)->info();
    ASSERT_LE(info.width * info.height, 10'000u);
    std::vector<double> heights(info.width * info.height);
    (void)(*raster)->read({0, 0, info.width, info.height}, heights).has_value();
  };
  for (std::size_t size = 0; size < whole.size(); size += size < 900 ? 7 : 3) try_it(whole.substr(0, size));
  for (std::size_t at = 144; at < whole.size(); ++at) {
    if (whole[at] == ' ') continue;
    for (const char c : {'9', '-', 'x'}) {
      std::string bytes = whole;
      bytes[at] = c;
      try_it(bytes);
    }
  }
}

TEST(UsgsDem, SaintHelens) {
  CUESTA_NEED_SHARED(path, "dem/SainteHelens.dem");
  const auto raster = test::open_raster(path);
  ASSERT_TRUE(raster);
  const RasterInfo& info = raster->info();
  EXPECT_EQ(info.format, "USGS DEM");
  EXPECT_EQ(info.width, 327u);
  EXPECT_EQ(info.map.x0, 557820);
  EXPECT_EQ(info.map.x_per_column, 30);
  EXPECT_EQ(info.crs.epsg, 32610u);
  const auto heights = test::whole(*raster);
  double least = 1e9, most = 0;
  for (const double height : heights) {
    if (std::isnan(height)) continue;
    least = std::min(least, height);
    most = std::max(most, height);
  }
  EXPECT_EQ(least, 682);  // as the header says
  EXPECT_EQ(most, 2543);
  const auto row = std::uint64_t((info.map.y0 - 5121240) / 30);
  EXPECT_EQ(test::height_at(*raster, 0, row), 909);  // the first profile begins there
  EXPECT_EQ(test::height_at(*raster, 0, row - 1), 910);
}

TEST(WorldFile, PlacesATiffWithoutTags) {
  const test::ScratchFolder folder;
  test::write_tiff(folder / "a.tif", {.width = 3, .height = 2, .rows_per_strip = 1}, test::ramp(3, 2));
  EXPECT_FALSE(test::open_raster(folder / "a.tif")->info().is_placed);
  for (const char* name : {"a.wld", "a.tifw", "a.tfw"}) {
    folder.write(name, "10\r\n0\r\n0\r\n-20\r\n500005\r\n4000090\r\n");
    const auto raster = test::open_raster(folder / "a.tif");
    ASSERT_TRUE(raster);
    EXPECT_TRUE(raster->info().is_placed);
    EXPECT_EQ(raster->info().map, (PostingMap{500005, 4000090, 10, 0, 0, -20}));
    EXPECT_EQ(raster->info().files.back(), (folder / name).string());
  }
  folder.write("a.prj", "PROJCS[\"WGS_1984_UTM_Zone_33N\"]");
  EXPECT_EQ(test::open_raster(folder / "a.tif")->info().crs.kind, CrsDescription::Kind::wkt);
  const auto placed = test::open_raster(folder / "a.tif", {.placement = Placement{.x = 1, .y = 2}});
  ASSERT_TRUE(placed);
  EXPECT_EQ(placed->info().map.x0, 1);
}

TEST(WorldFile, DoesNotMoveATiffWithTags) {
  const test::ScratchFolder folder;
  test::TiffRecipe recipe{.width = 3, .height = 2, .rows_per_strip = 1};
  recipe.tie_points = {0, 0, 0, 100, 200, 0};
  recipe.pixel_scale = {1, 1, 0};
  test::write_tiff(folder / "a.tif", recipe, test::ramp(3, 2));
  folder.write("a.tfw", "10 0 0 -20 500005 4000090");
  EXPECT_EQ(test::open_raster(folder / "a.tif")->info().map.x0, 100.5);
}

TEST(WorldFile, PlacesAPngAlsoRotated) {
  const test::ScratchFolder folder;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = 2;
  image.height = 2;
  image.format = PNG_FORMAT_GRAY;
  const std::array<png_byte, 4> pixels{1, 2, 3, 4};
  ASSERT_TRUE(png_image_write_to_file(&image, (folder / "a.png").c_str(), 0, pixels.data(), 0, nullptr));
  folder.write("a.pgw", "0.8\n0.6\n0.6\n-0.8\n100\n200\n");
  const auto raster = test::open_raster(folder / "a.png");
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().map, (PostingMap{100, 200, 0.8, 0.6, 0.6, -0.8}));
  folder.write("a.pgw", "0.8\n0.6\n0.6\n");
  const Error error = test::open_error(folder / "a.png");
  EXPECT_EQ(error.place, "line 4");
  EXPECT_NE(error.file.find("a.pgw"), std::string::npos);
}

}  // namespace
}  // namespace cuesta
