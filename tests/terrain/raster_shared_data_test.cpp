/// Real rasters: counts and extremes as another library found them, and single postings read by hand.

#include "tests/shared_data.h"
#include "tests/terrain/raster_files.h"

namespace cuesta {
namespace {

struct Known {
  const char* file;
  std::uint64_t width, height, voids, zeros;
  double least, most;
  double left, top;  ///< outer corner of the north-western pixel
  double spacing;
  RasterOptions options = {};
};

void PrintTo(const Known& known, std::ostream* out) {
  *out << known.file;
}

class KnownRaster : public testing::TestWithParam<Known> {};

TEST_P(KnownRaster, HasTheHeightsThatOthersFound) {
  const Known& known = GetParam();
  CUESTA_NEED_SHARED(path, std::string("dem/") + known.file);
  const auto raster = test::open_raster(path, known.options);
  ASSERT_TRUE(raster);
  const RasterInfo& info = raster->info();
  EXPECT_EQ(info.width, known.width);
  EXPECT_EQ(info.height, known.height);
  std::uint64_t voids = 0, zeros = 0;
  double least = 1e9, most = -1e9;
  std::vector<double> rows(info.width * 100);
  for (std::uint64_t row = 0; row < info.height; row += 100) {
    const std::uint64_t count = std::min<std::uint64_t>(100, info.height - row);
    const auto read = raster->read({0, row, info.width, count}, std::span(rows).first(count * info.width));
    ASSERT_TRUE(read) << read.error().text();
    for (const double height : std::span(rows).first(count * info.width)) {
      voids += std::isnan(height);
      zeros += height == 0;
      if (height < least) least = height;
      if (height > most) most = height;
    }
  }
  EXPECT_EQ(voids, known.voids);
  EXPECT_EQ(zeros, known.zeros);
  EXPECT_EQ(least, known.least);
  EXPECT_EQ(most, known.most);
  const PostingMap& map = info.map;
  const double north = std::max(map.y(0, 0), map.y(0, double(info.height - 1)));
  EXPECT_NEAR(map.x_per_column, known.spacing, 2e-5 * known.spacing);
  EXPECT_NEAR(map.x0 - 0.5 * known.spacing, known.left, 6e-5);
  EXPECT_NEAR(north + 0.5 * std::abs(map.y_per_row), known.top, 6e-5);
}

constexpr double second3 = 1.0 / 1200, second1 = 1.0 / 3600;
INSTANTIATE_TEST_SUITE_P(
    Dem, KnownRaster,
    testing::Values(
        Known{"N00E010.hgt", 1201, 1201, 0, 0, 1, 1005, 9.9996, 1.0004, second3},
        Known{"N00E011.hgt.zip", 1201, 1201, 0, 0, 105, 1023, 10.9996, 1.0004, second3},
        Known{"N41E001.hgt.zip", 1201, 1201, 134, 234517, -20, 1204, 0.9996, 42.0004, second3},
        Known{"N42E001.hgt.zip", 1201, 1201, 7652, 0, 349, 3100, 0.9996, 43.0004, second3},
        Known{"N48W125.hgt.zip", 3601, 3601, 6483876, 3701390, -13, 1095, -125.0001, 49.0001, second1},
        Known{"N49E011.hgt.zip", 1201, 1201, 20, 0, 234, 920, 10.9996, 50.0004, second3},
        Known{"N50E011.hgt.zip", 1201, 1201, 8, 0, 129, 1044, 10.9996, 51.0004, second3},
        Known{"S29W072.hgt.zip", 1201, 1201, 21, 1038016, -5, 1899, -72.0004, -27.9996, second3},
        Known{"N49W123.tif", 1201, 1201, 34926, 29657, -37, 2674, -123.0004, 50.0004, second3},
        Known{"N49W124.tif", 1201, 1201, 25620, 517486, -26, 2630, -124.0004, 50.0004, second3},
        Known{"egm84-epsg3857.tif", 624, 510, 0, 0, -107.23247528076172, 81.18753051757812, -20037507.1113,
              16375930.8674, 64187.51096011377},
        Known{"mt_everest_90m.tif", 1201, 1201, 130953, 0, 192, 8642, 85.9996, 28.0004, second3},
        Known{"mt_rainier_90m.tif", 1201, 1201, 9033, 0, 263, 4371, -122.0004, 47.0004, second3},
        Known{"mmgis_missionDEM.tif", 348, 337, 0, 0, -4472.669921875, -4437.8828125, 8142406, -276455, 1},
        Known{"oggm_columbia.tif", 639, 590, 0, 29553, -147.18533325195312, 3688.2509765625, -81622.7763,
              6823468.9454, 100},
        Known{"taudem_enogeo.tif", 715, 844, 0, 0, 177.972412109375, 241.217041015625, -79.1561, 36.2391,
              9.259259259299422e-05},
        Known{"worldwind_elev16_wgs84.tif", 512, 512, 0, 0, 49, 1772, -121.0002, 46.0002,
              0.001953848379785933},
        Known{"gmt_BEDMAP_elevation.nc", 1333, 1333, 380872, 1025, -6887, 4364, -3333134, 3331866, 5000},
        Known{"gmt_bathy_1m.nc", 601, 451, 0, 0, -5158.37353515625, 1116.6751708984375, -33.00833, 43.00833,
              1.0 / 60},
        Known{"gmt_data_w_nans.nc", 1000, 800, 410661, 0, -4719, -4100, -135.6, -14.9, 0.0010000000474974513},
        Known{"etopo5.cdf.gz", 4320, 2161, 0, 79645, -10376, 7833, -0.04167, 90.04167, 1.0 / 12}));

TEST(KnownPostings, OfSrtm) {
  struct Posting {
    std::uint64_t column, row;
    double height;
  };
  const auto check = [](const std::filesystem::path& path, std::initializer_list<Posting> postings) {
    const auto raster = test::open_raster(path);
    ASSERT_TRUE(raster);
    for (const auto& [column, row, height] : postings)
      EXPECT_TRUE(test::same(test::height_at(*raster, column, row), height)) << path << column << row;
  };
  const std::filesystem::path africa = test::shared_data("dem/N00E010.hgt");
  if (africa.empty())
    GTEST_SKIP() << "dem/N00E010.hgt"
                 << " is not in ../shared/data";
  check(africa, {{0, 0, 57}, {1200, 0, 505}, {600, 600, 651}, {1200, 1200, 216}, {17, 1101, 59}});
  const std::filesystem::path andorra = test::shared_data("dem/N42E001.hgt.zip");
  if (andorra.empty())
    GTEST_SKIP() << "dem/N42E001.hgt.zip"
                 << " is not in ../shared/data";
  check(andorra, {{0, 0, 838}, {1200, 0, 360}, {600, 600, 1095}, {1200, 1200, 707}, {17, 1101, 709}});
  const std::filesystem::path pacific = test::shared_data("dem/N48W125.hgt.zip");
  if (pacific.empty())
    GTEST_SKIP() << "dem/N48W125.hgt.zip"
                 << " is not in ../shared/data";
  check(pacific, {{0, 0, std::nan("")}, {3600, 3600, 544}, {3000, 3000, 82}});
}

TEST(KnownPostings, NeighboursAgreeOnTheirBorder) {
  const std::filesystem::path west = test::shared_data("dem/N00E010.hgt");
  if (west.empty())
    GTEST_SKIP() << "dem/N00E010.hgt"
                 << " is not in ../shared/data";
  const std::filesystem::path east = test::shared_data("dem/N00E011.hgt.zip");
  if (east.empty())
    GTEST_SKIP() << "dem/N00E011.hgt.zip"
                 << " is not in ../shared/data";
  const auto left = test::open_raster(west), right = test::open_raster(east);
  ASSERT_TRUE(left && right);
  EXPECT_EQ(left->info().map.x(1200, 0), right->info().map.x(0, 0));
  EXPECT_EQ(test::window_of(*left, {1200, 0, 1, 1201}), test::window_of(*right, {0, 0, 1, 1201}));
}

TEST(KnownPostings, OfRawFiles) {
  const std::filesystem::path everest = test::shared_data("dem/everest1025.i16");
  if (everest.empty())
    GTEST_SKIP() << "dem/everest1025.i16"
                 << " is not in ../shared/data";
  const auto raster = test::open_raster(everest);
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().width, 1025u);
  EXPECT_EQ(test::height_at(*raster, 682, 235), 6629);
  const auto heights = test::whole(*raster);
  EXPECT_EQ(*std::max_element(heights.begin(), heights.end()), 6629);
}

TEST(KnownPostings, OfAGeoidInCentimetres) {
  CUESTA_NEED_SHARED(path, "dem/WW15MGH.DAC");
  RasterOptions options{.format = RasterFormat::raw, .type = SampleType::i16, .byte_order = ByteOrder::big};
  options.width = 1440;
  options.unit_m = 0.01;
  const auto raster = test::open_raster(path, options);
  ASSERT_TRUE(raster);
  const auto heights = test::whole(*raster);
  EXPECT_NEAR(*std::min_element(heights.begin(), heights.end()), -106.99, 1e-9);
  EXPECT_NEAR(*std::max_element(heights.begin(), heights.end()), 85.39, 1e-9);
}

TEST(KnownPostings, TerrainRgbIsTheSameFujiAsRaw) {
  const std::filesystem::path png = test::shared_data("dem/martini_fuji_terrainrgb.png");
  if (png.empty())
    GTEST_SKIP() << "dem/martini_fuji_terrainrgb.png"
                 << " is not in ../shared/data";
  const std::filesystem::path raw = test::shared_data("dem/fuji513.i16");
  if (raw.empty())
    GTEST_SKIP() << "dem/fuji513.i16"
                 << " is not in ../shared/data";
  const auto colours = test::open_raster(png, {.png_heights = PngHeights::terrain_rgb});
  const auto samples = test::open_raster(raw);
  ASSERT_TRUE(colours && samples);
  const auto a = test::whole(*colours), b = test::window_of(*samples, {0, 0, 512, 512});
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1.0) << i;
}

TEST(KnownPostings, EsriAsciiBasin) {
  CUESTA_NEED_SHARED(path, "dem/landlab_Square_TestBasin.asc");
  const auto raster = test::open_raster(path);
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().map, (PostingMap{15, 5985, 30, 0, 0, -30}));
  double most = 0;
  for (const double height : test::whole(*raster)) {
    if (height > most) most = height;
  }
  EXPECT_EQ(float(most), 230.27064514160156F);
  EXPECT_TRUE(std::isnan(test::height_at(*raster, 0, 0)));
  test::expect_windows_equal_whole(*raster);
}

TEST(KnownPostings, EtopoHasTheTibetanPlateauWhereItIs) {
  CUESTA_NEED_SHARED(path, "dem/etopo5.cdf.gz");
  const auto raster = test::open_raster(path);
  ASSERT_TRUE(raster);
  const PostingMap& map = raster->info().map;
  EXPECT_EQ(map.x_per_column, 360.0 / 4320);
  const auto at = [&](double longitude, double latitude) {
    return test::height_at(*raster, std::uint64_t(std::lround((longitude - map.x0) / map.x_per_column)),
                           std::uint64_t(std::lround((latitude - map.y0) / map.y_per_row)));
  };
  EXPECT_GT(at(88, 33), 4000);          // Tibet
  EXPECT_LT(at(142.2, 11.35), -7000);   // Mariana Trench
  EXPECT_GT(at(180, -80 - 9.9), 2000);  // the South Pole
}

}  // namespace
}  // namespace cuesta
