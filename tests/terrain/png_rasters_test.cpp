/// One PNG of heights, and folders of web tiles.

#include <png.h>

#include <numbers>

#include "tests/terrain/raster_files.h"

namespace cuesta {
namespace {

using test::ramp;

/// Rows of packed big-endian samples.
std::string png(std::uint32_t width, std::uint32_t height, int depth, int colour, const std::string& pixels,
                bool interlaced = false) {
  png_structp out = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(out);
  std::string bytes;
  png_set_write_fn(
      out, &bytes,
      [](png_structp p, png_bytep data, std::size_t n) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(data), n);
      },
      nullptr);
  png_set_IHDR(out, info, width, height, depth, colour, interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(out, info);
  std::vector<png_bytep> rows;
  for (std::uint32_t y = 0; y < height; ++y)
    rows.push_back(reinterpret_cast<png_bytep>(const_cast<char*>(pixels.data())) +
                   y * pixels.size() / height);
  png_write_image(out, rows.data());
  png_write_end(out, info);
  png_destroy_write_struct(&out, &info);
  return bytes;
}

/// 65536 R + 256 G + B of each sample, as RGB.
std::string rgb(const std::vector<std::uint32_t>& samples) {
  std::string out;
  for (const std::uint32_t s : samples) out += {char(s >> 16), char(s >> 8), char(s)};
  return out;
}

TEST(Png, GrayOf16BitsWithOptions) {
  const test::ScratchFolder folder;
  auto heights = ramp(31, 17);
  heights[4] = 60000;
  for (const bool interlaced : {false, true}) {
    const auto path = folder.write("a.png", png(31, 17, 16, PNG_COLOR_TYPE_GRAY,
                                                test::packed<std::uint16_t>(heights, true), interlaced));
    const auto raster = test::open_raster(path);
    ASSERT_TRUE(raster);
    EXPECT_EQ(raster->info().type, SampleType::u16);
    EXPECT_FALSE(raster->info().is_placed);
    test::expect_heights(*raster, heights);
    test::expect_windows_equal_whole(*raster);
    const auto scaled = test::open_raster(
        path, {.placement = Placement{5, 6, 1, 1}, .no_data = 60000, .scale = 0.5, .offset = -10});
    EXPECT_EQ(test::height_at(*scaled, 1, 0), heights[1] * 0.5 - 10);
    EXPECT_TRUE(std::isnan(test::height_at(*scaled, 4, 0)));
    EXPECT_EQ(scaled->info().map.x0, 5);
    const auto with_sign = test::open_raster(path, {.type = SampleType::i16});
    EXPECT_EQ(test::height_at(*with_sign, 4, 0), 60000 - 65536);
  }
}

TEST(Png, GrayOf8Bits) {
  const test::ScratchFolder folder;
  const auto raster = test::open_raster(
      folder.write("a.png", png(9, 5, 8, PNG_COLOR_TYPE_GRAY, test::packed<std::uint8_t>(ramp(9, 5)))));
  ASSERT_TRUE(raster);
  test::expect_heights(*raster, ramp(9, 5));
}

TEST(Png, TerrainRgbAndTerrarium) {
  const test::ScratchFolder folder;
  const auto path = folder.write("a.png", png(2, 1, 8, PNG_COLOR_TYPE_RGB, rgb({0x0186A0, 0x830080})));
  const auto terrain_rgb = test::open_raster(path, {.png_heights = PngHeights::terrain_rgb});
  ASSERT_TRUE(terrain_rgb);
  EXPECT_DOUBLE_EQ(test::height_at(*terrain_rgb, 0, 0), 0);
  const auto terrarium = test::open_raster(path, {.png_heights = PngHeights::terrarium});
  ASSERT_TRUE(terrarium);
  EXPECT_EQ(test::height_at(*terrarium, 1, 0), 768.5);
}

TEST(Png, TransparentPixelsAreNoHeights) {
  const test::ScratchFolder folder;
  const auto path =
      folder.write("a.png", png(2, 1, 8, PNG_COLOR_TYPE_RGB_ALPHA, std::string("\1\2\3\377\1\2\3\0", 8)));
  const auto raster = test::open_raster(path, {.png_heights = PngHeights::terrarium});
  ASSERT_TRUE(raster);
  EXPECT_EQ(test::height_at(*raster, 0, 0), 256 + 2 + 3.0 / 256 - 32768);
  EXPECT_TRUE(std::isnan(test::height_at(*raster, 1, 0)));
}

TEST(Png, ColoursWithoutAMeaningAreRefused) {
  const test::ScratchFolder folder;
  const Error error = test::open_error(folder.write("a.png", png(1, 1, 8, PNG_COLOR_TYPE_RGB, "abc")));
  EXPECT_EQ(error.code, ErrorCode::unsupported_version);
  EXPECT_NE(error.message.find("terrarium"), std::string::npos);
}

TEST(Png, DamageIsToldByRow) {
  const test::ScratchFolder folder;
  const std::string good =
      png(31, 17, 16, PNG_COLOR_TYPE_GRAY, test::packed<std::uint16_t>(ramp(31, 17), true));
  const auto raster = test::open_raster(folder.write("a.png", good.substr(0, good.size() / 2)));
  ASSERT_TRUE(raster);
  std::vector<double> heights(31 * 17);
  const auto read = raster->read({0, 0, 31, 17}, heights);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::corrupt);
  EXPECT_NE(read.error().place.find("row"), std::string::npos) << read.error().text();
}

class TilesTest : public testing::Test {
 protected:
  /// Terrarium tiles of 4 × 4: heights 100 x + 10 y + row of the pixel.
  void write_tile(unsigned zoom, unsigned x, unsigned y, unsigned side = 4) {
    std::vector<std::uint32_t> samples;
    for (unsigned i = 0; i < side * side; ++i) samples.push_back((32768 + 100 * x + 10 * y + i / side) * 256);
    const auto path = folder_ / (std::to_string(zoom) + "/" + std::to_string(x));
    std::filesystem::create_directories(path);
    std::ofstream(path / (std::to_string(y) + ".png"), std::ios::binary)
        << png(side, side, 8, PNG_COLOR_TYPE_RGB, rgb(samples));
  }
  RasterOptions options_{.png_heights = PngHeights::terrarium};
  test::ScratchFolder folder_;
};

TEST_F(TilesTest, AreOneRasterInWebMercator) {
  for (const auto& [x, y] : {std::pair{4u, 2u}, {5u, 2u}, {4u, 3u}}) write_tile(3, x, y);
  write_tile(1, 0, 0);
  const auto raster = test::open_raster(folder_ / "", options_);
  ASSERT_TRUE(raster);
  const RasterInfo& info = raster->info();
  EXPECT_EQ(info.width, 8u);
  EXPECT_EQ(info.height, 8u);
  EXPECT_EQ(info.crs.epsg, 3857u);
  const double tile_m = 2 * std::numbers::pi * 6378137 / 8;
  EXPECT_NEAR(info.map.x(-0.5, 0), 0, 1e-6);           // the west side of column 4 of 8
  EXPECT_NEAR(info.map.y(0, -0.5), 2 * tile_m, 1e-6);  // the north side of row 2 of 8
  EXPECT_NEAR(info.map.x_per_column, tile_m / 4, 1e-6);
  EXPECT_EQ(test::height_at(*raster, 0, 0), 420);
  EXPECT_EQ(test::height_at(*raster, 7, 1), 521);
  EXPECT_EQ(test::height_at(*raster, 3, 7), 433);
  EXPECT_TRUE(std::isnan(test::height_at(*raster, 4, 4)));  // no such tile
  test::expect_windows_equal_whole(*raster);
  options_.zoom = 1;
  EXPECT_EQ(test::open_raster(folder_ / "", options_)->info().width, 4u);
}

TEST_F(TilesTest, RasterJsonSaysHowColoursAreHeights) {
  write_tile(2, 1, 1);
  EXPECT_NE(test::open_error(folder_ / "").message.find("png_heights"), std::string::npos);
  folder_.write("raster.json", R"({"png_heights": "terrarium"})");
  EXPECT_EQ(test::height_at(*test::open_raster(folder_ / ""), 0, 3), 113);
}

TEST_F(TilesTest, WhatIsNotATileIsTold) {
  EXPECT_EQ(test::open_error(folder_ / "", options_).code, ErrorCode::invalid_input);
  write_tile(2, 1, 1);
  write_tile(2, 2, 1, 8);
  const auto raster = test::open_raster(folder_ / "", options_);
  ASSERT_TRUE(raster);
  std::vector<double> heights(raster->info().width * raster->info().height);
  const auto read = raster->read({0, 0, raster->info().width, raster->info().height}, heights);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().file.find(".png"), std::string::npos);
  options_.zoom = 7;
  EXPECT_EQ(test::open_error(folder_ / "", options_).code, ErrorCode::not_found);
}

}  // namespace
}  // namespace cuesta
