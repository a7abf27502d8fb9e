/// Segments of a TOM: what they decode to, and that hostile ones are refused.

#include <gtest/gtest.h>

#include <random>

#include "hierarchy/build_tom.h"
#include "hierarchy/tom_codec.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {
namespace {

using Bytes = std::vector<std::byte>;

void expect_same(const Tom& a, const Tom& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.colours, b.colours);
  EXPECT_EQ(a.texcoords, b.texcoords);
  EXPECT_EQ(a.substitute, b.substitute);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.errors, b.errors);
  EXPECT_EQ(a.snap_error, b.snap_error);
  EXPECT_EQ(a.base_vertices, b.base_vertices);
  EXPECT_EQ(a.bounds.lo, b.bounds.lo);
  EXPECT_EQ(a.bounds.hi, b.bounds.hi);
}

SurfaceMesh coloured_vase() {
  SurfaceMesh mesh = seamed_vase(24, 20);
  for (const Vec3d& p : mesh.positions) {
    mesh.normals.push_back(vec_cast<float>(normalized(Vec3d{p.x, p.y, 0.1})));
    mesh.colours.push_back({static_cast<std::uint8_t>(p.z * 80), 10, 200, 255});
  }
  return mesh;
}

std::vector<Tom> toms() {
  std::vector<Tom> all;
  for (const NamedSurface& s : surfaces()) all.push_back(*build_tom(s.make()));
  all.push_back(*build_tom(coloured_vase()));
  all.push_back(*build_tom(pebbles(), {.oracle = TomOracle::pairs, .pair_threshold = 0.5}));
  return all;
}

TEST(TomCodec, a_prefix_of_segments_is_the_tom_up_to_there) {
  for (const Tom& tom : toms()) {
    Tom read;
    Resolution from = 0;
    for (const Resolution to : segment_resolutions(tom, 16, 2)) {
      const auto done = decode_tom_segment(encode_tom_segment(tom, from, to), read);
      ASSERT_TRUE(done) << done.error().text();
      EXPECT_TRUE(is_consistent(read));
      expect_same(read, tom_prefix(tom, to));
      from = to;
    }
    expect_same(read, tom);
  }
}

TEST(TomCodec, a_prefix_is_the_whole_at_its_resolutions) {
  const Tom tom = *build_tom(faceted_cube(9));
  const Tom part = tom_prefix(tom, whole_resolution(tom, 100));
  for (Resolution n = tom.base_vertices; n <= part.full(); ++n) {
    auto a = surface_at(part, n), b = surface_at(tom, n);
    for (auto* mesh : {&a, &b})
      for (Triangle& t : mesh->triangles) t = smallest_first(t);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(error_at(part, n), error_at(tom, n));
  }
}

TEST(TomCodec, cut_off_at_every_byte) {
  const Tom tom = *build_tom(coloured_vase());
  const Bytes first = encode_tom_segment(tom, 0, 100), second = encode_tom_segment(tom, 100, tom.full());
  Tom read;
  for (std::size_t n = 0; n < first.size(); ++n)
    EXPECT_FALSE(decode_tom_segment(std::span(first).first(n), read)) << n;
  EXPECT_EQ(read.full(), 0u);
  ASSERT_TRUE(decode_tom_segment(first, read));
  for (std::size_t n = 0; n < second.size(); ++n)
    EXPECT_FALSE(decode_tom_segment(std::span(second).first(n), read)) << n;
  expect_same(read, tom_prefix(tom, 100));  // as it was
}

TEST(TomCodec, bit_flips_give_an_error_or_a_consistent_tom) {
  const Tom tom = *build_tom(coloured_vase());
  const Bytes first = encode_tom_segment(tom, 0, 100), second = encode_tom_segment(tom, 100, 200);
  std::size_t refused = 0;
  for (std::size_t bit = 0; bit < (first.size() + second.size()) * 8; ++bit) {
    Bytes a = first, b = second;
    Bytes& hit = bit / 8 < a.size() ? a : b;
    hit[bit / 8 < a.size() ? bit / 8 : bit / 8 - a.size()] ^= static_cast<std::byte>(1 << bit % 8);
    Tom read;
    const bool ok = decode_tom_segment(a, read) && decode_tom_segment(b, read);
    refused += !ok;
    ASSERT_TRUE(read.full() == 0 || is_consistent(read)) << bit;
  }
  EXPECT_GT(refused, first.size());
}

TEST(TomCodec, segments_out_of_order_are_refused) {
  const Tom tom = *build_tom(bumpy_sphere(8));
  const Bytes first = encode_tom_segment(tom, 0, 50), third = encode_tom_segment(tom, 100, tom.full());
  Tom read;
  EXPECT_FALSE(decode_tom_segment(third, read));
  ASSERT_TRUE(decode_tom_segment(first, read));
  const auto again = decode_tom_segment(first, read);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::invalid_input);
  EXPECT_FALSE(decode_tom_segment(third, read));
}

TEST(TomCodec, another_version_is_refused) {
  const Tom tom = *build_tom(bumpy_sphere(4));
  Bytes bytes = encode_tom_segment(tom, 0, tom.full());
  bytes[0] = std::byte{99};
  Tom read;
  const auto done = decode_tom_segment(bytes, read);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::unsupported_version);
}

TEST(TomCodec, segment_resolutions_are_whole_and_rise) {
  const Tom tom = *build_tom(faceted_cube(20));
  const auto all = segment_resolutions(tom, 64, 3);
  ASSERT_GT(all.size(), 2u);
  EXPECT_EQ(all.back(), tom.full());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(whole_resolution(tom, all[i]), all[i]);
    EXPECT_TRUE(i == 0 || all[i] > all[i - 1]);
  }
  EXPECT_EQ(segment_resolutions(*build_tom(tetrahedron())).size(), 1u);
  EXPECT_TRUE(segment_resolutions(Tom{}).empty());
}

}  // namespace
}  // namespace cuesta::test
