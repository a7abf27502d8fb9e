/// Mosaics of one lattice: which files make a layer, and what is read of it.

#include "terrain/mosaic.h"

#include <thread>

#include "terrain/frame.h"
#include "tests/shared_data.h"
#include "tests/terrain/mosaic_files.h"
#include "tests/terrain/tiff_files.h"

namespace cuesta {
namespace {

using test::degrees;
using test::expect_same_heights;
using test::grid;
using test::mosaic_error;
using test::none;
using test::open_mosaic;
using test::Paths;
using test::read_mosaic;
using test::whole_mosaic;

/// Windows at random, past the width where the layer is on the Earth, are what the whole has there.
void expect_windows_equal_whole(const Mosaic& mosaic, std::uint32_t layer, unsigned seed = 1) {
  const MosaicLayer& l = mosaic.layers()[layer];
  const std::vector<double> all = whole_mosaic(mosaic, layer);
  const std::uint64_t columns = l.columns_around != 0 ? 2 * l.columns_around : l.width;
  std::mt19937 random(seed);
  const auto below = [&](std::uint64_t n) {
    return std::uniform_int_distribution<std::uint64_t>(0, n - 1)(random);
  };
  for (unsigned i = 0; i < 30; ++i) {
    Window window{.column = below(columns), .row = below(l.height)};
    window.width = 1 + below(std::min<std::uint64_t>(columns - window.column, 2 * l.width));
    window.height = 1 + below(l.height - window.row);
    const std::vector<double> part = read_mosaic(mosaic, layer, window);
    for (std::uint64_t k = 0; k < part.size(); ++k) {
      std::uint64_t column = window.column + k % window.width;
      if (l.columns_around != 0) column %= l.columns_around;
      const double expected =
          column < l.width ? all[(window.row + k / window.width) * l.width + column] : none;
      ASSERT_TRUE(test::same(part[k], expected)) << "seed " << seed << ", window " << i << ", posting " << k;
    }
  }
}

TEST(MosaicLayer, TilesThatShareTheirEdge) {
  const test::ScratchFolder folder;
  const auto mosaic =
      open_mosaic({folder.write("a.asc", grid(0, 2, 1, 3, {1, 2, 3, 4, 5, 6, 7, 8, 9})),
                   folder.write("b.asc", grid(2, 2, 1, 3, {3, 12, 13, 6, 15, 16, 9, 18, 19}))});
  ASSERT_TRUE(mosaic);
  ASSERT_EQ(mosaic->layers().size(), 1u);
  EXPECT_EQ(mosaic->layers()[0].map, (PostingMap{0, 2, 1, 0, 0, -1}));
  expect_same_heights(whole_mosaic(*mosaic), {1, 2, 3, 12, 13, 4, 5, 6, 15, 16, 7, 8, 9, 18, 19});
  expect_windows_equal_whole(*mosaic, 0);
  EXPECT_EQ(mosaic->layers()[0].crs.definition().method, CrsMethod::plane);
  EXPECT_TRUE(mosaic->seams().empty());
}

TEST(MosaicLayer, TilesThatOnlyTouch) {
  const test::ScratchFolder folder;
  const auto mosaic = open_mosaic({folder.write("b.asc", grid(3, 1, 1, 2, {4, 5, 9, 10})),
                                   folder.write("a.asc", grid(0, 1, 1, 3, {1, 2, 3, 6, 7, 8}))});
  ASSERT_TRUE(mosaic);
  ASSERT_EQ(mosaic->layers().size(), 1u);
  EXPECT_EQ(mosaic->layers()[0].map, (PostingMap{0, 1, 1, 0, 0, -1}));
  expect_same_heights(whole_mosaic(*mosaic), {1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
}

TEST(MosaicLayer, OverlapsGoToTheFirstThatHasDataAndGapsAreNaN) {
  const test::ScratchFolder folder;
  const Paths files{folder.write("a.asc", grid(0, 1, 1, 3, {1, 2, none, 4, 5, 6})),
                    folder.write("b.asc", grid(1, 1, 1, 3, {12, 13, none, 15, 16, 17})),
                    folder.write("c.asc", grid(5, 1, 1, 1, {30}))};
  const auto mosaic = open_mosaic(files);
  ASSERT_TRUE(mosaic);
  expect_same_heights(whole_mosaic(*mosaic), {1, 2, 13, none, none, 30, 4, 5, 6, 17, none, none});
  EXPECT_TRUE(mosaic->has_files(0, {3, 0, 2, 1}));
  EXPECT_FALSE(mosaic->has_files(0, {4, 0, 1, 2}));
  expect_windows_equal_whole(*mosaic, 0);
  const auto other = open_mosaic({files[1], files[0], files[2]});
  ASSERT_TRUE(other);
  expect_same_heights(whole_mosaic(*other), {1, 12, 13, none, none, 30, 4, 15, 16, 17, none, none});
}

TEST(MosaicLayer, SpacingAndPhaseAreComparedWithTolerance) {
  const test::ScratchFolder folder;
  const auto layers_of = [&](double x, double spacing) {
    const auto mosaic = open_mosaic({folder.write("a.asc", grid(0, 1, 1, 2, {1, 2, 3, 4})),
                                     folder.write("b.asc", grid(x, 1, spacing, 2, {1, 2, 3, 4}))});
    return mosaic ? mosaic->layers().size() : 0;
  };
  EXPECT_EQ(layers_of(2, 1), 1u);
  EXPECT_EQ(layers_of(2.0005, 1), 1u);
  EXPECT_EQ(layers_of(2.002, 1), 2u);
  EXPECT_EQ(layers_of(2.5, 1), 2u);
  EXPECT_EQ(layers_of(3, 1 + 5e-7), 1u);
  EXPECT_EQ(layers_of(3, 1.0001), 2u);
}

/// A netCDF grid has its rows from the south, or its columns as rows: here said by a transformation.
TEST(MosaicLayer, TurnedFilesAreTurnedBack) {
  const test::ScratchFolder folder;
  const std::vector<double> upright{1, 2, 3, 4, 5, 6};  // 3 columns at x = 10, 11, 12, 2 rows at y = 21, 20
  struct Turned {
    std::uint32_t width, height;
    std::vector<double> transformation;  // of a point: x = a c + b r + d
    std::vector<double> heights;
  };
  const Turned all[] = {{3, 2, {1, 0, 0, 10, 0, -1, 0, 21}, upright},
                        {3, 2, {1, 0, 0, 10, 0, 1, 0, 20}, {4, 5, 6, 1, 2, 3}},
                        {3, 2, {-1, 0, 0, 12, 0, -1, 0, 21}, {3, 2, 1, 6, 5, 4}},
                        {3, 2, {-1, 0, 0, 12, 0, 1, 0, 20}, {6, 5, 4, 3, 2, 1}},
                        {2, 3, {0, 1, 0, 10, -1, 0, 0, 21}, {1, 4, 2, 5, 3, 6}},
                        {2, 3, {0, 1, 0, 10, 1, 0, 0, 20}, {4, 1, 5, 2, 6, 3}},
                        {2, 3, {0, -1, 0, 12, -1, 0, 0, 21}, {3, 6, 2, 5, 1, 4}},
                        {2, 3, {0, -1, 0, 12, 1, 0, 0, 20}, {6, 3, 5, 2, 4, 1}}};
  for (const Turned& turned : all) {
    test::TiffRecipe recipe{.width = turned.width, .height = turned.height, .rows_per_strip = 1};
    recipe.transformation = turned.transformation;
    recipe.transformation.insert(recipe.transformation.end(), {0, 0, 0, 0, 0, 0, 0, 1});
    recipe.geo_keys = {1, 1, 0, 1, 1025, 0, 1, 2};  // a pixel is a point
    test::write_tiff(folder / "a.tif", recipe, turned.heights);
    MosaicOptions options;
    options.raster.epsg = 32633;
    const auto mosaic = open_mosaic({folder / "a.tif"}, options);
    ASSERT_TRUE(mosaic);
    EXPECT_EQ(mosaic->layers()[0].map, (PostingMap{10, 21, 1, 0, 0, -1}));
    expect_same_heights(whole_mosaic(*mosaic), upright);
    expect_windows_equal_whole(*mosaic, 0);
  }
}

TEST(MosaicLayer, RotatedFilesShareALattice) {
  const test::ScratchFolder folder;
  test::TiffRecipe recipe{.width = 2, .height = 2, .rows_per_strip = 1};
  recipe.geo_keys = {1, 1, 0, 1, 1025, 0, 1, 2};
  recipe.transformation = {0.8, 0.6, 0, 100, 0.6, -0.8, 0, 200, 0, 0, 0, 0, 0, 0, 0, 1};
  test::write_tiff(folder / "a.tif", recipe, {1, 2, 5, 6});
  recipe.transformation[3] += 2 * 0.8;
  recipe.transformation[7] += 2 * 0.6;
  test::write_tiff(folder / "b.tif", recipe, {3, 4, 7, 8});
  MosaicOptions options;
  options.raster.epsg = 32633;
  const auto mosaic = open_mosaic({folder / "b.tif", folder / "a.tif"}, options);
  ASSERT_TRUE(mosaic);
  ASSERT_EQ(mosaic->layers().size(), 1u);
  EXPECT_NEAR(mosaic->layers()[0].map.x0, 100, 1e-9);
  EXPECT_NEAR(mosaic->layers()[0].map.y0, 200, 1e-9);
  expect_same_heights(whole_mosaic(*mosaic), {1, 2, 3, 4, 5, 6, 7, 8});
}

TEST(MosaicOnEarth, CrossesTheAntimeridian) {
  const test::ScratchFolder folder;
  const Paths files{folder.write("east.asc", grid(-180, 1, 0.5, 3, {3, 4, 5, 13, 14, 15})),
                    folder.write("west.asc", grid(179, 1, 0.5, 3, {1, 2, 3, 11, 12, 13}))};
  for (const Paths& order : {files, Paths{files[1], files[0]}}) {
    const auto mosaic = open_mosaic(order, degrees());
    ASSERT_TRUE(mosaic);
    ASSERT_EQ(mosaic->layers().size(), 1u);
    const MosaicLayer& layer = mosaic->layers()[0];
    EXPECT_EQ(layer.map.x0, 179);
    EXPECT_EQ(layer.width, 5u);
    EXPECT_EQ(layer.columns_around, 720u);
    EXPECT_FALSE(layer.closes());
    expect_same_heights(whole_mosaic(*mosaic), {1, 2, 3, 4, 5, 11, 12, 13, 14, 15});
    expect_windows_equal_whole(*mosaic, 0);
  }
}

TEST(MosaicOnEarth, LongitudesTo360AreTheSameLattice) {
  const test::ScratchFolder folder;
  const auto mosaic = open_mosaic(
      {folder.write("a.asc", grid(359, 1, 1, 1, {1})), folder.write("b.asc", grid(0, 1, 1, 2, {2, 3}))},
      degrees());
  ASSERT_TRUE(mosaic);
  ASSERT_EQ(mosaic->layers().size(), 1u);
  EXPECT_EQ(mosaic->layers()[0].map.x0, -1);
  expect_same_heights(whole_mosaic(*mosaic), {1, 2, 3});
}

/// Steps of 60°: 6 columns make the Earth; rows at 90, 30, -30, -90.
TEST(MosaicOnEarth, WholeEarthClosesAndPolesAreOnePlace) {
  const test::ScratchFolder folder;
  std::vector<double> heights{1, 2, 3, 4, 5, none};
  for (int i = 0; i < 12; ++i) heights.push_back(100 + i);
  heights.insert(heights.end(), 6, 7.5);
  const auto path = folder.write("earth.asc", grid(0, 90, 60, 6, heights));
  const auto mosaic = open_mosaic({path}, degrees());
  ASSERT_TRUE(mosaic);
  const MosaicLayer& layer = mosaic->layers()[0];
  EXPECT_TRUE(layer.closes());
  EXPECT_TRUE(layer.north_pole && layer.south_pole);
  EXPECT_EQ(layer.map.y(0, 3), -90);
  std::vector<double> expected = heights;
  std::fill_n(expected.begin(), 6, 3.0);
  expect_same_heights(whole_mosaic(*mosaic), expected);
  expect_same_heights(read_mosaic(*mosaic, 0, {5, 1, 3, 1}), {105, 100, 101});
  expect_windows_equal_whole(*mosaic, 0);
}

TEST(MosaicOnEarth, AColumnTooManyIsNotReadTwice) {
  const test::ScratchFolder folder;
  std::vector<double> heights{1, 2, none, 4, 5, 6, 99, 11, 12, 13, 14, 15, 16, 11};
  heights[0] = none;
  const auto mosaic = open_mosaic({folder.write("a.asc", grid(-180, 0, 60, 7, heights))}, degrees());
  ASSERT_TRUE(mosaic);
  EXPECT_TRUE(mosaic->layers()[0].closes());
  expect_same_heights(whole_mosaic(*mosaic), {99, 2, none, 4, 5, 6, 11, 12, 13, 14, 15, 16});
  expect_windows_equal_whole(*mosaic, 0);
}

TEST(MosaicOnEarth, TilesOverBothHemispheres) {
  const test::ScratchFolder folder;
  for (const auto& [name, first] :
       {std::pair{"N00E000", 0}, {"N00W001", 10}, {"S01E000", 20}, {"S01W001", 30}}) {
    std::vector<double> heights;
    for (int i = 0; i < 4; ++i) heights.push_back(first + i);
    folder.write(std::string(name) + ".hgt", test::packed<std::int16_t>(heights, true));
  }
  const auto mosaic = open_mosaic(
      {folder / "N00E000.hgt", folder / "N00W001.hgt", folder / "S01E000.hgt", folder / "S01W001.hgt"});
  ASSERT_TRUE(mosaic);
  ASSERT_EQ(mosaic->layers().size(), 1u);
  EXPECT_EQ(mosaic->layers()[0].map, (PostingMap{-1, 1, 1, 0, 0, -1}));
  expect_same_heights(whole_mosaic(*mosaic), {10, 0, 1, 12, 2, 3, 32, 22, 23});
  EXPECT_EQ(mosaic->heights(), VerticalDatum::orthometric);
  EXPECT_EQ(mosaic->vertical_quantum_m(), 1);
}

TEST(MosaicWater, NoDataAndDepthsBecomeTheSurface) {
  const test::ScratchFolder folder;
  MosaicOptions options;
  options.sea_level_m = 0.5;
  const auto mosaic = open_mosaic({folder.write("a.asc", grid(0, 0, 1, 4, {-3, none, 0.5, 2})),
                                   folder.write("b.asc", grid(5, 0, 1, 1, {none}))},
                                  options);
  ASSERT_TRUE(mosaic);
  MosaicCounts counts;
  expect_same_heights(whole_mosaic(*mosaic, 0, &counts), {0.5, 0.5, 0.5, 2, none, 0.5});
  EXPECT_EQ(counts.heights, 5u);
  EXPECT_EQ(counts.flooded, 2u);
  EXPECT_EQ(counts.raised, 1u);
}

TEST(MosaicFill, IsLinearAlongALineAndWeighsLinesByDistance) {
  const test::ScratchFolder folder;
  MosaicOptions options;
  options.fill_postings = 3;
  const auto line =
      open_mosaic({folder.write("a.asc", grid(0, 0, 1, 6, {10, none, none, 40, none, none}))}, options);
  ASSERT_TRUE(line);
  MosaicCounts counts;
  const auto filled = whole_mosaic(*line, 0, &counts);
  EXPECT_NEAR(filled[1], 20, 1e-12);
  EXPECT_NEAR(filled[2], 30, 1e-12);
  EXPECT_TRUE(std::isnan(filled[4]) && std::isnan(filled[5]));
  EXPECT_EQ(counts.filled, 2u);
  options.fill_postings = 1;
  const auto shorter = open_mosaic({folder / "a.asc"}, options);
  ASSERT_TRUE(shorter);
  expect_same_heights(whole_mosaic(*shorter), {10, none, none, 40, none, none});
  const auto cross =
      open_mosaic({folder.write("b.asc", grid(0, 2, 1, 3, {0, 6, 0, 1, none, 3, 0, 10, 0}))}, options);
  ASSERT_TRUE(cross);
  EXPECT_NEAR(whole_mosaic(*cross)[4], (6 + 1 + 3 + 10) / 4.0, 1e-12);
}

TEST(MosaicFill, CrossesFilesGapsAndTheAntimeridianAndAllWindowsAgree) {
  const test::ScratchFolder folder;
  std::mt19937 random(7);
  Paths files;
  for (const double x : {170.0, -180.0}) {
    std::vector<double> heights;
    for (int i = 0; i < 90; ++i) heights.push_back(random() % 3 == 0 ? double(random() % 1000) : none);
    files.push_back(folder.write(fmt::format("{}.asc", x), grid(x, 5, 1, 9, heights)));
  }
  MosaicOptions options = degrees();
  options.fill_postings = 4;
  const auto mosaic = open_mosaic(files, options);
  ASSERT_TRUE(mosaic);
  MosaicCounts counts;
  whole_mosaic(*mosaic, 0, &counts);
  EXPECT_GT(counts.filled, 50u);
  for (unsigned seed = 1; seed < 5; ++seed) expect_windows_equal_whole(*mosaic, 0, seed);
}

TEST(MosaicSystems, FilesThatDoNotSayAreOnePlaneOrAnError) {
  const test::ScratchFolder folder;
  folder.write("N00E000.hgt", test::packed<std::int16_t>({1, 2, 3, 4}, true));
  const auto plain = folder.write("a.asc", grid(0, 0, 1, 2, {1, 2}));
  const Error error = mosaic_error({folder / "N00E000.hgt", plain});
  EXPECT_EQ(error.code, ErrorCode::invalid_input);
  EXPECT_NE(error.file.find("a.asc"), std::string::npos);
  const auto raw = folder.write("a.i16", test::packed<std::int16_t>({1, 2, 3, 4}));
  const auto mosaic = open_mosaic({raw, raw});
  ASSERT_TRUE(mosaic);
  EXPECT_EQ(mosaic->layers()[0].map, (PostingMap{0, 0, 1, 0, 0, -1}));
  EXPECT_EQ(mosaic->warnings().size(), 1u);
  const Crs& plane = mosaic->layers()[0].crs;
  const auto frame = Frame::projected(plane);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->position_m(plane, {3, -4}, 5), (Vec3d{3, -4, 5}));
  EXPECT_TRUE(std::isnan(plane.lat_lon({3, -4}).lat_deg));
}

TEST(MosaicSystems, UnsupportedOnesAreRefusedByNameWithTheFile) {
  const test::ScratchFolder folder;
  MosaicOptions options;
  options.raster.epsg = 3035;
  const Error error = mosaic_error({folder.write("a.asc", grid(0, 0, 1, 2, {1, 2}))}, options);
  EXPECT_EQ(error.code, ErrorCode::unsupported_version);
  EXPECT_NE(error.file.find("a.asc"), std::string::npos);
  EXPECT_NE(error.text().find("3035"), std::string::npos);
}

TEST(MosaicSystems, MetresTakenForDegreesAreAnError) {
  const test::ScratchFolder folder;
  const Error error = mosaic_error({folder.write("a.asc", grid(500000, 4000000, 30, 2, {1, 2}))}, degrees());
  EXPECT_EQ(error.code, ErrorCode::invalid_input);
  EXPECT_EQ(error.place, "georeference");
}

TEST(MosaicDatum, DifferentOnesWithoutAGeoidAreAnError) {
  const test::ScratchFolder folder;
  folder.write("N00E000.hgt", test::packed<std::int16_t>({1, 2, 3, 4}, true));
  folder.write("N00E001.hgt", test::packed<std::int16_t>({1, 2, 3, 4}, true));
  folder.write("N00E001.hgt.json", R"({"vertical_datum": "ellipsoidal"})");
  const Paths files{folder / "N00E000.hgt", folder / "N00E001.hgt"};
  Error error = mosaic_error(files);
  EXPECT_EQ(error.place, "vertical datum");
  EXPECT_NE(error.file.find("N00E001"), std::string::npos);
  EXPECT_NE(error.message.find("N00E000"), std::string::npos);
  MosaicOptions options;
  options.heights = VerticalDatum::orthometric;
  error = mosaic_error(files, options);
  EXPECT_EQ(error.place, "vertical datum");
  EXPECT_NE(error.message.find("--geoid"), std::string::npos);
}

TEST(MosaicDatum, FilesThatDoNotSayTakeTheWordOfTheOption) {
  const test::ScratchFolder folder;
  MosaicOptions options;
  options.heights = VerticalDatum::ellipsoidal;
  const auto mosaic = open_mosaic({folder.write("a.asc", grid(0, 0, 1, 2, {1, 2}))}, options);
  ASSERT_TRUE(mosaic);
  EXPECT_EQ(mosaic->heights(), VerticalDatum::ellipsoidal);
  expect_same_heights(whole_mosaic(*mosaic), {1, 2});
  EXPECT_EQ(mosaic->warnings().size(), 1u);
}

/// A geoid in steps of 30°, in GeographicLib's format, that differs everywhere.
std::filesystem::path write_geoid(const test::ScratchFolder& folder) {
  std::string bytes = "P5\n# Description made up\n# Offset -100\n# Scale 0.01\n12 7\n65535\n";
  for (int row = 0; row < 7; ++row) {
    for (int column = 0; column < 12; ++column)
      bytes += test::packed<std::uint16_t>({10000.0 + 300 * row + (column * 7 % 12) * 50}, true);
  }
  return folder.write("geoid.pgm", bytes);
}

TEST(MosaicDatum, IsConvertedWhereTheFileHasTheOther) {
  const test::ScratchFolder folder;
  folder.write("N10E020.hgt", test::packed<std::int16_t>({1, 2, -32768, 4}, true));
  folder.write("N10E021.hgt", test::packed<std::int16_t>({2, 3, 4, 5}, true));
  folder.write("N10E021.hgt.json", R"({"vertical_datum": "ellipsoidal"})");
  const auto geoid = Geoid::open(write_geoid(folder).string());
  ASSERT_TRUE(geoid) << geoid.error().text();
  const double a = geoid->undulation_m({11, 20}), b = geoid->undulation_m({11, 21}),
               c = geoid->undulation_m({11, 22}), d = geoid->undulation_m({10, 20}),
               e = geoid->undulation_m({10, 21}), f = geoid->undulation_m({10, 22});
  ASSERT_NE(a, b);
  ASSERT_NE(a, d);
  MosaicOptions options;
  options.geoid = &*geoid;
  options.heights = VerticalDatum::ellipsoidal;
  const Paths files{folder / "N10E020.hgt", folder / "N10E021.hgt"};
  auto mosaic = open_mosaic(files, options);
  ASSERT_TRUE(mosaic);
  EXPECT_EQ(mosaic->heights(), VerticalDatum::ellipsoidal);
  expect_same_heights(whole_mosaic(*mosaic), {1 + a, 2 + b, 3, none, 4 + e, 5});
  options.heights = VerticalDatum::orthometric;
  mosaic = open_mosaic(files, options);
  ASSERT_TRUE(mosaic);
  expect_same_heights(whole_mosaic(*mosaic), {1, 2, 3 - c, none, 4, 5 - f});
  options.heights = VerticalDatum::ellipsoidal;
  options.sea_level_m = 2;  // above the geoid
  mosaic = open_mosaic(files, options);
  ASSERT_TRUE(mosaic);
  expect_same_heights(whole_mosaic(*mosaic), {2 + a, 2 + b, std::max(3.0, 2 + c), 2 + d,
                                              std::max(4.0, std::max(4 + e, 2 + e)), std::max(5.0, 2 + f)});
}

TEST(MosaicFiles, FewAreOpenAndThreadsAgree) {
  const test::ScratchFolder folder;
  Paths files;
  std::vector<double> expected;
  for (int i = 0; i < 40; ++i) {
    files.push_back(folder.write(fmt::format("{}.asc", i), grid(i, 0, 1, 1, {double(i * i)})));
    expected.push_back(i * i);
  }
  MosaicOptions options;
  options.most_open_files = 3;
  const auto mosaic = open_mosaic(files, options);
  ASSERT_TRUE(mosaic);
  std::vector<std::thread> threads;
  std::vector<std::vector<double>> found(4);
  for (auto& heights : found) threads.emplace_back([&] { heights = whole_mosaic(*mosaic); });
  for (auto& thread : threads) thread.join();
  for (const auto& heights : found) expect_same_heights(heights, expected);
  std::uint64_t descriptors = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    descriptors += std::filesystem::read_symlink(entry.path(), gone).string().ends_with(".asc");
  }
  EXPECT_LE(descriptors, 3u);
  EXPECT_LT(mosaic->memory_bytes(), options.cache_bytes + (16u << 20) + (2u << 20));
}

TEST(MosaicFiles, OneThatChangedIsAnError) {
  const test::ScratchFolder folder;
  MosaicOptions options;
  options.most_open_files = 1;
  const auto a = folder.write("a.asc", grid(0, 0, 1, 2, {1, 2})),
             b = folder.write("b.asc", grid(2, 0, 1, 2, {3, 4}));
  const auto mosaic = open_mosaic({a, b}, options);
  ASSERT_TRUE(mosaic);
  std::filesystem::remove(a);
  folder.write("a.asc", grid(0, 0, 1, 3, {1, 2, 3}));
  std::vector<double> heights(4);
  const auto read = mosaic->read(0, {0, 0, 4, 1}, heights);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::corrupt);
}

struct Neighbours {
  const char *first, *second;
};

void PrintTo(const Neighbours& pair, std::ostream* out) {
  *out << pair.first << " and " << pair.second;
}

class RealNeighbours : public testing::TestWithParam<Neighbours> {};

/// The rectangle of a file in the mosaic has the file's heights, but where it has none and the other has.
TEST_P(RealNeighbours, HaveTheHeightsOfTheFilesAndNoLineBetweenThem) {
  const auto first = test::shared_data(std::string("dem/") + GetParam().first);
  const auto second = test::shared_data(std::string("dem/") + GetParam().second);
  if (first.empty() || second.empty()) GTEST_SKIP() << "not in ../shared/data/dem";
  const auto mosaic = open_mosaic({first, second});
  ASSERT_TRUE(mosaic);
  ASSERT_EQ(mosaic->layers().size(), 1u);
  const MosaicLayer& layer = mosaic->layers()[0];
  const bool side_by_side = layer.width > layer.height;
  EXPECT_EQ(layer.width, side_by_side ? 2401u : 1201u);
  EXPECT_EQ(layer.height, side_by_side ? 1201u : 2401u);
  for (const std::filesystem::path& path : {first, second}) {
    const auto raster = test::open_raster(path);
    ASSERT_TRUE(raster);
    const auto column = std::uint64_t(std::lround((raster->info().map.x0 - layer.map.x0) * 1200));
    const auto row = std::uint64_t(std::lround((layer.map.y0 - raster->info().map.y0) * 1200));
    const auto expected = test::whole(*raster), found = read_mosaic(*mosaic, 0, {column, row, 1201, 1201});
    for (std::size_t i = 0; i < found.size(); ++i) {
      const bool on_edge = i % 1201 == 0 || i % 1201 == 1200 || i / 1201 == 0 || i / 1201 == 1200;
      if (on_edge && std::isnan(expected[i])) continue;
      if (on_edge && path == second)
        ASSERT_FALSE(std::isnan(found[i])) << i;
      else
        ASSERT_TRUE(test::same(found[i], expected[i]))
            << i << ": " << found[i] << ", in the file " << expected[i];
    }
  }
  const auto line =
      read_mosaic(*mosaic, 0, side_by_side ? Window{1200, 0, 1, 1201} : Window{0, 1200, 1201, 1});
  EXPECT_LT(std::ranges::count_if(line, [](double height) { return std::isnan(height); }), 200);
}

INSTANTIATE_TEST_SUITE_P(Dem, RealNeighbours,
                         testing::Values(Neighbours{"N00E010.hgt", "N00E011.hgt.zip"},
                                         Neighbours{"N41E001.hgt.zip", "N42E001.hgt.zip"},
                                         Neighbours{"N49E011.hgt.zip", "N50E011.hgt.zip"},
                                         Neighbours{"N49W123.tif", "N49W124.tif"}));

TEST(RealEarth, EtopoClosesAndHasItsPoles) {
  CUESTA_NEED_SHARED(path, "dem/etopo5.cdf.gz");
  MosaicOptions options;
  options.sea_level_m = 0;
  const auto mosaic = open_mosaic({path}, options);
  ASSERT_TRUE(mosaic);
  ASSERT_EQ(mosaic->layers().size(), 1u);
  const MosaicLayer& layer = mosaic->layers()[0];
  EXPECT_EQ(layer.width, 4320u);
  EXPECT_EQ(layer.columns_around, 4320u);
  EXPECT_TRUE(layer.closes() && layer.north_pole && layer.south_pole);
  EXPECT_EQ(layer.map.y0, 90);
  const auto north = read_mosaic(*mosaic, 0, {0, 0, 4320, 1}),
             south = read_mosaic(*mosaic, 0, {0, 2160, 4320, 1});
  EXPECT_EQ(north, std::vector<double>(4320, 0.0));
  EXPECT_EQ(south, std::vector<double>(4320, south[0]));
  EXPECT_GT(south[0], 2000);
  const auto across = read_mosaic(*mosaic, 0, {4310, 1000, 20, 5}),
             east = read_mosaic(*mosaic, 0, {0, 1000, 10, 5});
  for (std::size_t row = 0; row < 5; ++row) {
    for (std::size_t column = 0; column < 10; ++column)
      EXPECT_EQ(across[row * 20 + 10 + column], east[row * 10 + column]);
  }
}

}  // namespace
}  // namespace cuesta
