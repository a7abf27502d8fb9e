/// What a page is packed with: numbers, triangles, attributes. Hostile bytes are hostile_test.cpp's.

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "hierarchy/triangle_codec.h"
#include "hierarchy/vertex_codec.h"
#include "ooc/triangle_order.h"
#include "tests/hierarchy/rewritten_file.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

TEST(Numbers, a_class_and_the_bits_it_leaves_open) {
  NumberWriter writer(1);
  writer.put(0, 15);
  writer.put(0, 100);
  writer.put(0, 16);
  const auto planes = writer.take();
  EXPECT_EQ(planes[0], (Plane{std::byte{15}, std::byte{21}, std::byte{16}}));
  EXPECT_EQ(planes[1], (Plane{std::byte{4}}));
}

TEST(Numbers, round_trip) {
  std::vector<std::int64_t> values{0, 1, -1, (std::int64_t{1} << 39) - 1, -(std::int64_t{1} << 39)};
  std::mt19937_64 random(3);
  for (int i = 0; i < 5000; ++i)
    values.push_back(static_cast<std::int64_t>(random()) >> (25 + random() % 39));
  NumberWriter writer(2);
  for (std::size_t i = 0; i < values.size(); ++i) writer.put_signed(i % 2, values[i]);
  const auto planes = writer.take();
  NumberReader reader(planes);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(reader.get_signed(i % 2), values[i]) << i;
  EXPECT_TRUE(reader.at_end());
  EXPECT_EQ(reader.get(0), 0u);
  EXPECT_FALSE(reader.ok());
}

TEST(Numbers, classes_that_are_none_and_missing_bits) {
  const std::vector<Plane> none{{std::byte{88}}, Plane(16)};
  NumberReader beyond(none);
  beyond.get(0);
  EXPECT_FALSE(beyond.ok());
  const std::vector<Plane> few{{std::byte{60}}, Plane(1)};
  NumberReader cut_off(few);
  cut_off.get(0);
  EXPECT_FALSE(cut_off.ok());
}

void expect_round_trip(Triangles triangles, std::uint32_t vertices) {
  for (auto& t : triangles) t = smallest_first(t);
  std::vector<Hint> hints, hints_again;
  const auto planes = pack_triangles(triangles, vertices, hints);
  Triangles again(triangles.size());
  ASSERT_TRUE(unpack_triangles(planes, vertices, again, hints_again));
  EXPECT_EQ(again, triangles);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    EXPECT_EQ(hints[v].a, hints_again[v].a);
    EXPECT_EQ(hints[v].b, hints_again[v].b);
    EXPECT_EQ(hints[v].across, hints_again[v].across);
  }
}

TEST(PackedTriangles, keep_any_order_and_any_numbers) {
  SurfaceMesh torus = bumpy_torus(40, 20);
  const auto vertices = static_cast<std::uint32_t>(torus.positions.size());
  expect_round_trip(torus.triangles, vertices);
  std::mt19937 random(4);
  std::vector<std::uint32_t> number(vertices);
  std::iota(number.begin(), number.end(), 0u);
  std::shuffle(number.begin(), number.end(), random);
  for (auto& t : torus.triangles) t = {number[t[0]], number[t[1]], number[t[2]]};
  expect_round_trip(torus.triangles, vertices);
  std::shuffle(torus.triangles.begin(), torus.triangles.end(), random);
  expect_round_trip(torus.triangles, vertices);
}

TEST(PackedTriangles, need_not_be_a_surface) {
  expect_round_trip({}, 0);
  std::mt19937 random(5);
  Triangles soup;
  while (soup.size() < 3000) {
    const auto any = [&] { return static_cast<std::uint32_t>(random() % 40); };
    const std::array<std::uint32_t, 3> t{any(), any(), any()};
    if (t[0] != t[1] && t[1] != t[2] && t[0] != t[2]) soup.push_back(t);
  }
  expect_round_trip(soup, 40);
}

TEST(PackedVertices, of_any_values) {
  std::mt19937 random(6);
  Page page;
  page.base = true;
  page.vertex_count = 300;
  for (std::uint32_t v = 0; v + 2 < page.vertex_count; ++v) page.triangles.push_back({v, v + 1, v + 2});
  page.wedge_tails = {7, 8, 200};
  const auto any = [&] { return static_cast<std::int32_t>(random()) >> (random() % 32); };
  for (std::uint32_t v = 0; v < page.vertex_count; ++v) {
    page.owned.positions.push_back({any(), any(), any()});
    page.owned.normals.push_back({static_cast<std::int16_t>(any()), static_cast<std::int16_t>(any())});
    page.owned.colours.push_back({static_cast<std::uint8_t>(any()), static_cast<std::uint8_t>(any()),
                                  static_cast<std::uint8_t>(any()), static_cast<std::uint8_t>(any())});
    page.owned.texcoords.push_back({any(), any()});
  }
  page.owned.positions[20] = {INT32_MIN, INT32_MAX, 0};
  page.owned.positions[21] = {INT32_MAX, INT32_MIN, INT32_MIN};
  const auto again = decode_page(encode_page(page), {});
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(again->owned.positions, page.owned.positions);
  EXPECT_EQ(again->owned.normals, page.owned.normals);
  EXPECT_EQ(again->owned.colours, page.owned.colours);
  EXPECT_EQ(again->owned.texcoords, page.owned.texcoords);
}

/// What snapping moved is at most half of any error but zero.
TEST(PositionError, at_most_half_of_the_smallest_error) {
  const TemporaryFolder folder;
  for (const NamedSurface& surface : surfaces()) {
    build_file(surface.make(), folder / "a.cuesta");
    const Contents contents = contents_of(folder / "a.cuesta");
    const Grid& grid = contents.directory.grid;
    for (const Page& page : contents.pages)
      for (const Child& c : page.script.children)
        EXPECT_TRUE(c.error == 0 ||
                    grid.snap_error() <= static_cast<double>(decode_error(c.error)) * grid.step / 2)
            << surface.name;
  }
}

}  // namespace
}  // namespace cuesta::test
