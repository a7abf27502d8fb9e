/// Damaged rasters: every one is read or refused with a message; none crashes, hangs or takes much memory.

#include <tiff.h>

#include "tests/shared_data.h"
#include "tests/terrain/memory_file.h"
#include "tests/terrain/raster_files.h"
#include "tests/terrain/tiff_files.h"

namespace cuesta {
namespace {

/// Reads two windows. What is too large for a test to read whole is read in part.
bool read_or_refused(const RasterResult& raster, const std::string& path) {
  if (!raster) {
    EXPECT_FALSE(raster.error().message.empty()) << path;
    EXPECT_FALSE(raster.error().file.empty()) << path;
    return false;
  }
  const RasterInfo& info = (*raster)->info();
  const std::uint64_t width = std::min<std::uint64_t>(info.width, 300),
                      height = std::min<std::uint64_t>(info.height, 300);
  std::vector<double> heights(width * height);
  bool good = true;
  for (const Window& window :
       {Window{0, 0, width, height}, Window{info.width - width, info.height - height, width, height}}) {
    const auto read = (*raster)->read(window, heights);
    good &= read.has_value();
    if (!read) {
      EXPECT_FALSE(read.error().message.empty()) << path;
      continue;
    }
    for (const double h : heights) EXPECT_FALSE(std::isinf(h)) << path;
  }
  return good;
}

/// Of bytes that never were on a disk.
bool read_or_refused(const std::string& name, const std::string& bytes) {
  return read_or_refused(open_raster(test::memory_file(name, bytes), {.cache_bytes = 1 << 16}), name);
}

struct SmallFile {
  std::string name, bytes;
};

std::vector<SmallFile> small_files() {
  const test::ScratchFolder folder;
  std::vector<SmallFile> files;
  const std::vector<std::uint16_t> keys{1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 2, 2048, 0, 1, 4326};
  for (const std::uint32_t tile : {0u, 16u}) {
    for (const int compression :
         {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_ZSTD}) {
      for (const bool big_tiff : {false, true}) {
        test::write_tiff(folder / "a.tif",
                         {.width = 20,
                          .height = 12,
                          .type = SampleType::f32,
                          .compression = std::uint16_t(compression),
                          .predictor = std::uint16_t(compression == COMPRESSION_NONE ? 1 : 3),
                          .tile = tile,
                          .big_endian = big_tiff,
                          .big_tiff = big_tiff,
                          .no_data = "-9999",
                          .tie_points = {0, 0, 0, 10, 50, 0},
                          .pixel_scale = {1, 1, 0},
                          .geo_keys = keys},
                         test::ramp(20, 12));
        files.push_back({"a.tif", test::file_bytes(folder / "a.tif")});
      }
    }
  }
  files.push_back({"N01E001.hgt", test::packed<std::int16_t>(test::ramp(9, 9), true)});
  files.push_back(
      {"a.asc",
       "ncols 3\nnrows 2\nxllcorner 1\nyllcorner 2\ncellsize 1e1\nNODATA_value -1\n1 2 3\n4 -1 6.25\n"});
  files.push_back({"a.i16", test::packed<std::int16_t>(test::ramp(9, 9))});
  return files;
}

TEST(HostileRasters, CutAnywhere) {
  for (const SmallFile& file : small_files()) {
    EXPECT_TRUE(read_or_refused(file.name, file.bytes)) << file.name;
    for (std::size_t size = 0; size < file.bytes.size(); ++size)
      read_or_refused(file.name, file.bytes.substr(0, size));
  }
}

TEST(HostileRasters, EveryByteChanged) {
  for (const SmallFile& file : small_files()) {
    for (std::size_t at = 0; at < file.bytes.size(); ++at) {
      for (const int flip : {0x01, 0x80, 0xFF}) {
        std::string bad = file.bytes;
        bad[at] = static_cast<char>(bad[at] ^ flip);
        read_or_refused(file.name, bad);
      }
    }
  }
}

TEST(HostileRasters, SharedTiffsEndInAMessageOrHeights) {
  CUESTA_NEED_SHARED(path, "bad/tiff");
  unsigned refused = 0;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    SCOPED_TRACE(entry.path().filename().string());
    refused += !read_or_refused(open_height_raster(entry.path()), entry.path().string());
  }
  EXPECT_GT(refused, 20u);
}

TEST(HostileRasters, SizesThatCannotBeAreRefusedBeforeAnythingIsAllocated) {
  const test::ScratchFolder folder;
  test::write_tiff(folder / "a.tif", {.rows_per_strip = 29}, test::ramp(37, 29));
  std::string bytes = test::file_bytes(folder / "a.tif");
  // Width and height are LONG or SHORT entries of the directory: find them by tag.
  for (const int tag : {0, 1}) {
    for (std::size_t at = 8; at + 12 <= bytes.size(); ++at) {
      if (bytes[at] == char(tag) && bytes[at + 1] == 1 && (bytes[at + 2] == 3 || bytes[at + 2] == 4) &&
          bytes[at + 3] == 0 && bytes[at + 4] == 1) {
        bytes[at + 2] = 4;
        bytes.replace(at + 8, 4, "\xff\xff\xff\x7f", 4);
        break;
      }
    }
    EXPECT_FALSE(read_or_refused("b.tif", bytes));
  }
}

}  // namespace
}  // namespace cuesta
