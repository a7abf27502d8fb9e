#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "terrain/height_raster.h"
#include "terrain/raster_sidecar.h"
#include "tools/terrain_generator/fractal_rows.h"
#include "tools/terrain_generator/make_terrain.h"

namespace cuesta::tools {
namespace {

/// A file of this test's own, gone at the end, with its sidecar.
class TerrainFile {
 public:
  TerrainFile()
      : path_(std::filesystem::temp_directory_path() /
              ("cuesta_terrain_" +
               std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".i16")) {}
  ~TerrainFile() {
    std::filesystem::remove(path_);
    std::filesystem::remove(sidecar_path(path_));
  }
  const std::filesystem::path& path() const { return path_; }
  std::string bytes() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  std::filesystem::path path_;
};

std::vector<double> heights_of(const std::filesystem::path& path) {
  const auto raster = open_height_raster(path);
  if (!raster) return {};
  std::vector<double> heights_m((*raster)->info().width * (*raster)->info().height);
  if (!(*raster)->read({0, 0, (*raster)->info().width, (*raster)->info().height}, heights_m)) return {};
  return heights_m;
}

/// A raster with its rows as they are, said to run from the south.
class SouthernFirst : public HeightRaster {
 public:
  explicit SouthernFirst(std::shared_ptr<const HeightRaster> raster)
      : HeightRaster(raster->info()), raster_(std::move(raster)) {
    info_.map.y_per_row = -info_.map.y_per_row;
  }
  std::uint64_t memory_bytes() const override { return raster_->memory_bytes(); }

 private:
  Result<void> read_window(const Window& window, std::span<double> heights) const override {
    return raster_->read(window, heights);
  }
  std::shared_ptr<const HeightRaster> raster_;
};

/// A slope of 3 m per column and -2 m per row.
Relief slope(std::uint64_t side) {
  return {side, [=](std::uint64_t first, std::span<double> heights_m) -> Result<void> {
            for (std::size_t i = 0; i < heights_m.size(); ++i)
              heights_m[i] = 3 * static_cast<double>(i % side) - 2 * static_cast<double>(first + i / side);
            return {};
          }};
}

TEST(MakeTerrain, is_a_raster_of_the_asked_size_and_place) {
  const TerrainFile file;
  ASSERT_TRUE(make_terrain(
      made_up_relief(17, 1), file.path(),
      {.side = 201, .spacing_m = 25, .epsg = 32633, .centre_x_m = 400'000, .centre_y_m = 5'000'000}));
  EXPECT_EQ(std::filesystem::file_size(file.path()), 201u * 201 * 2);
  const auto raster = open_height_raster(file.path());
  ASSERT_TRUE(raster) << raster.error().text();
  const RasterInfo& info = (*raster)->info();
  EXPECT_EQ(info.width, 201u);
  EXPECT_EQ(info.height, 201u);
  EXPECT_TRUE(info.is_placed);
  EXPECT_EQ(info.crs.epsg, 32633u);
  EXPECT_EQ(info.vertical_datum, VerticalDatum::orthometric);
  EXPECT_EQ(info.map.x(100, 100), 400'000);
  EXPECT_EQ(info.map.y(100, 100), 5'000'000);
  EXPECT_EQ(info.map.x(200, 0) - info.map.x(0, 0), 200 * 25);
}

TEST(MakeTerrain, same_bytes_for_the_same_seed_and_any_number_of_threads) {
  const TerrainFile file;
  const auto made = [&](std::size_t threads, std::uint64_t seed) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_TRUE(make_terrain(made_up_relief(33, 7), file.path(), {.side = 301, .seed = seed}));
    return file.bytes();
  };
  const std::string one = made(1, 5);
  EXPECT_EQ(one, made(4, 5));
  EXPECT_NE(one, made(4, 6));
}

TEST(MakeTerrain, without_roughness_the_relief_is_kept) {
  const TerrainFile file;
  ASSERT_TRUE(make_terrain(slope(17), file.path(), {.side = 161, .roughness = 0}));
  const std::vector<double> heights_m = heights_of(file.path());
  ASSERT_EQ(heights_m.size(), 161u * 161);
  for (std::size_t r = 20; r <= 140; r += 10)  // away from the borders, beyond which the relief goes on flat
    for (std::size_t c = 20; c <= 140; ++c)
      EXPECT_NEAR(heights_m[r * 161 + c], 0.3 * double(c) - 0.2 * double(r), 0.5) << r << " " << c;
  // The interpolation goes through all postings, those of the border too.
  for (std::size_t r = 0; r <= 160; r += 10)
    for (std::size_t c = 0; c <= 160; c += 10)
      EXPECT_EQ(heights_m[r * 161 + c], 0.3 * double(c) - 0.2 * double(r));
}

TEST(MakeTerrain, detail_follows_the_slope) {
  const TerrainFile file;
  // Steep in the west, flat in the east.
  const Relief relief{17, [](std::uint64_t, std::span<double> heights_m) -> Result<void> {
                        for (std::size_t i = 0; i < heights_m.size(); ++i)
                          heights_m[i] = i % 17 < 8 ? 100 * static_cast<double>(i % 17) : 800;
                        return {};
                      }};
  const auto made = [&](double roughness) {
    EXPECT_TRUE(make_terrain(relief, file.path(), {.side = 513, .roughness = roughness}));
    return heights_of(file.path());
  };
  const std::vector<double> smooth = made(0), rough = made(0.5);
  ASSERT_EQ(smooth.size(), rough.size());
  double west = 0, east = 0;
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    const double detail = std::abs(rough[i] - smooth[i]);
    if (i % 513 < 200) west = std::max(west, detail);
    if (i % 513 > 352) east = std::max(east, detail);
  }
  EXPECT_EQ(east, 0);
  EXPECT_GT(west, 20);  // of 0.5 · 100 m per posting
  EXPECT_LT(west, 101);
}

TEST(ReliefOf, is_the_middle_square_of_a_raster_without_its_voids) {
  const TerrainFile file;
  const std::int16_t samples[8] = {1, 2, 3, 4, 5, 6, -32768, 8};
  std::ofstream(file.path(), std::ios::binary).write(reinterpret_cast<const char*>(samples), sizeof samples);
  auto raster = open_height_raster(file.path(), {.no_data = -32768, .width = 4, .height = 2});
  ASSERT_TRUE(raster) << raster.error().text();
  const auto relief = relief_of(std::move(*raster));
  ASSERT_TRUE(relief);
  EXPECT_EQ(relief->side, 2u);
  std::vector<double> heights_m(4);
  ASSERT_TRUE(relief->read(0, heights_m));
  EXPECT_EQ(heights_m, (std::vector<double>{2, 3, 6, 0}));
}

TEST(ReliefOf, is_the_asked_square_counted_from_the_north) {
  const TerrainFile file;
  // Two columns, three rows; with rows from the south in the file, 5 6 is the northernmost.
  const std::int16_t samples[6] = {1, 2, 3, 4, 5, 6};
  std::ofstream(file.path(), std::ios::binary).write(reinterpret_cast<const char*>(samples), sizeof samples);
  std::shared_ptr<const HeightRaster> raster =
      open_height_raster(file.path(), {.width = 2, .height = 3}).value();
  std::vector<double> heights_m(4);
  ASSERT_TRUE(relief_of(raster, Square{0, 1, 2})->read(0, heights_m));
  EXPECT_EQ(heights_m, (std::vector<double>{3, 4, 5, 6}));
  raster = std::make_shared<SouthernFirst>(raster);
  ASSERT_TRUE(relief_of(raster, Square{0, 0, 2})->read(0, heights_m));
  EXPECT_EQ(heights_m, (std::vector<double>{5, 6, 3, 4}));
  EXPECT_EQ(relief_of(raster, Square{0, 2, 2}).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(relief_of(raster, Square{0, 0, 3}).error().code, ErrorCode::invalid_input);
}

TEST(GradientNoiseRow, is_smooth_bounded_and_has_no_seams) {
  std::vector<double> above(4000), here(4000);
  double largest = 0;
  gradient_noise_row(above, 0, 40, 3);
  for (std::uint64_t row = 1; row < 200; ++row) {
    gradient_noise_row(here, row, 40, 3);
    for (std::size_t i = 1; i < here.size(); ++i) {
      ASSERT_LT(std::abs(here[i] - here[i - 1]), 0.1);
      ASSERT_LT(std::abs(here[i] - above[i]), 0.1);
      largest = std::max(largest, std::abs(here[i]));
    }
    above = here;
  }
  EXPECT_GT(largest, 0.7);
  EXPECT_LE(largest, 1);
}

}  // namespace
}  // namespace cuesta::tools
