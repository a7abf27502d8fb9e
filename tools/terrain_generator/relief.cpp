#include "tools/terrain_generator/relief.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "tools/terrain_generator/fractal_rows.h"

namespace cuesta::tools {
namespace {

/// Of the four postings around t in [0, 1] between the second and the third.
struct Weights {
  std::array<double, 4> value, slope;
};

/// Source: Catmull, Rom, "A class of local interpolating splines", 1974; uniform, tension 1/2.
Weights catmull_rom(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {
      {(-t3 + 2 * t2 - t) / 2, (3 * t3 - 5 * t2 + 2) / 2, (-3 * t3 + 4 * t2 + t) / 2, (t3 - t2) / 2},
      {(-3 * t2 + 4 * t - 1) / 2, (9 * t2 - 10 * t) / 2, (-9 * t2 + 8 * t + 1) / 2, (3 * t2 - 2 * t) / 2}};
}

/// The posting at or before x, at most the last but one.
std::uint64_t posting_before(double x, std::uint64_t side) {
  return std::min(static_cast<std::uint64_t>(x), side - 2);
}

double blend(const std::array<double, 4>& weights, const double* p, const std::array<std::uint64_t, 4>& at) {
  return weights[0] * p[at[0]] + weights[1] * p[at[1]] + weights[2] * p[at[2]] + weights[3] * p[at[3]];
}

/// Numbers i - 1 to i + 2, kept in [0, side).
std::array<std::uint64_t, 4> around(std::uint64_t i, std::uint64_t side) {
  return {i > 0 ? i - 1 : 0, i, i + 1, std::min(i + 2, side - 1)};
}

/// The last row first.
void turn_rows(std::span<double> heights_m, std::uint64_t width) {
  const std::uint64_t rows = heights_m.size() / width;
  for (std::uint64_t r = 0; r < rows / 2; ++r)
    std::swap_ranges(heights_m.begin() + static_cast<std::ptrdiff_t>(r * width),
                     heights_m.begin() + static_cast<std::ptrdiff_t>((r + 1) * width),
                     heights_m.begin() + static_cast<std::ptrdiff_t>((rows - 1 - r) * width));
}

}  // namespace

Result<Relief> relief_of(std::shared_ptr<const HeightRaster> raster, std::optional<Square> square) {
  const RasterInfo& info = raster->info();
  const std::uint64_t most = std::min(info.width, info.height);
  const Square s = square.value_or(Square{(info.width - most) / 2, (info.height - most) / 2, most});
  if (s.side < 2 || s.side > most || s.column > info.width - s.side || s.row > info.height - s.side)
    return fail(ErrorCode::invalid_input, info.files.front(), "",
                "a relief needs a square of two rows and columns at least in these " +
                    std::to_string(info.width) + " x " + std::to_string(info.height) + " postings");
  const bool southern_first = info.map.y_per_row > 0;
  return Relief{s.side, [=](std::uint64_t first, std::span<double> heights_m) -> Result<void> {
                  const std::uint64_t rows = heights_m.size() / s.side, height = raster->info().height;
                  Window window{s.column, s.row + first, s.side, rows};
                  if (southern_first) window.row = height - window.row - rows;
                  if (auto r = raster->read(window, heights_m); !r) return r;
                  if (southern_first) turn_rows(heights_m, s.side);
                  std::replace_if(
                      heights_m.begin(), heights_m.end(), [](double h) { return std::isnan(h); }, 0.0);
                  return {};
                }};
}

Relief made_up_relief(std::uint64_t side, std::uint64_t seed) {
  return {side, [=](std::uint64_t first, std::span<double> heights_m) -> Result<void> {
            for (std::size_t r = 0; r < heights_m.size() / side; ++r) {
              const auto row = heights_m.subspan(r * side, side);
              fractal_row(row, first + r, std::max(2.0, static_cast<double>(side) / 3), 2, seed);
              for (double& h : row) h = 1000 + 1500 * h;
            }
            return {};
          }};
}

Result<ReliefRows> ReliefRows::read(const Relief& relief, double from_row, double to_row) {
  ReliefRows rows;
  rows.side_ = relief.side;
  rows.first_ = around(posting_before(from_row, relief.side), relief.side).front();
  rows.end_ = around(posting_before(to_row, relief.side), relief.side).back() + 1;
  rows.heights_m_.resize((rows.end_ - rows.first_) * relief.side);
  if (auto r = relief.read(rows.first_, rows.heights_m_); !r) return fail(r.error());
  return rows;
}

void ReliefRows::interpolate(double row, double step, std::span<double> heights_m,
                             std::span<double> slopes) const {
  const std::uint64_t above = posting_before(row, side_);
  const Weights down = catmull_rom(row - static_cast<double>(above));
  auto rows = around(above, side_);
  for (std::uint64_t& r : rows) r = (r - first_) * side_;
  std::vector<double> values(side_),
      rises(side_);  // of the relief's columns at `row`, and their change downwards
  for (std::uint64_t c = 0; c < side_; ++c) {
    values[c] = blend(down.value, heights_m_.data() + c, rows);
    rises[c] = blend(down.slope, heights_m_.data() + c, rows);
  }
  for (std::size_t i = 0; i < heights_m.size(); ++i) {
    const double column = static_cast<double>(i) * step;
    const std::uint64_t left = posting_before(column, side_);
    const Weights right = catmull_rom(column - static_cast<double>(left));
    const auto columns = around(left, side_);
    heights_m[i] = blend(right.value, values.data(), columns);
    const double dx = blend(right.slope, values.data(), columns),
                 dy = blend(right.value, rises.data(), columns);
    slopes[i] = std::sqrt(dx * dx + dy * dy);
  }
}

}  // namespace cuesta::tools
