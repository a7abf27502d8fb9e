#include "terrain/posting_measure.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "ooc/ordered_tasks.h"

namespace cuesta {
namespace {

/// So many runs are placed at once, some 50 bytes each. Triangles of a base page are as large as the terrain:
/// all of their runs would be gigabytes.
constexpr std::uint64_t most_runs = std::uint64_t{1} << 19;

/// A triangle and the verticals through it.
struct MeasuredTriangle {
  Vec3d a, ab, ac, normal;  // the normal is twice the area long
};

MeasuredTriangle measured(const std::array<Vec3i, 3>& corners) {
  MeasuredTriangle t;
  t.a = vec_cast<double>(corners[0]);
  t.ab = vec_cast<double>(corners[1]) - t.a;
  t.ac = vec_cast<double>(corners[2]) - t.a;
  t.normal = cross(t.ab, t.ac);
  return t;
}

/// The distance of the triangle along the vertical of p; < 0 where that passes it, or p has no height.
double distance_along(const MeasuredTriangle& t, const Vertical& vertical, Vec3d p) {
  const Vec3d up = vertical.direction(p), q = p - t.a, m = cross(q, up);
  const double upright = dot(up, t.normal);
  const double b = -dot(m, t.ac), c = dot(m, t.ab);
  const double rounding = 1e-9 * upright;
  if (!(b >= -rounding && c >= -rounding && b + c <= upright + rounding && upright > 0)) return -1;
  const double h = std::abs(dot(q, t.normal)) / upright;
  return vertical.is_plane ? h : h * length(up);
}

/// To the next f32 that is not less.
float rounded_up(double distance) {
  const auto bound = static_cast<float>(distance);
  return static_cast<double>(bound) < distance ? std::nextafter(bound, 1e30f) : bound;
}

}  // namespace

PostingMeasure::PostingMeasure(const TerrainSurface& surface) : surface_(surface) {
  for (std::size_t l = 0; l < surface.layers_.size(); ++l)
    footprints_.emplace_back(surface.frame_, surface.layers_[l], surface.positions_[l]);
}

void PostingMeasure::place(std::uint32_t triangle, std::uint32_t layer, const LatticeRun& run,
                           std::vector<Placed>& out) const {
  const LatticeSquares& squares = surface_.store_.squares();
  for (std::uint64_t first = run.first; first <= run.last;) {
    const std::uint64_t number = squares.number_at(layer, first, run.row);
    const LatticeSquare square = squares.square(number);
    const std::uint64_t last = std::min(run.last, square.column + square.width - 1);
    if (surface_.store_.chunk_of(number) != no_chunk)
      out.push_back({number,
                     {triangle, static_cast<std::uint32_t>(run.row - square.row),
                      static_cast<std::uint32_t>(first - square.column),
                      static_cast<std::uint32_t>(last - square.column)}});
    first = last + 1;
  }
}

/// visit(layer, run of postings) over the triangle.
template <class Visit>
void PostingMeasure::visit_footprint(const std::array<Vec3i, 3>& triangle, const Visit& visit) const {
  const Grid& grid = surface_.grid;
  const std::array corners{grid.world(triangle[0]), grid.world(triangle[1]), grid.world(triangle[2])};
  for (std::uint32_t layer = 0; layer < footprints_.size(); ++layer)
    for (const LatticeRun& run : footprints_[layer].of(corners)) visit(layer, run);
}

std::vector<PostingMeasure::Extent> PostingMeasure::extents_of(
    std::span<const std::array<Vec3i, 3>> triangles) const {
  const std::uint64_t side = surface_.store_.squares().side();
  std::vector<Extent> extents(triangles.size());
  tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t t) {
    visit_footprint(triangles[t], [&](std::uint32_t, const LatticeRun& run) {
      extents[t].postings += run.last - run.first + 1;
      extents[t].runs += (run.last - run.first) / side + 2;
    });
  });
  return extents;
}

std::vector<PostingMeasure::SquareRuns> PostingMeasure::runs_of(
    std::span<const std::array<Vec3i, 3>> triangles, std::span<const std::uint32_t> some) const {
  constexpr std::size_t part_triangles = 256;
  std::vector<std::vector<Placed>> parts((some.size() + part_triangles - 1) / part_triangles);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    const std::size_t end = std::min(some.size(), (part + 1) * part_triangles);
    for (std::size_t i = part * part_triangles; i < end; ++i)
      visit_footprint(triangles[some[i]], [&](std::uint32_t layer, const LatticeRun& run) {
        place(some[i], layer, run, parts[part]);
      });
  });
  std::vector<Placed> all;
  for (auto& p : parts) all.insert(all.end(), p.begin(), p.end());
  std::stable_sort(all.begin(), all.end(),
                   [](const Placed& a, const Placed& b) { return a.square < b.square; });
  std::vector<SquareRuns> out;
  for (const Placed& p : all) {
    if (out.empty() || out.back().square != p.square) out.push_back({p.square, {}});
    out.back().runs.push_back(p.run);
  }
  return out;
}

template <class Visit>
Result<void> PostingMeasure::visit_square(const SquareRuns& square,
                                          std::span<const std::array<Vec3i, 3>> triangles,
                                          const Visit& visit) const {
  const LatticeSquare at = surface_.store_.squares().square(square.square);
  std::uint32_t first_row = at.height, last_row = 0;
  for (const Run& r : square.runs) {
    first_row = std::min(first_row, r.row);
    last_row = std::max(last_row, r.row);
  }
  // The rows that are asked for, as the vertices are: snapped to the grid.
  const std::uint64_t rows = last_row - first_row + 1;
  std::vector<float> heights_m(rows * at.width);
  const auto column = static_cast<std::int64_t>(at.column),
             row = static_cast<std::int64_t>(at.row + first_row);
  if (auto r = surface_.store_.read(at.layer, column, row, at.width, rows, heights_m); !r) return r;
  std::vector<Vec3d> points(heights_m.size());
  surface_.positions_[at.layer].of(column, row, at.width, rows, heights_m, points);
  for (Vec3d& p : points)  // on a plane a posting without a height still has an x
    if (is_finite(p)) p = vec_cast<double>(surface_.grid.snap(p));
  std::uint32_t known = ~0u;
  MeasuredTriangle t;
  for (const Run& r : square.runs) {
    if (r.triangle != known) {
      known = r.triangle;
      t = measured(triangles[known]);
    }
    const Vec3d* const run = points.data() + (r.row - first_row) * at.width;
    for (std::uint32_t i = r.first; i <= r.last; ++i)
      if (const double d = distance_along(t, *surface_.vertical, run[i]); d >= 0) visit(known, run[i], d);
  }
  return {};
}

Result<void> PostingMeasure::measure(std::span<const std::array<Vec3i, 3>> triangles,
                                     std::span<float> distances) const {
  std::fill(distances.begin(), distances.end(), 0.0f);
  const auto measure_some = [&](std::span<const std::uint32_t> some) {
    const std::vector<SquareRuns> squares = runs_of(triangles, some);
    return run_all(squares.size(), arena_threads(), [&](std::uint64_t i) {
      return visit_square(squares[i], triangles, [&](std::uint32_t triangle, const Vec3d&, double distance) {
        const float bound = rounded_up(distance);
        // Not negative: bits are in order.
        std::atomic_ref<float> out(distances[triangle]);
        for (float before = out.load(); before < bound && !out.compare_exchange_weak(before, bound);) {
        }
      });
    });
  };
  const std::vector<Extent> extents = extents_of(triangles);
  std::vector<std::uint32_t> some;
  std::uint64_t runs = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (runs > 0 && runs + extents[t].runs > most_runs) {
      if (auto r = measure_some(some); !r) return r;
      some.clear();
      runs = 0;
    }
    some.push_back(t);
    runs += extents[t].runs;
  }
  return measure_some(some);
}

Result<std::vector<std::optional<std::vector<Vec3i>>>> PostingMeasure::postings_over(
    std::span<const std::array<Vec3i, 3>> triangles, std::size_t most) const {
  const std::vector<Extent> extents = extents_of(triangles);
  std::vector<std::optional<std::vector<Vec3i>>> out(triangles.size());
  std::vector<std::uint32_t> some;
  for (std::uint32_t t = 0; t < out.size(); ++t) {
    if (extents[t].postings > most) continue;
    out[t].emplace();
    some.push_back(t);
  }
  const auto add = [&](std::uint32_t triangle, const Vec3d& p, double) {
    out[triangle]->push_back(vec_cast<std::int32_t>(p));
  };
  for (const SquareRuns& square : runs_of(triangles, some))
    if (auto r = visit_square(square, triangles, add); !r) return fail(r.error());
  return out;
}

}  // namespace cuesta
