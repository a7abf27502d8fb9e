#include "terrain/constrained_delaunay.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

namespace cuesta {
namespace {

constexpr std::uint32_t none = DelaunayTriangle::none;

__extension__ typedef __int128 Wide;

/// > 0: a, b, c turn left. Exact.
int turn(GridPoint a, GridPoint b, GridPoint c) {
  const Wide left = Wide{b.x - a.x} * (c.y - a.y), right = Wide{b.y - a.y} * (c.x - a.x);
  return left > right ? 1 : left < right ? -1 : 0;
}

/// Whether d lies in the circle through a, b, c (to the left), beyond doubt.
bool is_in_circle(GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
  constexpr double error_bound = 2e-15;  // Shewchuk's 10 ε, and as much for the differences' rounding
  const auto dx = [&](GridPoint p) { return double(p.x - d.x); };
  const auto dy = [&](GridPoint p) { return double(p.y - d.y); };
  const auto lift = [&](GridPoint p) { return dx(p) * dx(p) + dy(p) * dy(p); };
  double det = 0, bound = 0;
  const auto add = [&](GridPoint p, GridPoint q, GridPoint r) {
    const double first = dx(q) * dy(r), second = dy(q) * dx(r);
    det += lift(p) * (first - second);
    bound += lift(p) * (std::abs(first) + std::abs(second));
  };
  add(a, b, c);
  add(b, c, a);
  add(c, a, b);
  return det > error_bound * bound;
}

constexpr std::size_t after(std::size_t i) {
  return i == 2 ? 0 : i + 1;
}
constexpr std::size_t before(std::size_t i) {
  return i == 0 ? 2 : i - 1;
}

/// A triangulation that grows. Its first three points are those of a triangle around all others.
class Mesh {
 public:
  using Triangle = DelaunayTriangle;

  explicit Mesh(std::vector<GridPoint> points)
      : points_(std::move(points)), triangle_of_(points_.size(), none) {
    triangles_.reserve(2 * points_.size());
    triangles_.push_back({{0, 1, 2}, {none, none, none}, {}});
    triangle_of_[0] = triangle_of_[1] = triangle_of_[2] = 0;
  }

  void insert(std::uint32_t p) {
    const auto [t, edge] = locate(p);
    if (edge == none)
      split_triangle(t, p);
    else
      split_edge(t, edge, p);
    legalize();
  }

  /// @return false: another segment or a point is in the way.
  bool insert_segment(std::uint32_t a, std::uint32_t b);

  const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  struct Place {
    std::uint32_t triangle;
    std::uint32_t edge;  // none: inside
  };
  struct Edge {
    std::uint32_t a, b;
  };
  struct Side {
    std::uint32_t triangle;
    std::size_t index;  // of the point opposite
  };

  GridPoint at(std::uint32_t p) const { return points_[p]; }
  std::size_t index_of(const Triangle& t, std::uint32_t p) const {
    return t.points[0] == p ? 0 : t.points[1] == p ? 1 : 2;
  }
  std::size_t index_across(std::uint32_t t, std::uint32_t neighbour) const {
    const auto& across = triangles_[t].across;
    return across[0] == neighbour ? 0 : across[1] == neighbour ? 1 : 2;
  }

  Place locate(std::uint32_t p) const;
  void split_triangle(std::uint32_t t, std::uint32_t p);
  void split_edge(std::uint32_t t, std::uint32_t edge, std::uint32_t p);
  void relink(std::uint32_t t, std::uint32_t from, std::uint32_t to) {
    if (t != none) triangles_[t].across[index_across(t, from)] = to;
  }
  void set(std::uint32_t t, const Triangle& triangle) {
    triangles_[t] = triangle;
    for (const std::uint32_t p : triangle.points) triangle_of_[p] = t;
    last_ = t;
  }
  void flip(std::uint32_t t, std::size_t i);
  void legalize();
  Side side_of(Edge edge) const;
  std::vector<Edge> crossed_by(std::uint32_t a, std::uint32_t b) const;

  std::vector<GridPoint> points_;
  std::vector<std::uint32_t> triangle_of_;  // one of each point
  std::vector<Triangle> triangles_;
  std::vector<Side> doubtful_;  // edges that may not be Delaunay
  std::uint32_t last_ = 0;
};

/// Walks from the triangle that was changed last, towards the point.
Mesh::Place Mesh::locate(std::uint32_t p) const {
  std::uint32_t t = last_, from = none;
  for (std::size_t step = 0;; ++step) {
    const Triangle& triangle = triangles_[t];
    std::uint32_t zero = none, next = none;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + step) % 3;  // no walk in circles
      const int side = turn(at(triangle.points[after(i)]), at(triangle.points[before(i)]), at(p));
      if (side == 0) zero = static_cast<std::uint32_t>(i);
      if (side < 0 && (next == none || triangle.across[i] != from)) next = triangle.across[i];
    }
    if (next == none) return {t, zero};
    from = t;
    t = next;
  }
}

void Mesh::split_triangle(std::uint32_t t, std::uint32_t p) {
  const Triangle old = triangles_[t];
  const auto first = static_cast<std::uint32_t>(triangles_.size());
  triangles_.resize(triangles_.size() + 2);
  const std::array<std::uint32_t, 3> parts{t, first, first + 1};
  for (std::size_t i = 0; i < 3; ++i) {  // part i lies at the edge opposite of point i
    relink(old.across[i], t, parts[i]);
    set(parts[i], {{p, old.points[after(i)], old.points[before(i)]},
                   {old.across[i], parts[after(i)], parts[before(i)]},
                   {old.is_segment[i], false, false}});
    doubtful_.push_back({parts[i], 0});
  }
}

void Mesh::split_edge(std::uint32_t t, std::uint32_t edge, std::uint32_t p) {
  const Triangle near = triangles_[t];
  const std::uint32_t u = near.across[edge];
  const Triangle far = triangles_[u];
  const std::size_t i = edge, j = index_across(u, t);
  const std::uint32_t a = near.points[i], b = near.points[after(i)], c = near.points[before(i)],
                      d = far.points[j];
  const bool is_segment = near.is_segment[i];
  const auto t2 = static_cast<std::uint32_t>(triangles_.size()), u2 = t2 + 1;
  triangles_.resize(triangles_.size() + 2);
  // near (a, b, c) becomes (p, a, b) and (p, c, a); far (d, c, b) becomes (p, d, c) and (p, b, d)
  const std::size_t db = index_of(far, b), dc = index_of(far, c);
  relink(near.across[after(i)], t, t2);
  relink(far.across[db], u, u2);
  set(t, {{p, a, b}, {near.across[before(i)], u, t2}, {near.is_segment[before(i)], is_segment, false}});
  set(t2, {{p, c, a}, {near.across[after(i)], t, u2}, {near.is_segment[after(i)], false, is_segment}});
  set(u2, {{p, d, c}, {far.across[db], t2, u}, {far.is_segment[db], is_segment, false}});
  set(u, {{p, b, d}, {far.across[dc], u2, t}, {far.is_segment[dc], false, is_segment}});
  for (const std::uint32_t part : {t, t2, u, u2}) doubtful_.push_back({part, 0});
}

/// The quadrilateral of a triangle and its neighbour across from point i gets its other diagonal.
void Mesh::flip(std::uint32_t t, std::size_t i) {
  const Triangle near = triangles_[t];
  const std::uint32_t u = near.across[i];
  const Triangle far = triangles_[u];
  const std::size_t j = index_across(u, t);
  const std::uint32_t a = near.points[i], b = near.points[after(i)], c = near.points[before(i)],
                      d = far.points[j];
  // far is (d, c, b)
  relink(near.across[after(i)], t, u);
  relink(far.across[after(j)], u, t);
  set(t, {{a, b, d},
          {far.across[after(j)], u, near.across[before(i)]},
          {far.is_segment[after(j)], false, near.is_segment[before(i)]}});
  set(u, {{a, d, c},
          {far.across[before(j)], near.across[after(i)], t},
          {far.is_segment[before(j)], near.is_segment[after(i)], false}});
}

void Mesh::legalize() {
  while (!doubtful_.empty()) {
    const Side side = doubtful_.back();
    doubtful_.pop_back();
    const Triangle& triangle = triangles_[side.triangle];
    const std::uint32_t u = triangle.across[side.index];
    if (u == none || triangle.is_segment[side.index]) continue;
    const std::size_t j = index_across(u, side.triangle);
    const auto& p = triangle.points;
    const std::uint32_t a = p[side.index], b = p[after(side.index)], c = p[before(side.index)],
                        d = triangles_[u].points[j];
    if (!is_in_circle(at(a), at(b), at(c), at(d)) || turn(at(a), at(b), at(d)) <= 0 ||
        turn(at(a), at(d), at(c)) <= 0)
      continue;
    flip(side.triangle, side.index);  // triangle is now (a, b, d), u is (a, d, c)
    for (const std::uint32_t changed : {side.triangle, u}) {
      for (std::size_t i = 0; i < 3; ++i) doubtful_.push_back({changed, i});
    }
  }
}

/// The triangle in which a follows b, so that the edge is opposite of `index`; none: there is no such edge.
Mesh::Side Mesh::side_of(Edge edge) const {
  const std::uint32_t first = triangle_of_[edge.a];
  std::uint32_t t = first;
  do {
    const Triangle& triangle = triangles_[t];
    const std::size_t i = index_of(triangle, edge.a);
    if (triangle.points[after(i)] == edge.b) return {t, before(i)};
    if (triangle.points[before(i)] == edge.b) return {t, after(i)};
    t = triangle.across[after(i)];
  } while (t != first && t != none);
  return {none, 0};
}

/// Edges between a and b, in order; empty if a point is in the way. @pre there is no edge a, b.
std::vector<Mesh::Edge> Mesh::crossed_by(std::uint32_t a, std::uint32_t b) const {
  std::vector<Edge> edges;
  const std::uint32_t first = triangle_of_[a];
  std::uint32_t t = first;
  std::size_t i = 0;
  for (;; t = triangles_[t].across[after(i)]) {  // around a, to the triangle that the segment leaves through
    const Triangle& triangle = triangles_[t];
    i = index_of(triangle, a);
    const GridPoint right = at(triangle.points[after(i)]), left = at(triangle.points[before(i)]);
    if (turn(at(a), at(b), right) < 0 && turn(at(a), at(b), left) > 0 && turn(right, left, at(b)) < 0) break;
    if (triangle.across[after(i)] == first || triangle.across[after(i)] == none) return {};
  }
  while (true) {
    const Triangle& triangle = triangles_[t];
    const std::uint32_t right = triangle.points[after(i)], left = triangle.points[before(i)];
    edges.push_back({right, left});
    const std::uint32_t next = triangle.across[i];
    const std::size_t j = index_across(next, t);
    const std::uint32_t tip = triangles_[next].points[j];
    if (tip == b) return edges;
    const int side = turn(at(a), at(b), at(tip));
    if (side == 0) return {};
    // Beyond the tip the segment leaves through the edge from the tip to the end on its other side.
    i = index_of(triangles_[next], side > 0 ? left : right);
    t = next;
  }
}

bool Mesh::insert_segment(std::uint32_t a, std::uint32_t b) {
  const auto mark = [&](Side side) {
    Triangle& near = triangles_[side.triangle];
    near.is_segment[side.index] = true;
    Triangle& far = triangles_[near.across[side.index]];
    far.is_segment[index_across(near.across[side.index], side.triangle)] = true;
  };
  if (const Side side = side_of({a, b}); side.triangle != none) {
    mark(side);
    return true;
  }
  std::vector<Edge> edges = crossed_by(a, b);
  if (edges.empty()) return false;
  for (const Edge& edge : edges) {
    const Side side = side_of(edge);
    if (triangles_[side.triangle].is_segment[side.index]) return false;
  }
  std::deque<Edge> crossing(edges.begin(), edges.end());
  std::vector<Edge> made;
  while (!crossing.empty()) {
    const Edge edge = crossing.front();
    crossing.pop_front();
    const Side side = side_of(edge);
    const Triangle& near = triangles_[side.triangle];
    const std::uint32_t u = near.across[side.index];
    const std::uint32_t p = near.points[side.index], q = triangles_[u].points[index_across(u, side.triangle)];
    const std::uint32_t r = near.points[after(side.index)], l = near.points[before(side.index)];
    if (turn(at(p), at(r), at(q)) <= 0 || turn(at(p), at(q), at(l)) <= 0) {
      crossing.push_back(edge);  // not convex yet; others come first
      continue;
    }
    flip(side.triangle, side.index);
    const bool still_crosses =
        p != a && p != b && q != a && q != b && turn(at(a), at(b), at(p)) * turn(at(a), at(b), at(q)) < 0;
    if (still_crosses)
      crossing.push_back({p, q});
    else
      made.push_back({p, q});
  }
  mark(side_of({a, b}));
  for (const Edge& edge : made) doubtful_.push_back(side_of(edge));
  legalize();
  return true;
}

/// Indices in the order of a snake through strips, so that each point lies near the one before.
std::vector<std::uint32_t> snake(std::span<const GridPoint> points) {
  std::int64_t low = points.front().y, high = low;
  for (const GridPoint& p : points) {
    low = std::min(low, p.y);
    high = std::max(high, p.y);
  }
  const auto strips = static_cast<std::int64_t>(std::sqrt(double(points.size())) / 2) + 1;
  const std::int64_t step = (high - low) / strips + 1;
  const auto key = [&](std::uint32_t i) {
    const std::int64_t strip = (points[i].y - low) / step;
    return std::pair(strip, strip % 2 == 0 ? points[i].x : -points[i].x);
  };
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(
      order, [&](std::uint32_t a, std::uint32_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  return order;
}

/// The points after three that lie around all of them, far away.
std::vector<GridPoint> with_surroundings(std::span<const GridPoint> points) {
  GridPoint low = points.front(), high = low;
  for (const GridPoint& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const std::int64_t size = 1024 * (std::max(high.x - low.x, high.y - low.y) + 1);
  const GridPoint middle{low.x + (high.x - low.x) / 2, low.y + (high.y - low.y) / 2};
  std::vector<GridPoint> all{{middle.x - 2 * size, middle.y - size},
                             {middle.x + 2 * size, middle.y - size},
                             {middle.x, middle.y + 2 * size}};
  all.insert(all.end(), points.begin(), points.end());
  return all;
}

}  // namespace

Triangulation triangulate(std::span<const GridPoint> points,
                          std::span<const std::array<std::uint32_t, 2>> segments) {
  Triangulation out;
  if (points.empty()) return out;
  Mesh mesh(with_surroundings(points));
  for (const std::uint32_t p : snake(points)) mesh.insert(p + 3);
  for (const auto& [a, b] : segments) out.lost_segments += !mesh.insert_segment(a + 3, b + 3);
  std::vector<std::uint32_t> number(mesh.triangles().size(), none);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (std::ranges::min(mesh.triangles()[i].points) >= 3) number[i] = count++;
  }
  out.triangles.reserve(count);
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == none) continue;
    DelaunayTriangle triangle = mesh.triangles()[i];
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.points[k] -= 3;
      if (triangle.across[k] != none) triangle.across[k] = number[triangle.across[k]];
    }
    out.triangles.push_back(triangle);
  }
  return out;
}

}  // namespace cuesta
