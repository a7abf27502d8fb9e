#include <zip.h>
#include <zlib.h>

#include "tests/terrain/raster_files.h"

namespace cuesta {
namespace {

using test::ramp;

std::string hgt(std::uint64_t n) {
  return test::packed<std::int16_t>(ramp(n, n), true);
}

void write_zip(const std::filesystem::path& path,
               const std::vector<std::pair<std::string, std::string>>& members) {
  zip_t* zip = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
  ASSERT_TRUE(zip);
  for (const auto& [name, bytes] : members)
    zip_file_add(zip, name.c_str(), zip_source_buffer(zip, bytes.data(), bytes.size(), 0), 0);
  ASSERT_EQ(zip_close(zip), 0);
}

TEST(Hgt, IsBigEndianFromTheNorthWest) {
  const test::ScratchFolder folder;
  auto heights = ramp(11, 11);
  heights[1] = -421;
  heights[2] = -32768;
  const auto raster =
      test::open_raster(folder.write("S29W072.hgt", test::packed<std::int16_t>(heights, true)));
  ASSERT_TRUE(raster);
  heights[2] = std::nan("");
  test::expect_heights(*raster, heights);
  test::expect_windows_equal_whole(*raster);
  const RasterInfo& info = raster->info();
  EXPECT_EQ(info.map, (PostingMap{-72, -28, 0.1, 0, 0, -0.1}));
  EXPECT_EQ(info.crs.kind, CrsDescription::Kind::geographic_wgs84);
  EXPECT_EQ(info.vertical_datum, VerticalDatum::orthometric);
  EXPECT_EQ(info.vertical_name, "EGM96");
}

TEST(Hgt, NeighboursShareTheirBorderExactly) {
  for (const double n : {1200.0, 3600.0, 10800.0, 6000.0}) EXPECT_EQ(0 + n * (1 / n), 1) << n;
}

TEST(Hgt, TheNameMustSayWhere) {
  const test::ScratchFolder folder;
  for (const std::string name : {"tile.hgt", "N95E010.hgt", "N4xE001.hgt", "E01N45.hgt"}) {
    const Error error = test::open_error(folder.write(name, hgt(5)));
    EXPECT_EQ(error.code, ErrorCode::invalid_input) << name;
    EXPECT_EQ(error.place, "name");
  }
  EXPECT_EQ(test::open_raster(folder.write("n45w001.HGT", hgt(5)))->info().map.x0, -1);
  RasterOptions options;
  options.placement = Placement{.x = 3, .y = 4, .x_spacing = 0.25, .y_spacing = 0.25};
  EXPECT_EQ(test::open_raster(folder / "tile.hgt", options)->info().map.y0, 4);
}

TEST(Hgt, CutOffIsAMessage) {
  const test::ScratchFolder folder;
  const std::string bytes = hgt(11);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{2}, bytes.size() - 1,
                                 bytes.size() - 2, bytes.size() + 2}) {
    std::string cut = bytes;
    cut.resize(size);
    const Error error = test::open_error(folder.write("N01E001.hgt", cut));
    EXPECT_EQ(error.code, ErrorCode::corrupt) << size;
    EXPECT_NE(error.message.find("cut off"), std::string::npos) << error.text();
  }
}

TEST(Hgt, FileThatIsCutWhileItIsOpenIsAMessage) {
  const test::ScratchFolder folder;
  const auto path = folder.write("N01E001.hgt", hgt(101));
  const auto raster = test::open_raster(path);
  ASSERT_TRUE(raster);
  std::filesystem::resize_file(path, 1000);
  std::vector<double> heights(101 * 101);
  EXPECT_FALSE(raster->read({0, 0, 101, 101}, heights));
}

TEST(Hgt, InsideAZip) {
  const test::ScratchFolder folder;
  write_zip(folder / "download.zip",
            {{"dem/", ""}, {"dem/N10E020.hgt", hgt(21)}, {"__MACOSX/._N10E020.hgt", "x"}});
  const auto raster = test::open_raster(folder / "download.zip");
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().map.x0, 20);
  EXPECT_EQ(raster->info().map.y0, 11);
  test::expect_heights(*raster, ramp(21, 21));
}

TEST(Hgt, AZipOfSeveralFilesIsRefused) {
  const test::ScratchFolder folder;
  write_zip(folder / "a.zip", {{"N10E020.hgt", hgt(21)}, {"N10E021.hgt", hgt(21)}});
  EXPECT_EQ(test::open_error(folder / "a.zip").code, ErrorCode::invalid_input);
  write_zip(folder / "b.zip", {{"empty/", ""}});
  EXPECT_EQ(test::open_error(folder / "b.zip").code, ErrorCode::invalid_input);
}

TEST(Hgt, ADamagedZipIsAMessage) {
  const test::ScratchFolder folder;
  write_zip(folder / "a.zip", {{"N10E020.hgt", hgt(21)}});
  const std::string bytes = test::file_bytes(folder / "a.zip");
  for (std::size_t size = 4; size < bytes.size(); size += 7)
    EXPECT_FALSE(test::open_error(folder.write("N10E020.hgt.zip", bytes.substr(0, size))).message.empty())
        << size;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string bad = bytes;
    bad[at] = static_cast<char>(~bad[at]);
    const auto raster = open_height_raster(folder.write("N10E020.hgt.zip", bad));
    EXPECT_TRUE(raster || !raster.error().message.empty());
  }
}

TEST(Hgt, InsideGzip) {
  const test::ScratchFolder folder;
  const std::string path = (folder / "N10E020.hgt.gz").string(), bytes = hgt(21);
  gzFile file = gzopen(path.c_str(), "wb");
  ASSERT_GT(gzwrite(file, bytes.data(), unsigned(bytes.size())), 0);
  gzclose(file);
  const auto raster = test::open_raster(path);
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().map.y0, 11);
  test::expect_heights(*raster, ramp(21, 21));
}

TEST(Hgt, AnythingElseIsNoRaster) {
  const test::ScratchFolder folder;
  EXPECT_EQ(test::open_error(folder.write("a.txt", "hello")).code, ErrorCode::unsupported_version);
  EXPECT_EQ(test::open_error(folder / "none.hgt").code, ErrorCode::not_found);
}

}  // namespace
}  // namespace cuesta
