#include <netcdf.h>

#include <cstring>
#include <thread>

#include "tests/terrain/raster_files.h"

namespace cuesta {
namespace {

struct Recipe {
  int mode = NC_CLASSIC_MODEL;  ///< or NC_64BIT_OFFSET, NC_64BIT_DATA, NC_NETCDF4
  nc_type type = NC_SHORT;
  std::vector<double> x = {10, 10.5, 11, 11.5, 12}, y = {50, 49.75, 49.5};
  const char* x_units = "degrees_east";
  const char* y_units = "degrees_north";
  std::size_t chunk = 0;
  bool has_time = false, is_transposed = false;
  std::vector<std::pair<const char*, double>> attributes = {};
  const char* units = "m";
  int variables = 1;
  const char* is_unsigned = "";  ///< attribute _Unsigned
};

#define NC(call) ASSERT_EQ((call), NC_NOERR) << #call

void text(int id, int variable, const char* name, const char* value) {
  NC(nc_put_att_text(id, variable, name, std::strlen(value), value));
}

void write(const std::filesystem::path& path, const Recipe& r, const std::vector<double>& heights) {
  int id = 0, time = 0, x = 0, y = 0, vx = 0, vy = 0;
  NC(nc_create(path.c_str(), NC_CLOBBER | r.mode, &id));
  NC(nc_def_dim(id, "time", 1, &time));
  NC(nc_def_dim(id, "lon", r.x.size(), &x));
  NC(nc_def_dim(id, "lat", r.y.size(), &y));
  NC(nc_def_var(id, "lon", NC_DOUBLE, 1, &x, &vx));
  NC(nc_def_var(id, "lat", NC_DOUBLE, 1, &y, &vy));
  text(id, vx, "units", r.x_units);
  text(id, vy, "units", r.y_units);
  std::vector<int> dimensions = r.is_transposed ? std::vector{x, y} : std::vector{y, x};
  if (r.has_time) dimensions.insert(dimensions.begin(), time);
  for (int v = 0; v < r.variables; ++v) {
    int z = 0;
    NC(nc_def_var(id, ("z" + std::to_string(v)).c_str(), r.type, int(dimensions.size()), dimensions.data(),
                  &z));
    if (*r.units) text(id, z, "units", r.units);
    if (*r.is_unsigned) text(id, z, "_Unsigned", r.is_unsigned);
    for (const auto& [name, value] : r.attributes) {
      const bool is_fill = std::string(name) == "_FillValue";
      NC(nc_put_att_double(id, z, name, is_fill ? r.type : NC_DOUBLE, 1, &value));
    }
    if (r.chunk > 0) {
      const std::vector<std::size_t> chunks(dimensions.size(), r.chunk);
      NC(nc_def_var_chunking(id, z, NC_CHUNKED, chunks.data()));
      NC(nc_def_var_deflate(id, z, 1, 1, 4));
    }
  }
  NC(nc_enddef(id));
  NC(nc_put_var_double(id, vx, r.x.data()));
  NC(nc_put_var_double(id, vy, r.y.data()));
  for (int v = 0; v < r.variables; ++v) NC(nc_put_var_double(id, vy + 1 + v, heights.data()));
  NC(nc_close(id));
}

std::vector<double> steps(double first, double step, std::size_t count) {
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(first + step * double(i));
  return out;
}

TEST(Netcdf, ClassicAndVersion4AreRead) {
  const test::ScratchFolder folder;
  const auto heights = test::ramp(5, 3);
  for (const int mode : {NC_CLASSIC_MODEL, NC_64BIT_OFFSET, NC_64BIT_DATA, NC_NETCDF4}) {
    for (const nc_type type : {NC_BYTE, NC_SHORT, NC_INT, NC_FLOAT, NC_DOUBLE}) {
      write(folder / "a.nc", {.mode = mode, .type = type}, heights);
      const auto raster = test::open_raster(folder / "a.nc");
      ASSERT_TRUE(raster);
      EXPECT_EQ(raster->info().map, (PostingMap{10, 50, 0.5, 0, 0, -0.25}));
      EXPECT_EQ(raster->info().crs.kind, CrsDescription::Kind::geographic_wgs84);
      test::expect_heights(*raster, heights);
      test::expect_windows_equal_whole(*raster);
    }
  }
}

TEST(Netcdf, SamplesMayBeUnsignedByAttribute) {
  const test::ScratchFolder folder;
  const std::vector<double> stored{0, 1, 127, -128, -1, -2, 5, 6, 7, 8, 9, 10, 11, 12, 13};
  std::vector<double> meant{0, 1, 127, 128, std::nan(""), 254, 5, 6, 7, 8, 9, 10, 11, 12, 13};
  write(folder / "a.nc", {.type = NC_BYTE, .attributes = {{"_FillValue", -1}}, .is_unsigned = "true"},
        stored);
  test::expect_heights(*test::open_raster(folder / "a.nc"), meant);
  meant[4] = -1;
  meant[3] = -128;
  meant[5] = -2;
  write(folder / "b.nc", {.type = NC_BYTE, .is_unsigned = "false"}, stored);
  test::expect_heights(*test::open_raster(folder / "b.nc"), meant);
  write(folder / "c.nc", {.type = NC_SHORT, .is_unsigned = "true"}, stored);
  for (double& height : meant) height += height < 0 ? 65536 : 0;
  test::expect_heights(*test::open_raster(folder / "c.nc"), meant);
}

TEST(Netcdf, RowsMayRunNorthward) {
  const test::ScratchFolder folder;
  write(folder / "a.nc", {.y = {49.5, 49.75, 50}}, test::ramp(5, 3));
  const auto raster = test::open_raster(folder / "a.nc");
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().map, (PostingMap{10, 49.5, 0.5, 0, 0, 0.25}));
  test::expect_heights(*raster, test::ramp(5, 3));
}

TEST(Netcdf, ChunksOfVersion4) {
  const test::ScratchFolder folder;
  const auto heights = test::ramp(101, 67);
  write(folder / "a.nc",
        {.mode = NC_NETCDF4, .type = NC_FLOAT, .x = steps(0, 0.1, 101), .y = steps(5, -0.1, 67), .chunk = 16},
        heights);
  const auto raster = test::open_raster(folder / "a.nc", {.cache_bytes = 10'000});
  ASSERT_TRUE(raster);
  EXPECT_LE(raster->memory_bytes(), 20'000u);
  test::expect_heights(*raster, heights);
  test::expect_windows_equal_whole(*raster);
}

TEST(Netcdf, LongitudeMayComeFirstAndTimeOfLengthOneBefore) {
  const test::ScratchFolder folder;
  write(folder / "a.nc", {.has_time = true, .is_transposed = true}, test::ramp(3, 5));
  const auto raster = test::open_raster(folder / "a.nc");
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().width, 3u);
  EXPECT_EQ(raster->info().map.x(2, 4), 12);
  EXPECT_EQ(raster->info().map.y(2, 4), 49.5);
  test::expect_heights(*raster, test::ramp(3, 5));
}

TEST(Netcdf, ScaleOffsetAndNoData) {
  const test::ScratchFolder folder;
  auto heights = test::ramp(5, 3);
  heights[1] = -77;
  heights[2] = -88;
  heights[3] = 1000;
  write(folder / "a.nc",
        {.attributes = {{"_FillValue", -77},
                        {"missing_value", -88},
                        {"valid_max", 500},
                        {"scale_factor", 0.5},
                        {"add_offset", -3}}},
        heights);
  const auto raster = test::open_raster(folder / "a.nc");
  ASSERT_TRUE(raster);
  for (double& height : heights) height = height * 0.5 - 3;
  heights[1] = heights[2] = heights[3] = std::nan("");
  test::expect_heights(*raster, heights);
}

TEST(Netcdf, WhatNobodyWroteIsNoData) {
  const test::ScratchFolder folder;
  auto heights = test::ramp(5, 3);
  heights[1] = double(NC_FILL_FLOAT);
  write(folder / "a.nc", {.type = NC_FLOAT}, heights);
  EXPECT_TRUE(std::isnan(test::height_at(*test::open_raster(folder / "a.nc"), 1, 0)));
}

TEST(Netcdf, UnitsAreMetresInTheEnd) {
  const test::ScratchFolder folder;
  write(folder / "a.nc", {.units = "km"}, test::ramp(5, 3));
  EXPECT_EQ(test::height_at(*test::open_raster(folder / "a.nc"), 1, 0), 37000);
  write(folder / "b.nc", {.units = "kelvin"}, test::ramp(5, 3));
  EXPECT_EQ(test::open_error(folder / "b.nc").code, ErrorCode::invalid_input);
  EXPECT_TRUE(test::open_raster(folder / "b.nc", {.unit_m = 1}));
}

TEST(Netcdf, SeveralVariablesNeedAName) {
  const test::ScratchFolder folder;
  write(folder / "a.nc", {.variables = 2}, test::ramp(5, 3));
  const Error error = test::open_error(folder / "a.nc");
  EXPECT_EQ(error.code, ErrorCode::invalid_input);
  EXPECT_NE(error.message.find("z1"), std::string::npos) << error.text();
  EXPECT_TRUE(test::open_raster(folder / "a.nc", {.variable = "z1"}));
  EXPECT_EQ(test::open_error(folder / "a.nc", {.variable = "lon"}).code, ErrorCode::invalid_input);
}

TEST(Netcdf, UnevenStepsAreRefused) {
  const test::ScratchFolder folder;
  write(folder / "a.nc", {.x = {10, 10.5, 11, 12, 13}}, test::ramp(5, 3));
  EXPECT_EQ(test::open_error(folder / "a.nc").code, ErrorCode::unsupported_version);
}

TEST(Netcdf, RoundedLongitudesAroundTheEarthMeet) {
  const test::ScratchFolder folder;
  write(folder / "a.nc", {.x = steps(0, 0.90003, 400)}, test::ramp(400, 3));
  const auto raster = test::open_raster(folder / "a.nc");
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().map.x_per_column, 360.0 / 400);
  EXPECT_EQ(raster->info().warnings.size(), 1u);
}

TEST(Netcdf, CutOffIsAMessage) {
  const test::ScratchFolder folder;
  for (const int mode : {NC_CLASSIC_MODEL, NC_NETCDF4}) {
    write(folder / "a.nc", {.mode = mode}, test::ramp(5, 3));
    const std::string bytes = test::file_bytes(folder / "a.nc");
    for (std::size_t size = 4; size < bytes.size(); size += bytes.size() / 50 + 1) {
      const auto raster = open_height_raster(folder.write("b.nc", bytes.substr(0, size)));
      std::vector<double> heights(15);
      if (!raster) {
        EXPECT_FALSE(raster.error().message.empty());
      } else if ((*raster)->info().width == 5 && (*raster)->info().height == 3) {
        (void)(*raster)->read({0, 0, 5, 3}, heights).has_value();
      }
    }
  }
}

TEST(Netcdf, CountsBeyondTheFileAreNotBelieved) {
  using namespace std::literals;
  const test::ScratchFolder folder;
  const auto head = "CDF\1\0\0\0\0"sv;
  const std::vector<std::string> tails{"\0\0\0\12\261\0\0\2"s,                        // dimensions
                                       "\0\0\0\12\0\0\0\1\177\0\0\0"s,                // the length of a name
                                       "\0\0\0\0\0\0\0\0\0\0\0\14\177\377\377\377"s,  // attributes
                                       "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\13\177\0\0\0"s};  // variables
  for (const std::string& tail : tails) {
    const auto raster = open_height_raster(folder.write("a.nc", std::string(head) + tail));
    ASSERT_FALSE(raster);
    EXPECT_EQ(raster.error().code, ErrorCode::corrupt);
    EXPECT_NE(raster.error().message.find("beyond the file"), std::string::npos) << raster.error().text();
  }
}

TEST(Netcdf, RastersTakeTurnsOverAllThreads) {
  const test::ScratchFolder folder;
  const auto heights = test::ramp(101, 67);
  write(folder / "a.nc", {.mode = NC_NETCDF4, .x = steps(0, 0.1, 101), .y = steps(5, -0.1, 67), .chunk = 8},
        heights);
  const auto shared = test::open_raster(folder / "a.nc", {.cache_bytes = 1000});
  ASSERT_TRUE(shared);
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      const auto own = test::open_raster(folder / "a.nc");
      test::expect_windows_equal_whole(*own, 5, t);
      test::expect_windows_equal_whole(*shared, 5, t);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace cuesta
