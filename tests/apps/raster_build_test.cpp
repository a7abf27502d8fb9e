// What `cuesta build` makes of rasters: where postings come to lie at every level of detail, and what files
// that are damaged lead to.
#include <cmath>
#include <limits>
#include <random>

#include "apps/measure/vertical_error.h"
#include "runtime/cut.h"
#include "runtime/extract.h"
#include "tests/apps/run_program.h"
#include "tests/shared_data.h"
#include "tests/terrain/raster_files.h"
#include "tests/terrain/tiff_files.h"

namespace cuesta {
namespace {

using test::Outcome;
using test::run;
using test::TestFolder;

constexpr int fine_side = 257;
constexpr double fine_spacing_m = 30, west_m = 500'000, north_m = 5'200'000;

/// Half a spacing aside is 6 m up or down.
double field_m(double x_m, double y_m) {
  const double x = x_m - west_m, y = y_m - north_m;
  return 4000 + 0.4 * x + 0.4 * y + 20 * std::sin(x / 600) * std::cos(y / 500);
}

/// Of every `step`th posting, each the field's height where it is.
void write_field(const std::filesystem::path& path, int step, bool pixel_is_area) {
  const double spacing_m = fine_spacing_m * step;
  const int side = (fine_side - 1) / step + 1;
  test::TiffRecipe recipe{.type = SampleType::f32};
  recipe.width = recipe.height = static_cast<std::uint32_t>(side);
  // The corner of the first pixel, or its middle.
  const double corner_m = pixel_is_area ? spacing_m / 2 : 0;
  recipe.tie_points = {0, 0, 0, west_m - corner_m, north_m + corner_m, 0};
  recipe.pixel_scale = {spacing_m, spacing_m, 0};
  recipe.geo_keys = {1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32632};
  recipe.geo_keys[11] = pixel_is_area ? 1 : 2;
  std::vector<double> heights;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      heights.push_back(field_m(west_m + column * spacing_m, north_m - row * spacing_m));
  test::write_tiff(path, recipe, heights);
}

/// Anywhere but near the rim, on the field.
std::vector<Vec3d> places_on_field(std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> inside(0.02, 0.98);
  std::vector<Vec3d> places;
  for (std::size_t i = 0; i < count; ++i) {
    const double size_m = (fine_side - 1) * fine_spacing_m;
    const double x = west_m + inside(random) * size_m, y = north_m - inside(random) * size_m;
    places.push_back({x, y, field_m(x, y)});
  }
  return places;
}

struct Registration {
  int step;
  bool pixel_is_area;
};

class ShiftTest : public ::testing::TestWithParam<Registration> {};

TEST_P(ShiftTest, NoLevelOfDetailIsAside) {
  const TestFolder folder;
  const auto [step, pixel_is_area] = GetParam();
  write_field(folder / "field.tif", step, pixel_is_area);
  const Outcome built = run(folder, {"build", folder / "field.tif", "-o", folder / "field.cuesta"});
  ASSERT_EQ(built.status, 0) << built.err;
  auto file = CuestaFile::open(folder / "field.cuesta");
  ASSERT_TRUE(file);
  const auto cut = Cut::open(std::move(*file), std::numeric_limits<std::uint64_t>::max(), [] { return 0.0; });
  ASSERT_TRUE(cut);
  const Grid& grid = (*cut)->directory().grid;
  const std::vector<Vec3d> places = places_on_field(4000);
  // What is between postings of the field, and the grid.
  const double allowed_m = 0.15 + 2 * grid.snap_error();
  ASSERT_LT(allowed_m, 0.5);
  std::size_t triangles_before = std::numeric_limits<std::size_t>::max();
  for (const double error_m : {0.0, 0.25, 1.0, 2.0, 4.0}) {
    (*cut)->settle(ErrorScale::uniform(grid), error_m, {});
    const auto mesh = extract_mesh((*cut)->draw_list(), {false, false});
    ASSERT_TRUE(mesh);
    EXPECT_LT(mesh->triangles.size(), triangles_before) << error_m;
    triangles_before = mesh->triangles.size();
    const auto found = measure::vertical_error(*mesh, places).exact;
    EXPECT_EQ(found.uncovered, 0u) << error_m;
    EXPECT_LE(found.max_m, error_m + allowed_m) << error_m;
  }
}

INSTANTIATE_TEST_SUITE_P(PointAndArea, ShiftTest,
                         ::testing::Values(Registration{1, false}, Registration{1, true},
                                           Registration{2, false}, Registration{2, true}),
                         [](const auto& one) {
                           return std::string(one.param.pixel_is_area ? "Area" : "Point") +
                                  (one.param.step == 1 ? "Fine" : "Coarse");
                         });

/// Exit status 1 to 9 with one line that names the file, and nothing left behind.
void expect_refused(const TestFolder& folder, const std::filesystem::path& input) {
  SCOPED_TRACE(input.filename());
  const Outcome o = run(folder, {"build", input, "-o", folder / "out.cuesta", "--quiet", "--memory", "256M"});
  EXPECT_GT(o.status, 0) << o.out;
  EXPECT_LT(o.status, 10) << o.err;
  EXPECT_NE(o.err.find(input.filename().string()), std::string::npos) << o.err;
  EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "out.cuesta"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.cuesta.part"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.cuesta.work"));
}

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(HostileTerrain, TruncatedHgtIsToldWithItsSize) {
  const TestFolder folder;
  constexpr std::size_t side = 1201;
  const std::string tile(side * side * 2, '\1');
  for (const std::size_t bytes :
       {std::size_t{0}, std::size_t{1}, std::size_t{4097}, tile.size() / 2, tile.size() - 1}) {
    write(folder / "N45E006.hgt", tile.substr(0, bytes));
    expect_refused(folder, folder / "N45E006.hgt");
  }
  write(folder / "N45E006.hgt", tile + "x");
  expect_refused(folder, folder / "N45E006.hgt");
  write(folder / "45.hgt", tile);
  expect_refused(folder, folder / "45.hgt");
}

TEST(HostileTerrain, TruncatedTiffIsToldWithItsPlace) {
  const TestFolder folder;
  write_field(folder / "whole.tif", 4, true);
  const std::string whole = test::read_text(folder / "whole.tif");
  for (const std::size_t eighths : {0, 1, 3, 5, 7}) {
    write(folder / "cut.tif", whole.substr(0, 3 + whole.size() * eighths / 8));
    expect_refused(folder, folder / "cut.tif");
  }
}

TEST(HostileTerrain, SharedTiffsEndInAFileOrAMessage) {
  CUESTA_NEED_SHARED(path, "bad/tiff");
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    const TestFolder folder;
    SCOPED_TRACE(entry.path().filename());
    const Outcome o = run(folder, {"build", entry.path(), "-o", folder / "out.cuesta", "--quiet"});
    EXPECT_GE(o.status, 0) << "ended by a signal";
    EXPECT_LT(o.status, 10) << o.err;
    EXPECT_EQ(o.status == 0, std::filesystem::exists(folder / "out.cuesta")) << o.err;
    if (o.status == 0) continue;
    EXPECT_NE(o.err.find(entry.path().filename().string()), std::string::npos) << o.err;
  }
}

}  // namespace
}  // namespace cuesta
