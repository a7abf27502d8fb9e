#include "runtime/power.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace cuesta::test {
namespace {

TEST(VectorPower, IsWithinItsError) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> logarithm(-120, 120), exponent(0.1, 1);
  double worst = 0;
  for (int i = 0; i < 200'000; ++i) {
    const double x = std::exp2(logarithm(random)), e = exponent(random), exact = std::pow(x, e);
    worst = std::max(worst, std::abs(vector_power(x, e) - exact) / exact);
  }
  EXPECT_LT(worst, vector_power_error);
  EXPECT_GT(worst, vector_power_error / 20);
}

TEST(VectorPower, ExactWhereNothingIsToBeRounded) {
  for (const double e : {0.25, 0.5, 1.0, 2.0}) EXPECT_EQ(vector_power(1, e), 1);
  EXPECT_EQ(vector_power(16, 0.5), 4);
  EXPECT_EQ(vector_power(0x1p-40, 0.25), 0x1p-10);
}

TEST(VectorPower, TakesZeroAndInfinityIntoItsRange) {
  EXPECT_EQ(vector_power(0, 0.5), 0x1p-60);
  EXPECT_EQ(vector_power(std::numeric_limits<double>::infinity(), 0.5), 0x1p60);
}

}  // namespace
}  // namespace cuesta::test
