#include "apps/measure/triangle_tree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>

#include "ooc/check.h"

namespace cuesta::measure {
namespace {

/// Below this many triangles a subtree is built by one thread.
constexpr std::size_t parallel_grain = 1u << 14;
/// Share of a squared box distance that f32 rounding may add; boxes are padded by the same idea (see
/// collect).
constexpr double box_slack = 1.0 / (1 << 19);
/// Triangles whose squared sine at a is below this are treated as their three edges.
constexpr double needle_sine_sq = 1e-24;

Vec3d nearest_on_segment(Vec3d p, Vec3d a, Vec3d ab) {
  const double l = dot(ab, ab);
  const double t = l > 0 ? std::clamp(dot(p - a, ab) / l, 0.0, 1.0) : 0.0;
  return a + ab * t;
}

Vec3d nearer(Vec3d p, Vec3d a, Vec3d b) {
  return dot(p - b, p - b) < dot(p - a, p - a) ? b : a;
}

Vec3d nearest_on_edges(Vec3d p, Vec3d a, Vec3d ab, Vec3d ac) {
  const Vec3d on_ab_or_ac = nearer(p, nearest_on_segment(p, a, ab), nearest_on_segment(p, a, ac));
  return nearer(p, on_ab_or_ac, nearest_on_segment(p, a + ab, ac - ab));
}

/// Ericson's walk over the Voronoi regions: three corners, three edges, inside.
Vec3d nearest_on_triangle(Vec3d p, Vec3d a, Vec3d ab, Vec3d ac) {
  const Vec3d ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const double ab_ab = dot(ab, ab), ab_ac = dot(ab, ac), ac_ac = dot(ac, ac);
  const double d3 = d1 - ab_ab, d4 = d2 - ab_ac;
  if (d3 >= 0 && d4 <= d3) return a + ab;
  const double d5 = d1 - ab_ac, d6 = d2 - ac_ac;
  if (d6 >= 0 && d5 <= d6) return a + ac;
  if (ab_ab * ac_ac - ab_ac * ab_ac <= needle_sine_sq * ab_ab * ac_ac) return nearest_on_edges(p, a, ab, ac);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return a + ab + (ac - ab) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double scale = 1 / (va + vb + vc);
  return a + ab * (vb * scale) + ac * (vc * scale);
}

struct Pending {
  float distance_sq;
  std::uint32_t child;
};

/// Squared distances from q to four boxes. Lanes innermost and kept rolled, so that it becomes SIMD at -O2
/// and -O3.
std::array<float, 4> box_distances_sq(const float (&lo)[3][4], const float (&hi)[3][4], Vec3f q) {
  alignas(16) std::array<float, 4> d{};
  for (int axis = 0; axis < 3; ++axis) {
    const float at = q[axis];
#pragma GCC unroll 1
    for (std::size_t i = 0; i < 4; ++i) {
      const float out = std::max(std::max(lo[axis][i] - at, at - hi[axis][i]), 0.0f);
      d[i] += out * out;
    }
  }
  return d;
}

/// How the children of a node of n triangles share them, and how many nodes each subtree takes.
std::array<std::size_t, 5> quarters(std::size_t n) {
  const std::size_t half = n / 2;
  return {0, half / 2, half, half + (n - half) / 2, n};
}

std::uint32_t node_count(std::size_t n, std::uint32_t leaf) {
  std::uint32_t count = 1;
  const auto cut = quarters(n);
  for (std::size_t i = 0; i < 4; ++i) {
    if (cut[i + 1] - cut[i] > leaf) count += node_count(cut[i + 1] - cut[i], leaf);
  }
  return count;
}

/// Splits items so that the first `cut` are on the low side of the longest axis of their centres.
template <class Item>
void split(std::span<Item> items, std::size_t cut) {
  if (cut == 0 || cut == items.size()) return;
  Box3<float> box;
  for (const Item& item : items) box.add(item.centre);
  const Vec3f size = box.hi - box.lo;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(cut), items.end(),
                   [axis](const Item& a, const Item& b) { return a.centre[axis] < b.centre[axis]; });
}

}  // namespace

double squared_distance(Vec3d p, Vec3d a, Vec3d ab, Vec3d ac, Vec3d* nearest) {
  *nearest = nearest_on_triangle(p, a, ab, ac);
  return dot(p - *nearest, p - *nearest);
}

/// What the caller gave, in the tree's frame.
struct TriangleTree::Source {
  std::span<const Vec3d> positions;
  std::span<const std::array<std::uint32_t, 3>> triangles;
  Vec3d corner(std::uint32_t id, std::size_t i) const { return positions[triangles[id][i]]; }
};

TriangleTree::TriangleTree(std::span<const Vec3d> positions,
                           std::span<const std::array<std::uint32_t, 3>> triangles) {
  CUESTA_CHECK(triangles.size() < (1u << 29), triangles.size());
  const Source source{positions, triangles};
  std::vector<Item> items;
  collect(source, items);
  if (items.empty()) return;
  triangles_.resize(items.size());
  ids_.resize(items.size());
  nodes_.resize(node_count(items.size(), leaf_size));
  build(source, items, 0, 0);
}

/// Keeps finite triangles and finds the frame. The padding covers the rounding to f32 of boxes and of query
/// points up to two radii away; farther points have errors below box_slack of their distance.
void TriangleTree::collect(const Source& source, std::vector<Item>& items) {
  Box3d box;
  items.reserve(source.triangles.size());
  for (std::uint32_t id = 0; id < source.triangles.size(); ++id) {
    const Vec3d a = source.corner(id, 0), b = source.corner(id, 1), c = source.corner(id, 2);
    if (!is_finite(a) || !is_finite(b) || !is_finite(c)) continue;
    for (const Vec3d& p : {a, b, c}) box.add(p);
    items.push_back({{}, id});
  }
  left_out_ = source.triangles.size() - items.size();
  if (items.empty()) return;
  centre_ = (box.lo + box.hi) * 0.5;
  const Vec3d radius = box.hi - centre_;
  pad_ = std::max({radius.x, radius.y, radius.z}) / (1 << 21);
  for (Item& item : items) {
    const Vec3d sum = source.corner(item.id, 0) + source.corner(item.id, 1) + source.corner(item.id, 2);
    item.centre = vec_cast<float>(sum / 3.0 - centre_);
  }
}

Box3d TriangleTree::build(const Source& source, std::span<Item> items, std::uint32_t first,
                          std::uint32_t node) {
  const auto cut = quarters(items.size());
  split(items, cut[2]);
  split(items.first(cut[2]), cut[1]);
  split(items.subspan(cut[2]), cut[3] - cut[2]);
  std::array<Box3d, 4> boxes;
  std::array<std::uint32_t, 4> next{};
  for (std::uint32_t i = 0, n = node + 1; i < 4; ++i) {
    next[i] = n;
    if (cut[i + 1] - cut[i] > leaf_size) n += node_count(cut[i + 1] - cut[i], leaf_size);
  }
  const auto child = [&](std::size_t i) {
    boxes[i] = build_child(source, items.subspan(cut[i], cut[i + 1] - cut[i]),
                           first + static_cast<std::uint32_t>(cut[i]), next[i], nodes_[node].child[i]);
  };
  if (items.size() > parallel_grain) {
    tbb::parallel_invoke([&] { child(0); }, [&] { child(1); }, [&] { child(2); }, [&] { child(3); });
  } else {
    for (std::size_t i = 0; i < 4; ++i) child(i);
  }
  Box3d all;
  for (int i = 0; i < 4; ++i) {
    set_lane(nodes_[node], i, boxes[static_cast<std::size_t>(i)]);
    all.add(boxes[static_cast<std::size_t>(i)]);
  }
  return all;
}

Box3d TriangleTree::build_child(const Source& source, std::span<Item> items, std::uint32_t first,
                                std::uint32_t next_node, std::uint32_t& child) {
  if (items.size() > leaf_size) {
    child = next_node;
    return build(source, items, first, next_node);
  }
  const auto count = static_cast<std::uint32_t>(std::max<std::size_t>(items.size(), 1));
  child = leaf_bit | (count - 1) << 29 | first;
  return fill_leaf(source, items, first);
}

Box3d TriangleTree::fill_leaf(const Source& source, std::span<const Item> items, std::uint32_t first) {
  Box3d box;
  for (const Item& item : items) {
    const Vec3d a = source.corner(item.id, 0), b = source.corner(item.id, 1), c = source.corner(item.id, 2);
    for (const Vec3d& p : {a, b, c}) box.add(p - centre_);
    triangles_[first] = {a - centre_, b - a, c - a};
    ids_[first++] = item.id;
  }
  return box;
}

void TriangleTree::set_lane(Node& node, int lane, const Box3d& box) const {
  for (int axis = 0; axis < 3; ++axis) {
    constexpr float none = std::numeric_limits<float>::infinity();
    node.lo[axis][lane] = box.empty() ? none : static_cast<float>(box.lo[axis] - pad_);
    node.hi[axis][lane] = box.empty() ? none : static_cast<float>(box.hi[axis] + pad_);
  }
}

inline void TriangleTree::test(Vec3d local, std::uint32_t slot, NearestPoint& best) const {
  const Triangle& t = triangles_[slot];
  const Vec3d q = nearest_on_triangle(local, t.a, t.ab, t.ac);
  const double d = dot(local - q, local - q);
  if (!(d < best.distance_sq)) return;
  best.distance_sq = d;
  best.slot = slot;
  best.point = q;
}

NearestPoint TriangleTree::nearest(Vec3d p, std::uint32_t hint_slot, double bound_sq) const {
  NearestPoint best;
  best.distance_sq = bound_sq;
  if (empty()) return best;
  const Vec3d local = p - centre_;
  if (hint_slot < triangles_.size()) test(local, hint_slot, best);
  const Vec3f q = vec_cast<float>(local);
  const auto widened = [](double d) { return static_cast<float>(d * (1 + box_slack)); };
  float limit = widened(best.distance_sq);
  std::array<Pending, 64> stack;  // three more per level, at most 15 levels
  std::size_t size = 0;
  stack[size++] = {0, 0};
  while (size > 0) {
    const Pending top = stack[--size];
    if (top.distance_sq > limit) continue;
    if (top.child & leaf_bit) {
      const std::uint32_t slot = top.child & 0x1fffffffu, last = slot + (top.child >> 29 & 3u);
      for (std::uint32_t i = slot; i <= last; ++i) test(local, i, best);
      limit = widened(best.distance_sq);
      continue;
    }
    const Node& node = nodes_[top.child];
    const std::array<float, 4> d = box_distances_sq(node.lo, node.hi, q);
    const std::size_t base = size;
    for (int i = 0; i < 4; ++i) {  // nearest ends on top
      if (!(d[i] <= limit) || !(d[i] < std::numeric_limits<float>::infinity())) continue;
      std::size_t at = size++;
      for (; at > base && stack[at - 1].distance_sq < d[i]; --at) stack[at] = stack[at - 1];
      stack[at] = {d[i], node.child[i]};
    }
  }
  if (best.slot != no_triangle) {
    best.triangle = ids_[best.slot];
    best.point = best.point + centre_;
  }
  return best;
}

}  // namespace cuesta::measure
