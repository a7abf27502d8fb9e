/// ESRI ASCII grids, raw samples, and the sidecars that say what they are.

#include "terrain/raster_sidecar.h"
#include "tests/shared_data.h"
#include "tests/terrain/raster_files.h"

namespace cuesta {
namespace {

using test::ramp;

const std::string head = "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\nNODATA_value -1\n";

TEST(AsciiGrid, CornerAndCentreFormsPlaceThePostings) {
  const test::ScratchFolder folder;
  const auto corner = test::open_raster(folder.write("a.asc", head + "1 2 3\n4 -1 6.25\n"));
  ASSERT_TRUE(corner);
  EXPECT_EQ(corner->info().map, (PostingMap{105, 215, 10, 0, 0, -10}));
  test::expect_heights(*corner, {1, 2, 3, 4, std::nan(""), 6.25});
  const auto centre = test::open_raster(folder.write(
      "b.asc",
      "NROWS 2\r\nNCOLS 3\r\nCELLSIZE 10\r\nXLLCENTER 105\r\nYLLCENTER 205\r\n1 2 3\r\n4 -9999 6\r\n"));
  ASSERT_TRUE(centre);
  EXPECT_EQ(centre->info().map, corner->info().map);
  test::expect_heights(*centre, {1, 2, 3, 4, std::nan(""), 6});
}

TEST(AsciiGrid, LinesMayBreakAnywhere) {
  const test::ScratchFolder folder;
  const auto raster = test::open_raster(folder.write("a.asc", head + "1\n2 3 4\n\n  5\t6e1"));
  ASSERT_TRUE(raster);
  test::expect_heights(*raster, {1, 2, 3, 4, 5, 60});
}

TEST(AsciiGrid, DifferentSpacingsAndNaN) {
  const test::ScratchFolder folder;
  const auto raster = test::open_raster(
      folder.write("a.asc", "ncols 2\nnrows 2\nxllcenter 0\nyllcenter 0\ndx 2\ndy 3\nnan 2 3 4\n"));
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().map, (PostingMap{0, 3, 2, 0, 0, -3}));
  test::expect_heights(*raster, {std::nan(""), 2, 3, 4});
}

TEST(AsciiGrid, WindowsEqualTheWholeOfALargeOne) {
  const test::ScratchFolder folder;
  for (const auto& [width, height] : {std::pair{700u, 900u}, {200'000u, 3u}}) {
    const auto heights = ramp(width, height);
    std::string text = "ncols " + std::to_string(width) + "\nnrows " + std::to_string(height) +
                       "\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
    for (std::size_t i = 0; i < heights.size(); ++i)
      text += std::to_string(int(heights[i])) + ((i + 1) % width == 0 ? "\n" : " ");
    const auto raster = test::open_raster(folder.write("a.asc", text), {.cache_bytes = 1});
    ASSERT_TRUE(raster);
    EXPECT_LE(raster->memory_bytes(), 3u << 20);
    test::expect_heights(*raster, heights);
    test::expect_windows_equal_whole(*raster, 6);
  }
}

TEST(AsciiGrid, WhatIsWrongIsToldWithItsPlace) {
  const test::ScratchFolder folder;
  const auto error_of = [&](const std::string& text) {
    return test::open_error(folder.write("a.asc", text));
  };
  EXPECT_NE(error_of(head + "1 2 3 4 5000000").message.find("found 5"), std::string::npos);
  EXPECT_NE(error_of(head + "1 2 3 4 5 6 7").message.find("more"), std::string::npos);
  EXPECT_EQ(error_of("ncols 3\nnrows 0\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n").place, "head");
  EXPECT_EQ(error_of("ncols 3\nnrows 2\nyllcorner 0\ncellsize 1\n1 2 3 4 5 6\n").place, "head");
  EXPECT_EQ(error_of("ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 0\n1 2 3 4 5 6\n").place, "head");
  EXPECT_EQ(error_of("ncols 3\nbanana 2\n").place, "byte 8");
  EXPECT_EQ(
      error_of("ncols 2000000000\nnrows 2000000000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n").code,
      ErrorCode::corrupt);
  const auto raster = test::open_raster(folder.write("b.asc", head + "1 2 3 4 five 6"));
  ASSERT_TRUE(raster);
  std::vector<double> heights(6);
  const auto read = raster->read({0, 0, 3, 2}, heights);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().place, "byte " + std::to_string(head.size() + 8));
  EXPECT_NE(read.error().message.find("five"), std::string::npos);
}

TEST(AsciiGrid, PrjBesideItIsKept) {
  const test::ScratchFolder folder;
  folder.write("a.prj", "PROJCS[\"NAD_1983_UTM_Zone_12N\"]");
  const auto raster = test::open_raster(folder.write("a.asc", head + "1 2 3 4 5 6"));
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().crs.kind, CrsDescription::Kind::wkt);
  EXPECT_EQ(raster->info().crs.text, "PROJCS[\"NAD_1983_UTM_Zone_12N\"]");
  EXPECT_EQ(raster->info().files.size(), 2u);
}

TEST(Raw, EveryTypeAndByteOrder) {
  const test::ScratchFolder folder;
  const auto heights = ramp(13, 7);
  const auto expect = [&](SampleType type, const std::string& bytes, ByteOrder order) {
    const auto raster =
        test::open_raster(folder.write("a.raw", "head" + bytes),
                          {.type = type, .byte_order = order, .width = 13, .height = 7, .header_bytes = 4});
    ASSERT_TRUE(raster);
    test::expect_heights(*raster, heights);
    test::expect_windows_equal_whole(*raster);
  };
  for (const bool big : {false, true}) {
    const ByteOrder order = big ? ByteOrder::big : ByteOrder::little;
    expect(SampleType::u8, test::packed<std::uint8_t>(heights, big), order);
    expect(SampleType::u16, test::packed<std::uint16_t>(heights, big), order);
    expect(SampleType::i16, test::packed<std::int16_t>(heights, big), order);
    expect(SampleType::u32, test::packed<std::uint32_t>(heights, big), order);
    expect(SampleType::i32, test::packed<std::int32_t>(heights, big), order);
    expect(SampleType::f32, test::packed<float>(heights, big), order);
    expect(SampleType::f64, test::packed<double>(heights, big), order);
  }
}

TEST(Raw, ASquareNeedsNoOptions) {
  const test::ScratchFolder folder;
  const auto raster = test::open_raster(folder.write("a.i16", test::packed<std::int16_t>(ramp(9, 9))));
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->info().width, 9u);
  EXPECT_FALSE(raster->info().is_placed);
  test::expect_heights(*raster, ramp(9, 9));
}

TEST(Raw, WrongSizesAreToldWithBoth) {
  const test::ScratchFolder folder;
  const auto path = folder.write("a.i16", test::packed<std::int16_t>(ramp(9, 8)));
  EXPECT_EQ(test::open_error(path).place, "size");
  const Error error = test::open_error(path, {.width = 9, .height = 9});
  EXPECT_EQ(error.code, ErrorCode::corrupt);
  EXPECT_NE(error.message.find("162 bytes; found 144"), std::string::npos) << error.text();
  EXPECT_EQ(test::open_error(path, {.width = 1u << 31, .height = 1u << 31}).code, ErrorCode::corrupt);
  EXPECT_EQ(test::open_error(path, {.width = 0, .height = 9}).code, ErrorCode::invalid_input);
  EXPECT_EQ(test::open_error(folder.write("a.raw", "xx")).place, "type");
}

TEST(Raw, LargeWindowsTakeSeveralReads) {
  const test::ScratchFolder folder;
  const auto heights = ramp(600, 500);
  const auto raster = test::open_raster(folder.write("a.f64", test::packed<double>(heights)), {.width = 600});
  ASSERT_TRUE(raster);
  EXPECT_LE(raster->memory_bytes(), 1u << 18);
  test::expect_heights(*raster, heights);
}

TEST(Sidecar, SaysWhatTheFileDoesNot) {
  const test::ScratchFolder folder;
  folder.write("a.bin.json",
               R"({"format": "raw", "type": "uint16", "byte_order": "big", "width": 3, "height": 2,
                   "placement": {"x": 10, "y": 20, "x_spacing": 2, "y_spacing": 4, "pixel_is": "area"},
                   "epsg": 32633, "vertical_datum": "ellipsoidal", "no_data": 0, "scale": 0.5, "offset": 1,
                   "unit_m": 0.3048})");
  const auto path = folder.write("a.bin", test::packed<std::uint16_t>({0, 1, 2, 3, 4, 60000}, true));
  const auto raster = test::open_raster(path);
  ASSERT_TRUE(raster);
  const RasterInfo& info = raster->info();
  EXPECT_EQ(info.map, (PostingMap{11, 18, 2, 0, 0, -4}));
  EXPECT_EQ(info.crs.kind, CrsDescription::Kind::epsg);
  EXPECT_EQ(info.crs.epsg, 32633u);
  EXPECT_EQ(info.vertical_datum, VerticalDatum::ellipsoidal);
  EXPECT_EQ(info.files, (std::vector<std::string>{path.string(), path.string() + ".json"}));
  EXPECT_TRUE(std::isnan(test::height_at(*raster, 0, 0)));
  EXPECT_DOUBLE_EQ(test::height_at(*raster, 2, 1), 30001 * 0.3048);
  EXPECT_EQ(test::open_raster(path, {.epsg = 4326})->info().crs.epsg, 4326u);  // options go before it
}

TEST(Sidecar, MistakesAreToldByKey) {
  const test::ScratchFolder folder;
  const auto path = folder.write("a.i16", test::packed<std::int16_t>(ramp(4, 4)));
  for (const std::string text :
       {"{\"colour\": 1}", "{\"width\": -1}", "{\"width\": 1.5}", "{\"type\": \"int17\"}",
        "{\"placement\": {\"x\": 1}}", "{\"epsg\": 99999999999}", "{\"no_data\": \"none\"}",
        "{\"variable\": 3}", "{\"format\": \"jpeg\"}"}) {
    folder.write("a.i16.json", text);
    const Error error = test::open_error(path);
    EXPECT_EQ(error.code, ErrorCode::invalid_input) << text;
    EXPECT_NE(error.place.find("key"), std::string::npos) << text;
    EXPECT_NE(error.file.find(".json"), std::string::npos) << text;
  }
  for (const std::string text : {"", "{", "[]", "3"}) {
    folder.write("a.i16.json", text);
    EXPECT_EQ(test::open_error(path).code, ErrorCode::corrupt) << text;
  }
  for (const std::string text :
       {"{\"scale\": 0}", "{\"unit_m\": -1}", "{\"width\": 0}",
        "{\"placement\": {\"x\": 1, \"y\": 1, \"x_spacing\": 0, \"y_spacing\": 1}}"}) {
    folder.write("a.i16.json", text);
    EXPECT_EQ(test::open_error(path).place, "options") << text;
  }
}

}  // namespace
}  // namespace cuesta
