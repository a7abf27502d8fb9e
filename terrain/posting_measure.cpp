#include "terrain/posting_measure.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <mutex>
#include <optional>

namespace cuesta {
namespace {

/// Postings by which a footprint is larger than the image of the triangle's corners and edges says.
constexpr double footprint_margin = 0.5;
/// Edges are straight on a lattice to within this, in postings, or cut until they are.
constexpr double most_bulge = 0.25;
constexpr int most_cuts = 12;
/// Nearer to a pole than this a footprint goes all around.
constexpr double polar_latitude_deg = 88;

/// Runs of columns by row that cover a polygon.
class FootprintBuilder {
 public:
  FootprintBuilder(std::int64_t first_row, std::int64_t last_row) : first_row_(first_row) {
    const auto rows = static_cast<std::size_t>(std::max<std::int64_t>(0, last_row - first_row + 1));
    lo_.assign(rows, 1e300);
    hi_.assign(rows, -1e300);
  }

  void add_edge(LatticePoint a, LatticePoint b) {
    if (a.row > b.row) std::swap(a, b);
    const double top = a.row - footprint_margin, bottom = b.row + footprint_margin;
    const auto first = std::max<std::int64_t>(first_row_, static_cast<std::int64_t>(std::ceil(top)));
    const auto last = std::min<std::int64_t>(first_row_ + static_cast<std::int64_t>(lo_.size()) - 1,
                                             static_cast<std::int64_t>(std::floor(bottom)));
    const double rise = b.row - a.row;
    for (std::int64_t r = first; r <= last; ++r) {
      // The part of the edge that is within the margin of the row.
      const auto at = [&](double row) {
        const double t = rise > 0 ? std::clamp((row - a.row) / rise, 0.0, 1.0) : 0.0;
        return a.column + t * (b.column - a.column);
      };
      const double row = static_cast<double>(r);
      const double c0 = rise > 0 ? at(row - footprint_margin) : a.column;
      const double c1 = rise > 0 ? at(row + footprint_margin) : b.column;
      const auto i = static_cast<std::size_t>(r - first_row_);
      lo_[i] = std::min(lo_[i], std::min(c0, c1));
      hi_[i] = std::max(hi_[i], std::max(c0, c1));
    }
  }

  LatticeFootprint take() const {
    LatticeFootprint f;
    f.first_row = first_row_;
    for (std::size_t i = 0; i < lo_.size(); ++i)
      f.columns.push_back(lo_[i] > hi_[i]
                              ? std::array<std::int64_t, 2>{0, -1}
                              : std::array{static_cast<std::int64_t>(std::ceil(lo_[i] - footprint_margin)),
                                           static_cast<std::int64_t>(std::floor(hi_[i] + footprint_margin))});
    return f;
  }

 private:
  std::int64_t first_row_;
  std::vector<double> lo_, hi_;
};

/// A triangle and the verticals through it, in f64 about a square's first posting.
struct MeasuredTriangle {
  Vec3d a, ab, ac, normal;  // the normal is twice the area long
};

/// The largest vertical distance of n points in a row whose verticals go through the triangle.
double most_distance(const MeasuredTriangle& t, const Vertical& vertical, const Vec3d* points,
                     std::size_t n) {
  double most = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d p = points[i];
    const Vec3d up = vertical.direction(p), q = p - t.a, m = cross(q, up);
    const double upright = dot(up, t.normal);
    const double b = -dot(m, t.ac), c = dot(m, t.ab);
    // Points without a height are NaN, and inside of nothing.
    const double rounding = 1e-9 * upright;
    if (!(b >= -rounding && c >= -rounding && b + c <= upright + rounding && upright > 0)) continue;
    const double h = std::abs(dot(q, t.normal)) / upright;
    most = std::max(most, vertical.is_plane ? h : h * length(up));
  }
  return most;
}

/// The image of a triangle's edges on a lattice, cut where they bend.
class EdgeImage {
 public:
  EdgeImage(const PostingPositions& lattice, const std::array<Vec3d, 3>& corners_m) : lattice_(lattice) {
    std::array<LatticePoint, 3> at;
    for (std::size_t k = 0; k < 3; ++k) {
      at[k] = lattice.lattice_point(corners_m[k], k == 0 ? 0 : at[0].column);
      if (!std::isfinite(at[k].column) || !std::isfinite(at[k].row)) return;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      cut(at[k], corners_m[k], at[next], corners_m[next], most_cuts);
    }
    for (const auto& [a, b] : edges)
      for (const LatticePoint& p : {a, b}) {
        top = std::min(top, p.row);
        bottom = std::max(bottom, p.row);
        west = std::min(west, p.column);
        east = std::max(east, p.column);
      }
  }

  std::vector<std::pair<LatticePoint, LatticePoint>> edges;  ///< none if a corner has no place on the lattice
  double top = 1e300, bottom = -1e300, west = 1e300, east = -1e300;

 private:
  void cut(LatticePoint a, Vec3d a_m, LatticePoint b, Vec3d b_m, int cuts) {
    const double apart = std::max(std::abs(a.column - b.column), std::abs(a.row - b.row));
    if (lattice_.is_straight() || apart <= 2 || cuts == 0) {
      edges.emplace_back(a, b);
      return;
    }
    const Vec3d middle_m = (a_m + b_m) * 0.5;
    const LatticePoint middle = lattice_.lattice_point(middle_m, a.column);
    const double bulge = std::max(std::abs(middle.column - (a.column + b.column) / 2),
                                  std::abs(middle.row - (a.row + b.row) / 2));
    const int left = bulge <= most_bulge ? 0 : cuts - 1;
    cut(a, a_m, middle, middle_m, left);
    cut(middle, middle_m, b, b_m, left);
  }

  const PostingPositions& lattice_;
};

/// All columns of some rows, which go to the nearer pole.
LatticeFootprint polar_footprint(const EdgeImage& image, std::int64_t width, std::int64_t height) {
  const bool north = (image.top + image.bottom) / 2 < static_cast<double>(height) / 2;
  LatticeFootprint f;
  f.first_row = north ? 0 : std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor(image.top - 1)));
  const std::int64_t end =
      north ? std::min<std::int64_t>(height, static_cast<std::int64_t>(std::ceil(image.bottom + 2))) : height;
  f.columns.assign(static_cast<std::size_t>(std::max<std::int64_t>(0, end - f.first_row)), {0, width - 1});
  return f;
}

}  // namespace

LatticeFootprint PostingMeasure::footprint(std::uint32_t layer, const std::array<Vec3d, 3>& corners_m) const {
  const PostingPositions& lattice = surface_.positions_[layer];
  const auto height = static_cast<std::int64_t>(surface_.layers_[layer].height);
  const EdgeImage image(lattice, corners_m);
  if (image.edges.empty()) return {};
  if (const double around = lattice.columns_around(); around > 0 && !lattice.is_straight()) {
    const auto is_polar = [&](Vec3d p) {
      return std::abs(surface_.frame_.geodetic(p).lat_deg) > polar_latitude_deg;
    };
    if (image.east - image.west > around / 2 - 1 || std::any_of(corners_m.begin(), corners_m.end(), is_polar))
      return polar_footprint(image, static_cast<std::int64_t>(surface_.layers_[layer].width), height);
  }
  const auto first =
      std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil(image.top - footprint_margin)));
  const auto last = std::min<std::int64_t>(
      height - 1, static_cast<std::int64_t>(std::floor(image.bottom + footprint_margin)));
  FootprintBuilder builder(first, last);
  for (const auto& [a, b] : image.edges) builder.add_edge(a, b);
  return builder.take();
}

/// The part of a run of columns that a layer has, which begins with column 0; a lattice on the globe may have
/// it one turn farther on.
std::array<std::int64_t, 2> PostingMeasure::columns_in_layer(std::uint32_t layer,
                                                             std::array<std::int64_t, 2> columns) const {
  auto [first, last] = columns;
  const LatticeSquares::Extent& extent = surface_.store_.squares().extent(layer);
  const auto width = static_cast<std::int64_t>(extent.width);
  if (extent.closes) return last - first >= width ? std::array<std::int64_t, 2>{0, width - 1} : columns;
  const auto around = static_cast<std::int64_t>(std::llround(surface_.positions_[layer].columns_around()));
  const std::int64_t turn = around > 0 && first >= width ? -around : around > 0 && last < 0 ? around : 0;
  return {std::max<std::int64_t>(first + turn, 0), std::min<std::int64_t>(last + turn, width - 1)};
}

/// Cuts a footprint at the sides of squares.
void PostingMeasure::add_runs(std::uint32_t triangle, std::uint32_t layer, const LatticeFootprint& footprint,
                              std::vector<PlacedRun>& runs) const {
  const LatticeSquares& squares = surface_.store_.squares();
  const auto width = static_cast<std::int64_t>(squares.extent(layer).width);
  for (std::size_t i = 0; i < footprint.columns.size(); ++i) {
    const auto row = static_cast<std::uint64_t>(footprint.first_row + static_cast<std::int64_t>(i));
    if (footprint.columns[i][0] > footprint.columns[i][1]) continue;
    const auto [first, last] = columns_in_layer(layer, footprint.columns[i]);
    for (std::int64_t c = first; c <= last;) {
      const auto column = static_cast<std::uint64_t>((c % width + width) % width);
      const std::uint64_t number = squares.number_at(layer, column, row);
      const LatticeSquare square = squares.square(number);
      const auto in_square = static_cast<std::uint32_t>(column - square.column);
      const std::int64_t left = std::min<std::int64_t>(last - c, square.width - in_square - std::int64_t{1});
      if (surface_.store_.chunk_of(number) != no_chunk)
        runs.push_back({number,
                        {triangle, static_cast<std::uint32_t>(row - square.row), in_square,
                         in_square + static_cast<std::uint32_t>(left)}});
      c += left + 1;
    }
  }
}

std::vector<PostingMeasure::SquareRuns> PostingMeasure::runs_of(
    std::span<const std::array<Vec3i, 3>> triangles) const {
  constexpr std::size_t part_size = 256;
  std::vector<std::vector<PlacedRun>> parts((triangles.size() + part_size - 1) / part_size);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    for (std::size_t t = part * part_size; t < std::min(triangles.size(), (part + 1) * part_size); ++t) {
      const auto& [a, b, c] = triangles[t];
      const std::array corners_m{surface_.grid.world(a), surface_.grid.world(b), surface_.grid.world(c)};
      for (std::uint32_t layer = 0; layer < surface_.layers_.size(); ++layer)
        add_runs(static_cast<std::uint32_t>(t), layer, footprint(layer, corners_m), parts[part]);
    }
  });
  std::vector<PlacedRun> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  std::stable_sort(all.begin(), all.end(),
                   [](const PlacedRun& a, const PlacedRun& b) { return a.square < b.square; });
  std::vector<SquareRuns> out;
  for (const PlacedRun& p : all) {
    if (out.empty() || out.back().square != p.square) out.push_back({p.square, {}});
    out.back().runs.push_back(p.run);
  }
  return out;
}

Result<void> PostingMeasure::measure_square(const SquareRuns& square,
                                            std::span<const std::array<Vec3i, 3>> triangles,
                                            std::span<float> distances) const {
  const LatticeSquare at = surface_.store_.squares().square(square.square);
  std::uint32_t first_row = at.height, last_row = 0;
  for (const Run& r : square.runs) {
    first_row = std::min(first_row, r.row);
    last_row = std::max(last_row, r.row);
  }
  // The rows that are asked for, as the vertices are: snapped to the grid. About the first corner of the
  // first triangle.
  const std::uint64_t rows = last_row - first_row + 1;
  std::vector<float> heights_m(rows * at.width);
  const auto column = static_cast<std::int64_t>(at.column),
             row = static_cast<std::int64_t>(at.row + first_row);
  if (auto r = surface_.store_.read(at.layer, column, row, at.width, rows, heights_m); !r) return r;
  std::vector<Vec3d> points(heights_m.size());
  surface_.positions_[at.layer].of(column, row, at.width, rows, heights_m, points);
  for (Vec3d& p : points)
    if (std::isfinite(p.x)) p = vec_cast<double>(surface_.grid.snap(p));
  const Vertical& vertical = *surface_.vertical;
  std::uint32_t known = ~0u;
  MeasuredTriangle t;
  for (const Run& r : square.runs) {
    if (r.triangle != known) {
      known = r.triangle;
      const auto& corners = triangles[known];
      t.a = vec_cast<double>(corners[0]);
      t.ab = vec_cast<double>(corners[1]) - t.a;
      t.ac = vec_cast<double>(corners[2]) - t.a;
      t.normal = cross(t.ab, t.ac);
    }
    const double most = most_distance(t, vertical, points.data() + (r.row - first_row) * at.width + r.first,
                                      std::size_t{r.last} - r.first + 1);
    float bound = static_cast<float>(most);
    if (static_cast<double>(bound) < most) bound = std::nextafter(bound, 1e30f);
    // Not negative: bits are in order.
    std::atomic_ref<float> out(distances[r.triangle]);
    for (float before = out.load(); before < bound && !out.compare_exchange_weak(before, bound);) {
    }
  }
  return {};
}

Result<void> PostingMeasure::measure(std::span<const std::array<Vec3i, 3>> triangles,
                                     std::span<float> distances) const {
  std::fill(distances.begin(), distances.end(), 0.0f);
  const std::vector<SquareRuns> squares = runs_of(triangles);
  std::mutex mutex;
  std::optional<Error> error;
  tbb::parallel_for(std::size_t{0}, squares.size(), [&](std::size_t i) {
    auto r = measure_square(squares[i], triangles, distances);
    if (r) return;
    const std::lock_guard lock(mutex);
    if (!error) error = std::move(r).error();
  });
  if (error) return fail(std::move(*error));
  return {};
}

}  // namespace cuesta
