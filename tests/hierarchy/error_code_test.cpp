#include "hierarchy/error_code.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "ooc/grid.h"

namespace cuesta {
namespace {

TEST(ErrorCode8, decodes_exactly) {
  EXPECT_EQ(decode_error(0), 0.0f);
  for (int code = 1; code < 256; ++code)
    EXPECT_EQ(static_cast<double>(decode_error(static_cast<ErrorCode8>(code))),
              std::ldexp(8 + code % 8, code / 8 - 9));
}

TEST(ErrorCode8, monotone_in_steps_of_an_eighth) {
  EXPECT_LT(decode_error(0), decode_error(1));
  for (int code = 2; code < 256; ++code) {
    const float before = decode_error(static_cast<ErrorCode8>(code - 1));
    const float now = decode_error(static_cast<ErrorCode8>(code));
    EXPECT_LT(before, now);
    EXPECT_LE(now, before * 1.125f);
  }
}

TEST(ErrorCode8, rounds_up_to_the_smallest) {
  for (int code = least_error_code; code < 255; ++code) {
    const auto c = static_cast<ErrorCode8>(code);
    EXPECT_EQ(encode_error_up(decode_error(c)), c);
    EXPECT_EQ(encode_error_up(std::nextafter(decode_error(c), 1e30f)), c + 1);
    EXPECT_EQ(encode_error_up(std::nextafter(decode_error(c), 0.0f)), c);
  }
  EXPECT_EQ(encode_error_up(0), 0);
  EXPECT_EQ(encode_error_up(1e30f), 255);
}

TEST(ErrorCode8, least_is_twice_the_snapping_error) {
  const Grid grid{{}, 1};
  EXPECT_GE(static_cast<double>(decode_error(least_error_code)), 2 * grid.snap_error());
  EXPECT_LT(static_cast<double>(decode_error(least_error_code - 1)), 2 * grid.snap_error());
  for (float error : {1e-30f, 0.1f, 1.0f, decode_error(least_error_code)})
    EXPECT_EQ(encode_error_up(error), least_error_code) << error;
}

TEST(SphereRadius, rounds_up_and_keeps_order) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> exponent(-10, 25);
  for (int i = 0; i < 2000; ++i) {
    const float r = std::exp2(exponent(random));
    const std::uint16_t code = encode_radius_up(r);
    EXPECT_GE(decode_radius(code), r);
    EXPECT_LE(decode_radius(code), r * (1 + 1.0f / 128));
    EXPECT_EQ(encode_radius_up(decode_radius(code)), code);
  }
}

/// contains() promises this of the distances as evaluated.
TEST(Contains, no_eye_is_farther_from_the_outer_ball) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> at(-1000, 1000), share(0, 1);
  for (int i = 0; i < 20000; ++i) {
    const Sphere outer{{at(random), at(random), at(random)}, 300 * share(random)};
    Sphere inner{outer.centre + Vec3f{at(random), at(random), at(random)} * (0.1f * share(random)), 0};
    inner.radius = std::max(0.0f, outer.radius - length(inner.centre - outer.centre));
    if (!contains(outer, inner)) continue;
    const Vec3d eye{at(random), at(random), at(random)};
    const double to_outer = length(eye - vec_cast<double>(outer.centre)) - static_cast<double>(outer.radius);
    const double to_inner = length(eye - vec_cast<double>(inner.centre)) - static_cast<double>(inner.radius);
    EXPECT_LE(to_outer, to_inner);
  }
}

}  // namespace
}  // namespace cuesta
