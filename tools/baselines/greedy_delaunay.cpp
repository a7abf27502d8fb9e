#include "tools/baselines/greedy_delaunay.h"

#include <utility>

#include "ooc/check.h"
#include "tools/baselines/candidate_heap.h"

namespace cuesta::baselines {
namespace {

using Id = std::uint32_t;
constexpr Id none = 0xFFFFFFFFu;

constexpr Id next(Id edge) {
  return edge % 3 == 2 ? edge - 2 : edge + 1;
}
constexpr Id previous(Id edge) {
  return edge % 3 == 0 ? edge + 2 : edge - 1;
}

/// d is strictly inside the circle through a, b, c. @pre turn(a, b, c) > 0.
bool in_circle(GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
  const std::int64_t ax = a.column - d.column, ay = a.row - d.row, bx = b.column - d.column,
                     by = b.row - d.row, cx = c.column - d.column, cy = c.row - d.row;
  const std::int64_t aa = ax * ax + ay * ay, bb = bx * bx + by * by, cc = cx * cx + cy * cy;
  return aa * (bx * cy - cx * by) + bb * (cx * ay - ax * cy) + cc * (ax * by - bx * ay) > 0;
}

/// Half-edges: edge 3t + k of triangle t leaves corner k; its twin is in the neighbour, or none.
class GreedyDelaunay {
 public:
  GreedyDelaunay(const HeightGrid& grid, double most_error_m) : grid_(grid), most_error_m_(most_error_m) {
    const auto right = static_cast<std::int32_t>(grid.columns) - 1,
               bottom = static_cast<std::int32_t>(grid.rows) - 1;
    const GridPoint nw{0, 0}, ne{right, 0}, sw{0, bottom}, se{right, bottom};
    add(nw, ne, se);
    add(nw, se, sw);
    join(2, 3);
    look_at_changed();
  }

  void run() {
    while (!candidates_.empty()) {
      insert(candidates_.top());
      look_at_changed();
    }
  }

  std::vector<GridTriangle> triangles() const {
    std::vector<GridTriangle> out(worst_.size());
    const auto posting = [&](Id edge) {
      const GridPoint p = from_[edge];
      return static_cast<std::uint32_t>(p.row) * grid_.columns + static_cast<std::uint32_t>(p.column);
    };
    for (Id t = 0; t < out.size(); ++t) out[t] = {posting(3 * t), posting(3 * t + 2), posting(3 * t + 1)};
    return out;
  }

 private:
  void set(Id t, GridPoint a, GridPoint b, GridPoint c) {
    from_[3 * t] = a;
    from_[3 * t + 1] = b;
    from_[3 * t + 2] = c;
    if (!is_changed_[t]) changed_.push_back(t);
    is_changed_[t] = true;
  }
  Id add(GridPoint a, GridPoint b, GridPoint c) {
    const Id t = static_cast<Id>(worst_.size());
    worst_.emplace_back();
    is_changed_.push_back(false);
    from_.resize(from_.size() + 3);
    twin_.resize(twin_.size() + 3, none);
    set(t, a, b, c);
    return t;
  }
  void join(Id edge, Id twin) {
    twin_[edge] = twin;
    if (twin != none) twin_[twin] = edge;
  }

  void insert(Id t) {
    const GridPoint p = worst_[t].at;
    for (Id edge = 3 * t; edge < 3 * t + 3; ++edge)
      if (turn(from_[edge], from_[next(edge)], p) == 0) return split_edge(edge, p);
    split_triangle(t, p);
  }

  void split_triangle(Id t, GridPoint p) {
    const GridPoint a = from_[3 * t], b = from_[3 * t + 1], c = from_[3 * t + 2];
    const Id bc = twin_[3 * t + 1], ca = twin_[3 * t + 2];
    set(t, a, b, p);
    const Id u = add(b, c, p), v = add(c, a, p);
    join(3 * u, bc);
    join(3 * v, ca);
    join(3 * t + 1, 3 * u + 2);
    join(3 * u + 1, 3 * v + 2);
    join(3 * v + 1, 3 * t + 2);
    for (const Id edge : {3 * t, 3 * u, 3 * v}) legalize(edge);
  }

  /// Cuts the triangle of `edge` in two through p on that edge: the first half keeps the edge's start.
  /// @return the other half's part of the edge.
  Id halve(Id edge, GridPoint p) {
    const Id t = edge / 3, bc = twin_[next(edge)], ca = twin_[previous(edge)];
    const GridPoint a = from_[edge], b = from_[next(edge)], c = from_[previous(edge)];
    set(t, a, p, c);
    const Id u = add(p, b, c);
    join(3 * t + 2, ca);
    join(3 * u + 1, bc);
    join(3 * t + 1, 3 * u + 2);
    twin_[3 * t] = none;
    return 3 * u;
  }

  void split_edge(Id edge, GridPoint p) {
    const Id twin = twin_[edge], near = edge / 3, far = twin == none ? none : twin / 3;
    const Id u = halve(edge, p) / 3;
    if (far == none) {
      for (const Id outer : {3 * near + 2, 3 * u + 1}) legalize(outer);
      return;
    }
    const Id v = halve(twin, p) / 3;
    join(3 * near, 3 * v);
    join(3 * u, 3 * far);
    for (const Id outer : {3 * near + 2, 3 * u + 1, 3 * far + 2, 3 * v + 1}) legalize(outer);
  }

  /// Flips edges until the star of the new posting, which `edge` is opposite to, is Delaunay.
  void legalize(Id edge) {
    flips_.assign(1, edge);
    while (!flips_.empty()) {
      const Id e = flips_.back(), f = twin_[e];
      flips_.pop_back();
      if (f == none) continue;
      const GridPoint a = from_[e], b = from_[next(e)], p = from_[previous(e)], q = from_[previous(f)];
      if (!in_circle(a, b, p, q)) continue;
      flip(e, f, a, b, p, q);
    }
  }

  /// Triangles abp and baq become qbp and aqp; the edges of theirs that are opposite to p are next.
  void flip(Id e, Id f, GridPoint a, GridPoint b, GridPoint p, GridPoint q) {
    const Id t = e / 3, u = f / 3;
    const Id bp = twin_[next(e)], pa = twin_[previous(e)], aq = twin_[next(f)], qb = twin_[previous(f)];
    set(t, q, b, p);
    set(u, a, q, p);
    join(3 * t, qb);
    join(3 * t + 1, bp);
    join(3 * u, aq);
    join(3 * u + 2, pa);
    join(3 * t + 2, 3 * u + 1);
    flips_.push_back(3 * t);
    flips_.push_back(3 * u);
  }

  void look_at_changed() {
    for (const Id t : changed_) {
      worst_[t] = worst_posting(grid_, from_[3 * t], from_[3 * t + 1], from_[3 * t + 2]);
      if (worst_[t].error_m > most_error_m_)
        candidates_.set(t, worst_[t].error_m);
      else
        candidates_.remove(t);
      is_changed_[t] = false;
    }
    changed_.clear();
  }

  HeightGrid grid_;
  double most_error_m_;
  std::vector<GridPoint> from_;
  std::vector<Id> twin_;
  std::vector<WorstPosting> worst_;
  CandidateHeap candidates_;
  std::vector<Id> changed_, flips_;
  std::vector<bool> is_changed_;
};

}  // namespace

std::vector<GridTriangle> greedy_delaunay(const HeightGrid& grid, double most_error_m) {
  CUESTA_CHECK(grid.columns >= 2 && grid.columns <= most_columns_or_rows, grid.columns);
  CUESTA_CHECK(grid.rows >= 2 && grid.rows <= most_columns_or_rows, grid.rows);
  CUESTA_CHECK(grid.heights_m.size() == std::size_t{grid.columns} * grid.rows, grid.heights_m.size());
  CUESTA_CHECK(most_error_m >= 0, most_error_m);
  GreedyDelaunay triangulation(grid, most_error_m);
  triangulation.run();
  return triangulation.triangles();
}

}  // namespace cuesta::baselines
