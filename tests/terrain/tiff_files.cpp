#include "tests/terrain/tiff_files.h"

#include <gtest/gtest.h>
#include <tiffio.h>

#include <algorithm>
#include <cstring>

#include "terrain/tiff_handle.h"

namespace cuesta::test {
namespace {

template <class T>
void put(std::byte* to, double value) {
  const T stored = static_cast<T>(value);
  std::memcpy(to, &stored, sizeof(T));
}

void put_sample(std::byte* to, SampleType type, double value) {
  switch (type) {
    case SampleType::u8:
      return put<std::uint8_t>(to, value);
    case SampleType::i8:
      return put<std::int8_t>(to, value);
    case SampleType::u16:
      return put<std::uint16_t>(to, value);
    case SampleType::i16:
      return put<std::int16_t>(to, value);
    case SampleType::u32:
      return put<std::uint32_t>(to, value);
    case SampleType::i32:
      return put<std::int32_t>(to, value);
    case SampleType::f32:
      return put<float>(to, value);
    case SampleType::f64:
      return put<double>(to, value);
  }
}

std::uint16_t format_of(SampleType type) {
  if (type == SampleType::f32 || type == SampleType::f64) return SAMPLEFORMAT_IEEEFP;
  const bool is_signed = type == SampleType::i8 || type == SampleType::i16 || type == SampleType::i32;
  return is_signed ? SAMPLEFORMAT_INT : SAMPLEFORMAT_UINT;
}

void set_doubles(TIFF* tiff, std::uint32_t tag, const std::vector<double>& values) {
  if (!values.empty()) {
    EXPECT_TRUE(TIFFSetField(tiff, tag, std::uint32_t(values.size()), values.data()));
  }
}

void set_tags(TIFF* tiff, const TiffRecipe& r) {
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, r.width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, r.height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8 * int(bytes_of(r.type)));
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, format_of(r.type));
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, r.channels);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, r.channels == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
  EXPECT_TRUE(TIFFSetField(tiff, TIFFTAG_COMPRESSION, r.compression));
  if (r.predictor != 1) {
    EXPECT_TRUE(TIFFSetField(tiff, TIFFTAG_PREDICTOR, r.predictor));
  }
  if (r.tile > 0) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, r.tile);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, r.tile);
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, r.rows_per_strip);
  }
  if (!r.no_data.empty()) {
    EXPECT_TRUE(TIFFSetField(tiff, tiff_tag::gdal_no_data, r.no_data.c_str()));
  }
  if (!r.metadata.empty()) {
    EXPECT_TRUE(TIFFSetField(tiff, tiff_tag::gdal_metadata, r.metadata.c_str()));
  }
  set_doubles(tiff, tiff_tag::tie_points, r.tie_points);
  set_doubles(tiff, tiff_tag::pixel_scale, r.pixel_scale);
  set_doubles(tiff, tiff_tag::transformation, r.transformation);
  set_doubles(tiff, tiff_tag::geo_doubles, r.geo_doubles);
  if (!r.geo_keys.empty()) {
    EXPECT_TRUE(TIFFSetField(tiff, tiff_tag::geo_keys, std::uint32_t(r.geo_keys.size()), r.geo_keys.data()));
  }
  if (!r.geo_ascii.empty()) {
    EXPECT_TRUE(TIFFSetField(tiff, tiff_tag::geo_ascii, r.geo_ascii.c_str()));
  }
}

/// `columns` × `rows` samples from (left, top) on; zeros beyond the edge.
std::vector<std::byte> block_of(const TiffRecipe& r, const std::vector<double>& heights, std::uint32_t left,
                                std::uint32_t top, std::uint32_t columns, std::uint32_t rows) {
  const std::size_t each = bytes_of(r.type) * r.channels;
  std::vector<std::byte> block(std::size_t{columns} * rows * each);
  for (std::uint32_t y = 0; y < rows && top + y < r.height; ++y) {
    for (std::uint32_t x = 0; x < columns && left + x < r.width; ++x)
      put_sample(block.data() + (std::size_t{y} * columns + x) * each, r.type,
                 heights[std::size_t{top + y} * r.width + left + x]);
  }
  return block;
}

void swap_samples(std::vector<std::byte>& samples, std::size_t each) {
  for (std::size_t at = 0; at < samples.size(); at += each)
    std::reverse(samples.begin() + long(at), samples.begin() + long(at + each));
}

}  // namespace

void write_tiff(const std::filesystem::path& path, const TiffRecipe& r, const std::vector<double>& heights) {
  register_geotiff_tags();
  const std::string mode = std::string("w") + (r.big_endian ? "b" : "l") + (r.big_tiff ? "8" : "");
  TIFF* tiff = TIFFOpen(path.c_str(), mode.c_str());
  ASSERT_TRUE(tiff) << path;
  set_tags(tiff, r);
  const std::uint32_t columns = r.tile > 0 ? r.tile : r.width, rows = r.tile > 0 ? r.tile : r.rows_per_strip;
  std::uint32_t number = 0;
  for (std::uint32_t top = 0; top < r.height; top += rows) {
    for (std::uint32_t left = 0; left < r.width; left += columns) {
      const std::uint32_t there = r.tile > 0 ? rows : std::min(rows, r.height - top);
      auto block = block_of(r, heights, left, top, columns, there);
      // libtiff 4.5 swaps bytes before predictor 3, which wants them as they are: swapped twice is right.
      if (r.big_endian && r.predictor == 3) swap_samples(block, bytes_of(r.type));
      const bool is_last = top + rows >= r.height && left + columns >= r.width;
      if (is_last && r.leave_out_last_tile) continue;
      const auto size = static_cast<tmsize_t>(block.size());
      EXPECT_EQ(size, r.tile > 0 ? TIFFWriteEncodedTile(tiff, number, block.data(), size)
                                 : TIFFWriteEncodedStrip(tiff, number, block.data(), size));
      ++number;
    }
  }
  TIFFClose(tiff);
}

}  // namespace cuesta::test
