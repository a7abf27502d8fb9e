/// PNG files and picture comparison.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "runtime/draw/picture_compare.h"
#include "runtime/draw/png_file.h"

namespace cuesta::test {
namespace {

Picture noise(int width_px, int height_px, unsigned seed) {
  std::mt19937 random(seed);
  Picture picture{width_px, height_px, {}};
  picture.pixels.resize(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  for (Rgba8& p : picture.pixels)
    for (auto& c : p) c = static_cast<std::uint8_t>(random());
  return picture;
}

class PngFile : public testing::Test {
 protected:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("cuesta_png_" + std::to_string(::getpid()) + ".png");
  ~PngFile() override {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  std::string bytes() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  Result<Picture> read(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary) << bytes;
    return read_png(path_);
  }
};

TEST_F(PngFile, RoundTripIsExact) {
  for (const auto& [width, height] : {std::pair{1, 1}, {37, 5}, {640, 200}}) {
    const Picture picture = noise(width, height, 7);
    ASSERT_TRUE(write_png(path_, picture));
    const auto back = read_png(path_);
    ASSERT_TRUE(back) << back.error().text();
    EXPECT_EQ(back->width_px, width);
    EXPECT_EQ(back->height_px, height);
    EXPECT_EQ(back->pixels, picture.pixels);
    EXPECT_NE(bytes().find("sRGB"), std::string::npos);
  }
}

TEST_F(PngFile, TruncatedAnywhereIsCorrupt) {
  ASSERT_TRUE(write_png(path_, noise(7, 5, 1)));
  const std::string whole = bytes();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto picture = read(whole.substr(0, size));
    ASSERT_FALSE(picture) << size;
    EXPECT_EQ(picture.error().code, ErrorCode::corrupt) << size;
  }
}

TEST_F(PngFile, FlippedBitsNeverCrash) {
  ASSERT_TRUE(write_png(path_, noise(5, 5, 2)));
  const std::string whole = bytes();
  for (std::size_t bit = 0; bit < 8 * whole.size(); bit += 7) {
    std::string flipped = whole;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
    const auto picture = read(flipped);
    if (!picture) continue;
    EXPECT_EQ(picture->pixels.size(), static_cast<std::size_t>(picture->width_px * picture->height_px));
  }
}

TEST_F(PngFile, MorePixelsThanAllowedAreRefusedBeforeTheyAreAllocated) {
  ASSERT_TRUE(write_png(path_, noise(1, 1, 3)));
  std::string whole = bytes();
  const std::string sizes{0, 0, 0x4e, 0x20, 0, 0, 0x4e, 0x20};  // 20,000 × 20,000
  whole.replace(16, 8, sizes);
  std::uint32_t crc = 0xffffffff;
  for (std::size_t i = 12; i < 29; ++i) {
    crc ^= static_cast<std::uint8_t>(whole[i]);
    for (int k = 0; k < 8; ++k) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  for (std::size_t i = 0; i < 4; ++i) whole[29 + i] = static_cast<char>(~crc >> (24 - 8 * i));
  const auto picture = read(whole);
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().code, ErrorCode::out_of_budget);
}

TEST_F(PngFile, MissingFilesAndFoldersAreNamed) {
  const auto missing = read_png("/nonexistent/picture.png");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::not_found);
  EXPECT_EQ(missing.error().file, "/nonexistent/picture.png");
  EXPECT_FALSE(read_png(std::filesystem::temp_directory_path()));
  EXPECT_FALSE(write_png("/nonexistent/picture.png", noise(2, 2, 4)));
}

TEST(PictureCompare, EqualPicturesDoNotDiffer) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 40}, {64, 48}}) {
    const auto difference = compare(noise(width, height, 5), noise(width, height, 5));
    EXPECT_EQ(difference.max_channel, 0);
    EXPECT_EQ(difference.mean_channel, 0);
    EXPECT_NEAR(difference.ssim, 1, 1e-12);
    EXPECT_EQ(difference.fraction_within(0), 1);
  }
}

TEST(PictureCompare, OnePixelCountsOnce) {
  Picture a{10, 10, std::vector<Rgba8>(100, Rgba8{100, 100, 100, 255})};
  Picture b = a;
  b.pixels[42] = {100, 108, 98, 255};
  const auto difference = compare(a, b);
  EXPECT_EQ(difference.max_channel, 8);
  EXPECT_DOUBLE_EQ(difference.mean_channel, 10.0 / 400);
  EXPECT_DOUBLE_EQ(difference.fraction_within(7), 0.99);
  EXPECT_DOUBLE_EQ(difference.fraction_within(8), 1);
  EXPECT_LT(difference.ssim, 1);
}

TEST(PictureCompare, SsimFallsWithNoiseAndIsNegativeForTheInverse) {
  const Picture a = noise(64, 64, 6);
  Picture slightly = a, inverse = a;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      slightly.pixels[i][c] = static_cast<std::uint8_t>(a.pixels[i][c] ^ (i & 15));
      inverse.pixels[i][c] = static_cast<std::uint8_t>(255 - a.pixels[i][c]);
    }
  EXPECT_GT(compare(a, slightly).ssim, 0.9);
  EXPECT_LT(compare(a, slightly).ssim, 0.9999);
  EXPECT_LT(std::abs(compare(a, noise(64, 64, 8)).ssim), 0.3);
  EXPECT_LT(compare(a, inverse).ssim, -0.5);
}

/// Constant pictures have no structure: only the luminance term is left, which has a closed form.
TEST(PictureCompare, SsimOfConstantPicturesIsTheLuminanceTerm) {
  const Picture a{16, 16, std::vector<Rgba8>(256, Rgba8{100, 100, 100, 255})};
  const Picture b{16, 16, std::vector<Rgba8>(256, Rgba8{200, 200, 200, 255})};
  const double c1 = 2.55 * 2.55;
  EXPECT_NEAR(compare(a, b).ssim, (2 * 100 * 200 + c1) / (100 * 100 + 200 * 200 + c1), 1e-9);
}

}  // namespace
}  // namespace cuesta::test
