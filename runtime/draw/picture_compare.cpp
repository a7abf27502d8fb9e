#include "runtime/draw/picture_compare.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr int window_px = 8;
constexpr int window_stride_px = 4;
constexpr double ssim_c1 = (0.01 * 255) * (0.01 * 255);
constexpr double ssim_c2 = (0.03 * 255) * (0.03 * 255);

/// Rec. 709 luma of the sRGB-coded values, 0…255.
std::vector<double> luma(const Picture& picture) {
  std::vector<double> values;
  values.reserve(picture.pixels.size());
  for (const Rgba8& p : picture.pixels) values.push_back(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]);
  return values;
}

struct Moments {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;

  void add(double x, double y) {
    a += x;
    b += y;
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  double ssim(double count) const {
    const double mean_a = a / count;
    const double mean_b = b / count;
    const double var_a = aa / count - mean_a * mean_a;
    const double var_b = bb / count - mean_b * mean_b;
    const double covariance = ab / count - mean_a * mean_b;
    return (2 * mean_a * mean_b + ssim_c1) * (2 * covariance + ssim_c2) /
           ((mean_a * mean_a + mean_b * mean_b + ssim_c1) * (var_a + var_b + ssim_c2));
  }
};

double mean_ssim(const Picture& first, const Picture& second) {
  const std::vector<double> a = luma(first);
  const std::vector<double> b = luma(second);
  const int width = std::min(window_px, first.width_px);
  const int height = std::min(window_px, first.height_px);
  double sum = 0;
  int windows = 0;
  for (int y0 = 0; y0 + height <= first.height_px; y0 += window_stride_px)
    for (int x0 = 0; x0 + width <= first.width_px; x0 += window_stride_px, ++windows) {
      Moments moments;
      for (int y = y0; y < y0 + height; ++y)
        for (int x = x0; x < x0 + width; ++x) {
          const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(first.width_px) +
                                static_cast<std::size_t>(x);
          moments.add(a[i], b[i]);
        }
      sum += moments.ssim(width * height);
    }
  return sum / windows;
}

}  // namespace

double PictureDifference::fraction_within(int tolerance) const {
  const auto begin = pixels_by_difference.begin();
  const double all =
      static_cast<double>(std::accumulate(begin, pixels_by_difference.end(), std::uint64_t{0}));
  const int bins = std::clamp(tolerance + 1, 0, 256);
  return static_cast<double>(std::accumulate(begin, begin + bins, std::uint64_t{0})) / all;
}

PictureDifference compare(const Picture& a, const Picture& b) {
  CUESTA_CHECK(a.width_px == b.width_px && a.height_px == b.height_px, a.width_px, b.width_px, a.height_px,
               b.height_px);
  CUESTA_CHECK(!a.pixels.empty() && a.pixels.size() == b.pixels.size(), a.pixels.size(), b.pixels.size());
  PictureDifference result;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    int largest = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      const int difference = std::abs(a.pixels[i][c] - b.pixels[i][c]);
      largest = std::max(largest, difference);
      sum += static_cast<std::uint64_t>(difference);
    }
    ++result.pixels_by_difference[static_cast<std::size_t>(largest)];
    result.max_channel = std::max(result.max_channel, largest);
  }
  result.mean_channel = static_cast<double>(sum) / (4.0 * static_cast<double>(a.pixels.size()));
  result.ssim = mean_ssim(a, b);
  return result;
}

}  // namespace cuesta
