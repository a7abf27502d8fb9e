#include "terrain/image_drape.h"

#include <gtest/gtest.h>
#include <png.h>
#include <tiffio.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

// After cstdio, which it needs.
#include <jpeglib.h>

#include "terrain/tiff_handle.h"
#include "tests/ooc/mesh_files.h"

namespace cuesta {
namespace {

/// Red grows to the east, green to the south; blue tells odd pixels from even ones where `checks`.
struct TestPicture {
  int width = 40, height = 20;
  bool checks = false;
  int channels = 3;

  Rgba8 colour(int x, int y) const {
    const auto ramp = [](int i, int n) { return static_cast<std::uint8_t>(20 + 200 * i / (n - 1)); };
    const bool is_hole = channels == 4 && x < 4 && y < 4;
    return {ramp(x, width), ramp(y, height), static_cast<std::uint8_t>(checks && (x + y) % 2 ? 200 : 40),
            static_cast<std::uint8_t>(is_hole ? 0 : 255)};
  }
  std::vector<unsigned char> bytes() const {
    std::vector<unsigned char> out;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (int c = 0; c < channels; ++c) out.push_back(colour(x, y)[static_cast<std::size_t>(c)]);
    return out;
  }
};

std::filesystem::path write_png(const std::filesystem::path& path, const TestPicture& p) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(p.width);
  image.height = static_cast<png_uint_32>(p.height);
  image.format = p.channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  EXPECT_TRUE(png_image_write_to_file(&image, path.c_str(), 0, p.bytes().data(), 0, nullptr));
  return path;
}

std::filesystem::path write_jpeg(const std::filesystem::path& path, const TestPicture& p, bool progressive) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* out = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &out, &size);
  jpeg.image_width = static_cast<JDIMENSION>(p.width);
  jpeg.image_height = static_cast<JDIMENSION>(p.height);
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 98, TRUE);
  if (progressive) jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  auto bytes = p.bytes();
  for (int y = 0; y < p.height; ++y) {
    JSAMPROW row = bytes.data() + static_cast<std::size_t>(y * p.width * 3);
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<char*>(out), static_cast<std::streamsize>(size));
  jpeg_destroy_compress(&jpeg);
  std::free(out);
  return path;
}

struct TiffKind {
  std::uint32_t tile = 0, rows_per_strip = 3;
  std::uint16_t compression = COMPRESSION_NONE;
  std::vector<std::uint16_t> keys = {};
  std::vector<double> ties = {}, scale = {};
};

std::filesystem::path write_tiff(const std::filesystem::path& path, const TestPicture& p,
                                 const TiffKind& kind) {
  register_geotiff_tags();
  TIFF* tiff = TIFFOpen(path.c_str(), "w");
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, p.width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, p.height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, p.channels);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, kind.compression);
  if (p.channels == 4) {
    const std::uint16_t extra = EXTRASAMPLE_UNASSALPHA;
    TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &extra);
  }
  const auto doubles = [&](std::uint32_t tag, const std::vector<double>& values) {
    if (!values.empty()) TIFFSetField(tiff, tag, std::uint32_t(values.size()), values.data());
  };
  doubles(tiff_tag::tie_points, kind.ties);
  doubles(tiff_tag::pixel_scale, kind.scale);
  if (!kind.keys.empty())
    TIFFSetField(tiff, tiff_tag::geo_keys, std::uint32_t(kind.keys.size()), kind.keys.data());
  const int across = kind.tile > 0 ? static_cast<int>(kind.tile) : p.width;
  const int down = static_cast<int>(kind.tile > 0 ? kind.tile : kind.rows_per_strip);
  if (kind.tile > 0) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, kind.tile);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, kind.tile);
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, kind.rows_per_strip);
  }
  std::uint32_t number = 0;
  for (int top = 0; top < p.height; top += down)
    for (int left = 0; left < p.width; left += across) {
      std::vector<unsigned char> block;
      for (int y = top; y < top + down && (kind.tile > 0 || y < p.height); ++y)
        for (int x = left; x < left + across; ++x)
          for (int c = 0; c < p.channels; ++c)
            block.push_back(x < p.width && y < p.height ? p.colour(x, y)[static_cast<std::size_t>(c)] : 0);
      const auto size = static_cast<tmsize_t>(block.size());
      EXPECT_EQ(size, kind.tile > 0 ? TIFFWriteEncodedTile(tiff, number, block.data(), size)
                                    : TIFFWriteEncodedStrip(tiff, number, block.data(), size));
      ++number;
    }
  TIFFClose(tiff);
  return path;
}

constexpr GeoBox box{6, 45, 10, 47};  // 0.1 degrees a pixel of the usual picture

ImageDrape opened(const std::filesystem::path& path, const DrapeOptions& options = {.bounds = box}) {
  auto drape = ImageDrape::open(path, options);
  if (!drape) throw std::runtime_error(drape.error().text());
  return std::move(*drape);
}

Rgba8 colour_at(const ImageDrape& drape, LatLon at) {
  Rgba8 colour{1, 2, 3, 4};
  const auto sampled = drape.sample(std::span(&at, 1), std::span(&colour, 1));
  EXPECT_TRUE(sampled) << sampled.error().text();
  return colour;
}

LatLon middle_of(int x, int y) {
  return {47 - 0.1 * (y + 0.5), 6 + 0.1 * (x + 0.5)};
}

void expect_near(Rgba8 a, Rgba8 b, int slack, const std::string& where) {
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(a[c], b[c], slack) << where << ", channel " << c;
}

void expect_middles(const ImageDrape& drape, const TestPicture& p, int slack) {
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      const Rgba8 expected = p.colour(x, y)[3] == 0 ? Rgba8{0, 0, 0, 0} : p.colour(x, y);
      expect_near(colour_at(drape, middle_of(x, y)), expected, slack,
                  std::to_string(x) + ", " + std::to_string(y));
    }
}

TEST(ImageDrape, EveryFormatGivesItsPixels) {
  const test::ScratchFolder folder;
  const TestPicture smooth, checks{.checks = true}, holes{.channels = 4};
  expect_middles(opened(write_png(folder / "a.png", checks)), checks, 1);
  expect_middles(opened(write_png(folder / "b.png", holes)), holes, 1);
  expect_middles(opened(write_jpeg(folder / "a.jpg", smooth, false)), smooth, 8);
  expect_middles(opened(write_jpeg(folder / "b.jpg", smooth, true)), smooth, 8);
  for (const TiffKind& kind :
       {TiffKind{}, TiffKind{.rows_per_strip = 20},
        TiffKind{.rows_per_strip = 7, .compression = COMPRESSION_LZW}, TiffKind{.tile = 16},
        TiffKind{.tile = 32, .compression = COMPRESSION_ADOBE_DEFLATE}}) {
    expect_middles(opened(write_tiff(folder / "a.tif", checks, kind)), checks, 1);
    expect_middles(opened(write_tiff(folder / "b.tif", holes, kind)), holes, 1);
  }
}

TEST(ImageDrape, WhatOnlyLibtiffCanDecode) {
  const test::ScratchFolder folder;
  const TestPicture p;
  for (const std::uint32_t tile : {0u, 16u})
    expect_middles(opened(write_tiff(folder / "a.tif", p,
                                     {.tile = tile, .rows_per_strip = 8, .compression = COMPRESSION_JPEG})),
                   p, 12);
}

TEST(ImageDrape, LinearBetweenMiddles) {
  const test::ScratchFolder folder;
  const TestPicture p;
  const ImageDrape drape = opened(write_png(folder / "a.png", p));
  const Rgba8 a = p.colour(10, 5), b = p.colour(11, 6);
  const Rgba8 half = colour_at(drape, {(middle_of(10, 5).lat_deg + middle_of(11, 6).lat_deg) / 2,
                                       (middle_of(10, 5).lon_deg + middle_of(11, 6).lon_deg) / 2});
  EXPECT_NEAR(half[0], (a[0] + b[0]) / 2.0, 1);
  EXPECT_NEAR(half[1], (a[1] + b[1]) / 2.0, 1);
  const TestPicture checks{.checks = true};
  const ImageDrape blue = opened(write_png(folder / "b.png", checks));
  const LatLon corner{46.9, 6.1};  // of four pixels, two and two alike
  EXPECT_NEAR(colour_at(blue, corner)[2], 120, 1);
}

TEST(ImageDrape, NothingOutsideAndTheEdgeIsItsPixels) {
  const test::ScratchFolder folder;
  const TestPicture p;
  const ImageDrape drape = opened(write_png(folder / "a.png", p));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const LatLon at :
       {LatLon{47.01, 8}, LatLon{44.99, 8}, LatLon{46, 5.99}, LatLon{46, 10.01}, LatLon{nan, nan}})
    EXPECT_EQ(colour_at(drape, at), (Rgba8{0, 0, 0, 0}));
  expect_near(colour_at(drape, {46.9999, 6.0001}), p.colour(0, 0), 1, "corner");
  expect_near(colour_at(drape, {45.0001, 9.9999}), p.colour(39, 19), 1, "corner");
  expect_near(colour_at(drape, {46, 368}), colour_at(drape, {46, 8}), 0, "a turn further");
}

TEST(ImageDrape, AroundTheEarthItClosesOnItself) {
  const test::ScratchFolder folder;
  const TestPicture p;
  const ImageDrape drape = opened(write_png(folder / "a.png", p), {.bounds = GeoBox{-180, -90, 180, 90}});
  const Rgba8 seam = colour_at(drape, {0, 180}), also = colour_at(drape, {0, -180});
  EXPECT_NEAR(seam[0], (p.colour(0, 0)[0] + p.colour(39, 0)[0]) / 2.0, 1);
  expect_near(seam, also, 0, "the antimeridian");
  const ImageDrape pacific = opened(folder / "a.png", {.bounds = GeoBox{170, -10, 190, 10}});
  EXPECT_EQ(colour_at(pacific, {0, -175})[3], 255);
  EXPECT_EQ(colour_at(pacific, {0, 175})[3], 255);
  EXPECT_EQ(colour_at(pacific, {0, 0})[3], 0);
}

TEST(ImageDrape, AGeoTiffLiesWhereItSays) {
  const test::ScratchFolder folder;
  const TestPicture p;
  // UTM 32, corner of the first pixel at (500000, 5200000), 100 m a pixel.
  const TiffKind utm{.keys = {1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32632},
                     .ties = {0, 0, 0, 500000, 5200000, 0},
                     .scale = {100, 100, 0}};
  const ImageDrape drape = opened(write_tiff(folder / "utm.tif", p, utm), {});
  const Crs crs = Crs::from_epsg(32632).value();
  expect_near(colour_at(drape, crs.lat_lon({500000 + 1050, 5200000 - 350})), p.colour(10, 3), 1, "utm");
  EXPECT_EQ(colour_at(drape, crs.lat_lon({499990, 5200000 - 350}))[3], 0);
  EXPECT_NE(drape.description().find("32632"), std::string::npos) << drape.description();
  // Bounds go before it.
  expect_near(colour_at(opened(folder / "utm.tif"), middle_of(7, 7)), p.colour(7, 7), 1, "bounds");
}

TEST(ImageDrape, ASmallCacheGivesTheSame) {
  const test::ScratchFolder folder;
  const TestPicture p{.width = 300, .height = 300, .checks = true};
  write_tiff(folder / "a.tif", p, {.tile = 16});
  const ImageDrape roomy = opened(folder / "a.tif"),
                   tight = opened(folder / "a.tif", {.bounds = box, .cache_bytes = 1});
  std::vector<LatLon> places;
  for (int i = 0; i < 4000; ++i)
    places.push_back({45 + 2 * std::fmod(i * 0.618034, 1.0), 6 + 4 * std::fmod(i * 0.7548777, 1.0)});
  std::vector<Rgba8> a(places.size()), b(places.size());
  ASSERT_TRUE(roomy.sample(places, a));
  ASSERT_TRUE(tight.sample(places, b));
  EXPECT_EQ(a, b);
}

TEST(ImageDrape, Refusals) {
  const test::ScratchFolder folder;
  const TestPicture p;
  const auto error = [](const std::filesystem::path& path, const DrapeOptions& options = {.bounds = box}) {
    const auto drape = ImageDrape::open(path, options);
    EXPECT_FALSE(drape) << path;
    return drape ? Error{} : drape.error();
  };
  write_png(folder / "a.png", p);
  EXPECT_EQ(error(folder / "a.png", {}).code, ErrorCode::invalid_input);
  EXPECT_EQ(error(folder / "a.png", {.bounds = GeoBox{1, 2, 1, 3}}).code, ErrorCode::invalid_input);
  EXPECT_EQ(error(folder / "none.png").code, ErrorCode::not_found);
  EXPECT_EQ(error(folder.write("a.txt", "no picture")).code, ErrorCode::unsupported_version);
}

TEST(ImageDrape, DamageGivesErrorsOrColours) {
  const test::ScratchFolder folder;
  const TestPicture p;
  write_jpeg(folder / "a.jpg", p, false);
  write_jpeg(folder / "b.jpg", p, true);
  write_png(folder / "c.png", p);
  write_tiff(folder / "d.tif", p, {.tile = 16, .compression = COMPRESSION_LZW});
  std::size_t refused = 0, tried = 0;
  for (const char* name : {"a.jpg", "b.jpg", "c.png", "d.tif"}) {
    std::ifstream in(folder / name, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    for (std::size_t n = 0; n < bytes.size(); n += 7) {
      for (const std::string& damaged : {bytes.substr(0, n), [&] {
                                           std::string flipped = bytes;
                                           flipped[n] = static_cast<char>(flipped[n] ^ 0x55);
                                           return flipped;
                                         }()}) {
        const auto drape = ImageDrape::open(folder.write("damaged", damaged), {.bounds = box});
        std::vector<LatLon> places{{46, 7}, {46.9, 9.9}};
        std::vector<Rgba8> colours(2);
        ++tried;
        refused += !drape || !drape->sample(places, colours) ? 1u : 0u;
      }
    }
  }
  EXPECT_GT(refused, tried / 2) << tried;
}

TEST(GeoBoxText, WestSouthEastNorth) {
  EXPECT_EQ(parse_geo_box("6,45,10,47.5"), (GeoBox{6, 45, 10, 47.5}));
  EXPECT_EQ(parse_geo_box("170,-10,-170,10"), (GeoBox{170, -10, 190, 10}));
  for (const char* bad :
       {"", "1,2,3", "1,2,3,4,5", "1, 2,3,4", "1,2,1,4", "1,4,3,2", "1,2,3,x", "1,2,3,91", "nan,2,3,4"})
    EXPECT_FALSE(parse_geo_box(bad)) << bad;
}

}  // namespace
}  // namespace cuesta
