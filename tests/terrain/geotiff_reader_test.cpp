#include <tiff.h>

#include "terrain/geo_keys.h"
#include "tests/shared_data.h"
#include "tests/terrain/raster_files.h"
#include "tests/terrain/tiff_files.h"

namespace cuesta {
namespace {

using test::ramp;
using test::TiffRecipe;

/// Model: geographic, EPSG 4326; `raster_type` 1 area, 2 point.
std::vector<std::uint16_t> wgs84_keys(std::uint16_t raster_type) {
  return {1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, raster_type, 2048, 0, 1, 4326};
}

test::Raster written(const test::ScratchFolder& folder, const TiffRecipe& recipe,
                     const std::vector<double>& heights, const RasterOptions& options = {}) {
  test::write_tiff(folder / "a.tif", recipe, heights);
  return test::open_raster(folder / "a.tif", options);
}

/// All that libtiff writes of a type: each compression, with the predictors that it can have.
std::vector<TiffRecipe> recipes_of(SampleType type) {
  std::vector<TiffRecipe> recipes;
  const bool is_float = type == SampleType::f32 || type == SampleType::f64;
  for (const int compression : {COMPRESSION_NONE, COMPRESSION_PACKBITS, COMPRESSION_LZW,
                                COMPRESSION_ADOBE_DEFLATE, COMPRESSION_ZSTD}) {
    const bool has_predictor = compression != COMPRESSION_NONE && compression != COMPRESSION_PACKBITS;
    for (const int predictor : {1, is_float ? 3 : 2}) {
      if (predictor != 1 && !has_predictor) continue;
      for (const std::uint32_t tile : {0, 16}) {
        for (const bool big_endian : {false, true})
          recipes.push_back({.type = type,
                             .compression = std::uint16_t(compression),
                             .predictor = std::uint16_t(predictor),
                             .tile = tile,
                             .big_endian = big_endian});
      }
    }
  }
  return recipes;
}

class EachType : public testing::TestWithParam<SampleType> {};

TEST_P(EachType, IsReadWithAllCompressionsAndPredictors) {
  const SampleType type = GetParam();
  const bool is_float = type == SampleType::f32 || type == SampleType::f64;
  auto heights = ramp(37, 29);
  if (is_float || type == SampleType::i16 || type == SampleType::i32) heights[5] = -11034;
  if (is_float) heights[6] = 0.5;
  const test::ScratchFolder folder;
  for (const TiffRecipe& recipe : recipes_of(type)) {
    SCOPED_TRACE(testing::Message() << "compression " << recipe.compression << ", predictor "
                                    << recipe.predictor << ", tiles of " << recipe.tile << ", big-endian "
                                    << recipe.big_endian);
    const auto raster = written(folder, recipe, heights, {.cache_bytes = 3000});
    ASSERT_TRUE(raster);
    EXPECT_EQ(raster->info().type, type);
    test::expect_heights(*raster, heights);
    test::expect_windows_equal_whole(*raster);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EachType,
                         testing::Values(SampleType::u8, SampleType::i8, SampleType::u16, SampleType::i16,
                                         SampleType::u32, SampleType::i32, SampleType::f32, SampleType::f64),
                         [](const auto& type) { return name(type.param); });

TEST(GeoTiff, BigTiffIsRead) {
  const test::ScratchFolder folder;
  const auto heights = ramp(37, 29);
  const auto raster = written(folder, {.big_tiff = true}, heights);
  ASSERT_TRUE(raster);
  test::expect_heights(*raster, heights);
}

TEST(GeoTiff, PixelIsAreaIsShiftedByHalfAPixelAndPointIsNot) {
  const test::ScratchFolder folder;
  TiffRecipe recipe{.tie_points = {0, 0, 0, 10, 50, 0}, .pixel_scale = {0.5, 0.25, 0}};
  recipe.geo_keys = wgs84_keys(1);
  const auto area = written(folder, recipe, ramp(37, 29));
  ASSERT_TRUE(area);
  EXPECT_EQ(area->info().map, (PostingMap{10.25, 49.875, 0.5, 0, 0, -0.25}));
  recipe.geo_keys = wgs84_keys(2);
  const auto point = written(folder, recipe, ramp(37, 29));
  ASSERT_TRUE(point);
  EXPECT_EQ(point->info().map, (PostingMap{10, 50, 0.5, 0, 0, -0.25}));
  EXPECT_EQ(point->info().map.x(2, 3), 11);
  EXPECT_EQ(point->info().map.y(2, 3), 49.25);
  EXPECT_TRUE(point->info().is_placed);
  EXPECT_EQ(point->info().crs.kind, CrsDescription::Kind::geo_keys);
  EXPECT_EQ(short_key(point->info().crs.geo_keys, geo_key::geodetic_crs), 4326);
  recipe.geo_keys = {};  // area is what GeoTIFF means by nothing
  EXPECT_EQ(written(folder, recipe, ramp(37, 29))->info().map.x0, 10.25);
}

TEST(GeoTiff, TiePointAwayFromTheCorner) {
  const test::ScratchFolder folder;
  const TiffRecipe recipe{
      .tie_points = {4, 8, 0, 100, 200, 0}, .pixel_scale = {10, 5, 0}, .geo_keys = wgs84_keys(2)};
  const auto raster = written(folder, recipe, ramp(37, 29));
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().map.x(4, 8), 100);
  EXPECT_EQ(raster->info().map.y(4, 8), 200);
}

TEST(GeoTiff, TransformationMayRotate) {
  const test::ScratchFolder folder;
  TiffRecipe recipe{.transformation = {3, 1, 0, 100, 2, -4, 0, 500, 0, 0, 0, 0, 0, 0, 0, 1}};
  recipe.geo_keys = wgs84_keys(2);
  EXPECT_EQ(written(folder, recipe, ramp(37, 29))->info().map, (PostingMap{100, 500, 3, 2, 1, -4}));
  recipe.geo_keys = wgs84_keys(1);
  EXPECT_EQ(written(folder, recipe, ramp(37, 29))->info().map, (PostingMap{102, 499, 3, 2, 1, -4}));
}

TEST(GeoTiff, ControlPointsAreRefused) {
  const test::ScratchFolder folder;
  const TiffRecipe recipe{.tie_points = {0, 0, 0, 1, 1, 0, 9, 9, 0, 2, 2, 0, 0, 9, 0, 1, 2, 0}};
  test::write_tiff(folder / "a.tif", recipe, ramp(37, 29));
  const Error error = test::open_error(folder / "a.tif");
  EXPECT_EQ(error.code, ErrorCode::unsupported_version);
  EXPECT_NE(error.message.find("3 ground control points"), std::string::npos) << error.text();
}

TEST(GeoTiff, WithoutAPlaceItSaysSo) {
  const test::ScratchFolder folder;
  const auto raster = written(folder, {}, ramp(37, 29));
  ASSERT_TRUE(raster);
  EXPECT_FALSE(raster->info().is_placed);
  EXPECT_EQ(raster->info().map, PostingMap{});
}

TEST(GeoTiff, NoDataIsNaN) {
  const test::ScratchFolder folder;
  for (const auto& [type, text, value] :
       {std::tuple{SampleType::i16, "-32767", -32767.0},
        {SampleType::f32, "-3.4028234663852886e+38", -3.4028234663852886e38},
        {SampleType::f32, "-3.40282347e+38", -3.4028234663852886e38},
        {SampleType::f32, "0.1", double(0.1F)},
        {SampleType::f64, "nan", std::nan("")},
        {SampleType::f32, "-9999", -9999.0}}) {
    auto heights = ramp(37, 29);
    heights[40] = value;
    const auto raster = written(folder, {.type = type, .no_data = text}, heights);
    ASSERT_TRUE(raster);
    heights[40] = std::nan("");
    test::expect_heights(*raster, heights);
  }
}

TEST(GeoTiff, InfiniteSamplesAreNoHeights) {
  const test::ScratchFolder folder;
  auto heights = ramp(37, 29);
  heights[3] = std::numeric_limits<double>::infinity();
  const auto raster = written(folder, {.type = SampleType::f64}, heights);
  ASSERT_TRUE(raster);
  EXPECT_TRUE(std::isnan(test::height_at(*raster, 3, 0)));
}

TEST(GeoTiff, OptionsGoBeforeTheFile) {
  const test::ScratchFolder folder;
  const auto raster = written(folder, {.no_data = "5"}, std::vector<double>(37 * 29, 7),
                              {.placement = Placement{1, 2, 3, 4, PixelIs::area},
                               .epsg = 32633,
                               .no_data = 8,
                               .scale = 2,
                               .offset = 1,
                               .unit_m = 0.5});
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().map, (PostingMap{2.5, 0, 3, 0, 0, -4}));
  EXPECT_EQ(raster->info().crs.epsg, 32633u);
  EXPECT_EQ(test::height_at(*raster, 0, 0), 7.5);
}

TEST(GeoTiff, BlocksThatAreLeftOutAreNoData) {
  const test::ScratchFolder folder;
  const auto raster =
      written(folder, {.tile = 16, .no_data = "-9999", .leave_out_last_tile = true}, ramp(37, 29));
  ASSERT_TRUE(raster);
  EXPECT_TRUE(std::isnan(test::height_at(*raster, 36, 28)));
  EXPECT_FALSE(std::isnan(test::height_at(*raster, 31, 28)));
}

TEST(GeoTiff, VerticalUnitAndDatum) {
  const test::ScratchFolder folder;
  TiffRecipe recipe{.geo_keys = {1, 1, 0, 3, 1024, 0, 1, 2, 4096, 0, 1, 5703, 4099, 0, 1, 9002}};
  const auto feet = written(folder, recipe, std::vector<double>(37 * 29, 100));
  ASSERT_TRUE(feet);
  EXPECT_EQ(feet->info().vertical_datum, VerticalDatum::orthometric);
  EXPECT_EQ(feet->info().vertical_name, "NAVD88");
  EXPECT_DOUBLE_EQ(test::height_at(*feet, 0, 0), 30.48);
  recipe.geo_keys = {1, 1, 0, 2, 1024, 0, 1, 2, 4096, 0, 1, 5030};
  EXPECT_EQ(written(folder, recipe, ramp(37, 29))->info().vertical_datum, VerticalDatum::ellipsoidal);
  recipe.geo_keys = {1, 1, 0, 2, 1024, 0, 1, 2, 4099, 0, 1, 9999};
  test::write_tiff(folder / "b.tif", recipe, ramp(37, 29));
  EXPECT_EQ(test::open_error(folder / "b.tif").code, ErrorCode::unsupported_version);
}

TEST(GeoTiff, ScaleAndOffsetOfGdalsMetadata) {
  const test::ScratchFolder folder;
  const auto raster = written(
      folder,
      {.metadata =
           "<GDALMetadata>\n  <Item name=\"OFFSET\" sample=\"0\" role=\"offset\">-100</Item>\n  <Item "
           "name=\"SCALE\" sample=\"0\" role=\"scale\">0.25</Item>\n</GDALMetadata>\n"},
      std::vector<double>(37 * 29, 10));
  ASSERT_TRUE(raster);
  EXPECT_EQ(test::height_at(*raster, 1, 1), -97.5);
}

TEST(GeoTiff, PicturesAreRefused) {
  const test::ScratchFolder folder;
  test::write_tiff(folder / "a.tif", {.type = SampleType::u8, .channels = 3}, ramp(37, 29));
  EXPECT_EQ(test::open_error(folder / "a.tif").code, ErrorCode::unsupported_version);
}

TEST(GeoTiff, AStripThatIsTheWholeImageIsReadInBoundedMemory) {
  const test::ScratchFolder folder;
  TiffRecipe recipe{.width = 2500,
                    .height = 1200,
                    .compression = COMPRESSION_ADOBE_DEFLATE,
                    .predictor = 2,
                    .rows_per_strip = 1200};
  const auto heights = ramp(recipe.width, recipe.height);
  const auto raster = written(folder, recipe, heights);
  ASSERT_TRUE(raster);
  EXPECT_LE(raster->memory_bytes(), 1u << 20);
  test::expect_heights(*raster, heights);
  test::expect_windows_equal_whole(*raster, 5);
}

TEST(GeoKeys, EntriesOutsideTheirArraysAreErrors) {
  const std::vector<double> doubles{1, 2};
  const std::vector<std::uint16_t> good{1, 1, 0, 2, 2057, 34736, 2, 0, 1026, 34737, 4, 0};
  const auto keys = parse_geo_keys(good, doubles, "abc|");
  ASSERT_TRUE(keys);
  EXPECT_EQ((*keys)[0].id, 1026);
  EXPECT_EQ(std::get<std::string>((*keys)[0].value), "abc");
  EXPECT_EQ(std::get<std::vector<double>>((*keys)[1].value), doubles);
  for (const std::size_t at : {6, 7, 10, 11}) {
    auto bad = good;
    bad[at] = 60000;
    EXPECT_FALSE(parse_geo_keys(bad, doubles, "abc|")) << at;
  }
  EXPECT_FALSE(parse_geo_keys(std::span(good).first(8), doubles, "abc|"));
  EXPECT_FALSE(parse_geo_keys(std::span(good).first(3), doubles, "abc|"));
}

}  // namespace
}  // namespace cuesta
