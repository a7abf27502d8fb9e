#include "tools/terrain_generator/fractal_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tools/scan_generator/random.h"

namespace cuesta::tools {
namespace {

struct Gradient {
  double x = 0, y = 0;
};

constexpr double diagonal = 0.70710678118654752;
constexpr std::array<Gradient, 8> gradients{{{1, 0},
                                             {diagonal, diagonal},
                                             {0, 1},
                                             {-diagonal, diagonal},
                                             {-1, 0},
                                             {-diagonal, -diagonal},
                                             {0, -1},
                                             {diagonal, -diagonal}}};
constexpr double to_unit = 1.4142135623730951;  // the largest value of noise with unit gradients is √½
constexpr double mean_ridge = 0.3;              // of |noise|, about

Gradient gradient_at(double x, double y, std::uint64_t seed) {
  const auto whole = [](double v) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)); };
  return gradients[mixed(whole(x) * 0x9e3779b97f4a7c15ull + whole(y) * 0xc2b2ae3d27d4eb4full + seed) >> 61];
}

double fade(double t) {
  return t * t * t * (t * (t * 6 - 15) + 10);
}

}  // namespace

void gradient_noise_row(std::span<double> out, std::uint64_t row, double wavelength, std::uint64_t seed) {
  const double shift_x = unit_interval(mixed(seed + 1)), shift_y = unit_interval(mixed(seed + 2));
  const double y = static_cast<double>(row) / wavelength + shift_y, cell_y = std::floor(y);
  const double v = y - cell_y, fade_v = fade(v);
  double cell_x = -2;        // none yet
  Gradient near[2], far[2];  // of the cell's left side and its right one, upper and lower
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double x = static_cast<double>(i) / wavelength + shift_x;
    if (const double cell = std::floor(x); cell != cell_x) {
      for (const int k : {0, 1}) {
        near[k] = cell == cell_x + 1 ? far[k] : gradient_at(cell, cell_y + k, seed);
        far[k] = gradient_at(cell + 1, cell_y + k, seed);
      }
      cell_x = cell;
    }
    const double u = x - cell_x, fade_u = fade(u);
    const double upper = near[0].x * u + near[0].y * v, upper_far = far[0].x * (u - 1) + far[0].y * v;
    const double lower = near[1].x * u + near[1].y * (v - 1),
                 lower_far = far[1].x * (u - 1) + far[1].y * (v - 1);
    const double above = upper + fade_u * (upper_far - upper), below = lower + fade_u * (lower_far - lower);
    out[i] = to_unit * (above + fade_v * (below - above));
  }
}

void fractal_row(std::span<double> out, std::uint64_t row, double wavelength, double shortest,
                 std::uint64_t seed) {
  std::fill(out.begin(), out.end(), 0.0);
  std::vector<double> noise(out.size());
  double amplitude = 1;
  for (std::uint64_t octave = 0; wavelength >= shortest; ++octave, wavelength /= 2, amplitude /= 2) {
    gradient_noise_row(noise, row, wavelength, mixed(seed * 1000 + octave));
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] += amplitude * (0.5 * noise[i] + 0.5 * (mean_ridge - std::abs(noise[i])));
  }
}

}  // namespace cuesta::tools
