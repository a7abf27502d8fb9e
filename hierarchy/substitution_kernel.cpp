#include "hierarchy/substitution_kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cuesta {
namespace {

/// A triangle may turn by at most acos(0.2) ≈ 78° in one substitution.
constexpr float least_cosine = 0.2f;
/// A triangle of a field of heights is no narrower, seen from above, in grid steps.
constexpr double least_width = 2;

}  // namespace

SubstitutionKernel::SubstitutionKernel(const CellMesh& cell) : corners_(cell.triangles) {
  birth_errors_.reserve(cell.births.size());
  for (const Birth& b : cell.births) birth_errors_.push_back(b.error);
  const std::size_t vertices = cell.positions.size();
  std::vector<PointId> point_of(vertices);
  Vec3i lo{std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max(),
           std::numeric_limits<std::int32_t>::max()};
  for (const Vec3i& p : cell.positions) lo = min(lo, p);
  origin_ = lo;
  if (cell.vertical) vertical_.emplace(*cell.vertical, lo);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (cell.wedge_group[v] == v) {
      first_vertex_.push_back(v);
      position_.push_back(vec_cast<float>(cell.positions[v] - lo));
      points_.push_back({.flags = cell.locked[v] ? flag_locked : std::uint8_t{0}});
    } else if (cell.locked[v]) {
      points_.back().flags |= flag_locked;
    }
    point_of[v] = static_cast<PointId>(position_.size() - 1);
  }
  if (position_.size() != vertices) {
    wedges_ = corners_;
    for (auto& t : corners_) t = {point_of[t[0]], point_of[t[1]], point_of[t[2]]};
  }
  live_triangles_ = static_cast<std::uint32_t>(corners_.size());
  alive_.assign(corners_.size(), 1);
  build_stars();
  walk_edges();
}

void SubstitutionKernel::build_stars() {
  for (const auto& t : corners_)
    for (PointId p : t) ++points_[p].star_size;
  std::uint32_t total = 0;
  for (Point& p : points_) {
    p.star_begin = total;
    total += p.star_size;
    p.star_size = 0;
  }
  arena_.reserve(std::size_t{total} * 3);
  arena_.resize(total);
  for (TriangleId t = 0; t < corners_.size(); ++t)
    for (PointId p : corners_[t]) arena_[points_[p].star_begin + points_[p].star_size++] = t;
}

/// Borders, orientation, manifoldness, components and loops in one walk over the edges around each point.
void SubstitutionKernel::walk_edges() {
  std::uint64_t rings = 0;  // each edge twice
  for (PointId p = 0; p < point_count(); ++p) walk_edges_around(p, rings);
  find_components(rings);
}

/// A point is on a border if it has more edges than triangles. (Locked points look so too, and do not move.)
void SubstitutionKernel::walk_edges_around(PointId p, std::uint64_t& rings) {
  const std::uint32_t out = next_stamp();
  bool oriented = true;
  for (TriangleId t : star(p)) oriented &= std::exchange(points_[next_corner(t, p)].stamp, out) != out;
  const std::uint32_t in = next_stamp();
  std::size_t size = star(p).size();
  for (TriangleId t : star(p)) {
    const std::uint32_t before = std::exchange(points_[previous_corner(t, p)].stamp, in);
    oriented &= before != in;
    size += before != out;
  }
  if (!oriented) {
    oriented_ = false;
    size = walked_neighbours(p).size();
  }
  rings += size;
  if (size != star(p).size()) points_[p].flags |= flag_border;
  if (manifold_ && can_move(p)) manifold_ = oriented ? size <= star(p).size() + 1 : is_manifold_at(p);
}

/// The same without trust in orientation.
bool SubstitutionKernel::is_manifold_at(PointId p) {
  const auto ring = walked_neighbours(p);
  std::size_t ends = 0;
  for (PointId q : ring) {
    const std::uint32_t triangles = edge_triangles(p, q);
    if (triangles > 2) return false;
    ends += triangles == 1;
  }
  // A fan has as many edges as triangles and no end; a half-fan one edge more and two ends.
  return ends <= 2 && ring.size() == star(p).size() + ends / 2;
}

/// Components by union-find, roots their lowest points; and loops: components less the Euler characteristic,
/// 0 for discs, 2 for a torus, one more for each further hole.
void SubstitutionKernel::find_components(std::uint64_t rings) {
  component_.resize(point_count());
  for (PointId p = 0; p < point_count(); ++p) component_[p] = p;
  const auto root = [this](PointId p) {
    while (component_[p] != p) p = component_[p] = component_[component_[p]];
    return p;
  };
  for (const auto& t : corners_)
    for (int i = 1; i < 3; ++i) {
      const PointId a = root(t[0]), b = root(t[static_cast<std::size_t>(i)]);
      component_[std::max(a, b)] = std::min(a, b);
    }
  component_count_ = 0;
  for (PointId p = 0; p < point_count(); ++p)  // parents are lower, so numbered already
    component_[p] = component_[p] == p ? component_count_++ : component_[component_[p]];
  const std::int64_t euler = static_cast<std::int64_t>(point_count()) - static_cast<std::int64_t>(rings / 2) +
                             static_cast<std::int64_t>(corners_.size());
  loops_ = static_cast<std::uint32_t>(std::max<std::int64_t>(0, std::int64_t{component_count_} - euler));
}

std::uint32_t SubstitutionKernel::next_stamp() {
  if (++current_stamp_ == 0) {
    for (Point& p : points_) p.stamp = 0;
    current_stamp_ = 1;
  }
  return current_stamp_;
}

/// Around an oriented point off the border each neighbour is the next corner of one triangle; a border adds
/// those that are only the corner before. Substitutions that keep the link condition keep that so.
std::span<const PointId> SubstitutionKernel::neighbours(PointId p) {
  if (!oriented_ || loose_topology_) return walked_neighbours(p);
  const auto around = star(p);
  if (ring_.size() < 2 * around.size()) ring_.resize(2 * around.size());
  PointId* end = ring_.data();
  for (TriangleId t : around) *end++ = next_corner(t, p);
  if (border(p)) {
    const std::uint32_t seen = next_stamp();
    for (std::size_t i = 0; i < around.size(); ++i) points_[ring_[i]].stamp = seen;
    for (TriangleId t : around) {
      const PointId q = previous_corner(t, p);
      if (points_[q].stamp != seen) *end++ = q;
      points_[q].stamp = seen;
    }
  }
  return {ring_.data(), end};
}

std::span<const PointId> SubstitutionKernel::walked_neighbours(PointId p) {
  const std::uint32_t seen = next_stamp();
  points_[p].stamp = seen;
  if (ring_.size() < 2 * star(p).size()) ring_.resize(2 * star(p).size());
  PointId* end = ring_.data();
  for (TriangleId t : star(p))
    for (PointId q : corners_[t])
      if (std::exchange(points_[q].stamp, seen) != seen) *end++ = q;
  return {ring_.data(), end};
}

/// Link(u) ∩ Link(v) = Link(uv): the points joined to both are the third corners of the triangles at the
/// edge, and no triangle around u becomes one that v has. Source: Dey, Edelsbrunner, Guha, Nekhayev,
/// "Topology preserving edge contraction", 1999.
bool SubstitutionKernel::link_condition(PointId u, PointId v) {
  const std::uint32_t near_v = next_stamp();
  for (TriangleId t : star(v))
    for (PointId q : corners_[t]) points_[q].stamp = near_v;
  const bool v_locked = (points_[v].flags & flag_locked) != 0;
  const std::uint32_t counted = next_stamp();
  std::uint32_t at_edge = 0;
  PointId third[2] = {none, none};
  for (TriangleId t : star(u)) {
    if (!has_corner(t, v)) continue;
    if (at_edge == 2) return false;
    const PointId q = third_corner(t, u, v);
    if (std::exchange(points_[q].stamp, counted) == counted) return false;  // doubled triangles
    third[at_edge++] = q;
  }
  if (at_edge != (border(u) ? 1u : 2u)) return false;
  std::uint32_t others_in_common = 0;
  for (TriangleId t : star(u))
    for (PointId q : corners_[t]) {
      if (q == u || q == v || points_[q].stamp == counted) continue;
      if (points_[q].stamp == near_v) ++others_in_common;
      // A new edge between locked points might exist already in the neighbouring cell.
      else if (v_locked && (points_[q].flags & flag_locked) != 0)
        return false;
      points_[q].stamp = counted;
    }
  if (others_in_common == 1 && border(u)) return closes_hole(u, v);
  if (others_in_common != 0) return false;
  if (points_[u].star_size == at_edge) return ear_has_neighbour(u, v);
  return !doubles_triangle(u, v, third[0], third[1]);
}

/// Would a triangle that u → v modifies have the corners of one that v has already? Between three locked
/// points that one may be the neighbouring cell's.
bool SubstitutionKernel::doubles_triangle(PointId u, PointId v) const {
  for (TriangleId t : star(u)) {
    if (has_corner(t, v)) continue;
    const auto& c = corners_[t];
    const int i = c[0] == u ? 0 : c[1] == u ? 1 : 2;
    const PointId a = c[(i + 1) % 3], b = c[(i + 2) % 3];
    if ((points_[v].flags & points_[a].flags & points_[b].flags & flag_locked) != 0) return true;
    for (TriangleId s : star(v))
      if (has_corner(s, a) && has_corner(s, b)) return true;
  }
  return false;
}

/// The same where w and x are all that u and v have in common as neighbours: a triangle around u can have a
/// double around v only if both its other corners are among these.
bool SubstitutionKernel::doubles_triangle(PointId u, PointId v, PointId w, PointId x) const {
  const bool v_locked = (points_[v].flags & flag_locked) != 0;
  for (TriangleId t : star(u)) {
    const PointId a = next_corner(t, u), b = previous_corner(t, u);
    if (a == v || b == v) continue;
    if (v_locked && (points_[a].flags & points_[b].flags & flag_locked) != 0) return true;
    if ((a != w && a != x) || (b != w && b != x)) continue;
    for (TriangleId s : star(v))
      if (has_corner(s, a) && has_corner(s, b)) return true;
  }
  return false;
}

/// u → v may close a border loop of three edges (u, v, w). What appears there lies up to the loop's edge
/// length from the surface, however near the samples are: that length is the least error of the substitution.
bool SubstitutionKernel::closes_hole(PointId u, PointId v) {
  for (PointId w : neighbours(u)) {
    if (w == v || edge_triangles(u, w) != 1 || edge_triangles(v, w) != 1) continue;
    // Between two locked points the edge may be the cell's border only.
    if ((points_[v].flags & flag_locked) != 0 && (points_[w].flags & flag_locked) != 0) return false;
    const Vec3f a = position_[u] - position_[v], b = position_[u] - position_[w];
    closed_hole_ = std::sqrt(std::max(dot(a, a), dot(b, b)));
    hole_corner_ = w;
    return !doubles_triangle(u, v);
  }
  return false;
}

/// No point may be left without a triangle, and something must be left to take the samples. Without the link
/// condition the triangles around the corners that lose one need not change themselves, so they are guarded.
bool SubstitutionKernel::loosely_legal(PointId u, PointId v) {
  std::uint32_t going = 0;
  for (TriangleId t : star(u)) {
    if (!has_corner(t, v)) continue;
    ++going;
    for (PointId w : corners_[t]) {
      if (w == u || w == v) continue;
      const auto around = star(w);
      const auto lost = std::count_if(around.begin(), around.end(),
                                      [&](TriangleId s) { return has_corner(s, u) && has_corner(s, v); });
      if (static_cast<std::size_t>(lost) == around.size()) return false;
      for (TriangleId s : around)
        if (!has_corner(s, u)) guarded_.push_back(s);
    }
  }
  return going > 0 && points_[v].star_size > going;
}

std::uint32_t SubstitutionKernel::edge_triangles(PointId p, PointId q) const {
  const auto ring = star(p);
  return static_cast<std::uint32_t>(
      std::count_if(ring.begin(), ring.end(), [&](TriangleId t) { return has_corner(t, q); }));
}

void SubstitutionKernel::update_border(PointId p) {
  points_[p].flags &= static_cast<std::uint8_t>(~flag_border);
  if (walked_neighbours(p).size() != star(p).size()) points_[p].flags |= flag_border;
}

/// u is the tip of an ear, its only triangle (u, v, w): the triangle across (v, w) must be there to take its
/// samples and its birth. Without it the ear is a whole component, or ends at the cell's border.
bool SubstitutionKernel::ear_has_neighbour(PointId u, PointId v) const {
  const auto& c = corners_[star(u)[0]];
  const PointId w = c[0] + c[1] + c[2] - u - v;
  const auto around = star(v);
  return points_[u].star_size == 1 && std::any_of(around.begin(), around.end(), [&](TriangleId t) {
           return has_corner(t, w) && !has_corner(t, u);
         });
}

bool SubstitutionKernel::keeps_orientation(PointId u, PointId v) const {
  const Vec3f pu = position_[u], pv = position_[v];
  for (TriangleId t : star(u)) {
    const auto& c = corners_[t];
    if (c[0] == v || c[1] == v || c[2] == v) continue;
    const int i = c[0] == u ? 0 : c[1] == u ? 1 : 2;
    const Vec3f a = position_[c[(i + 1) % 3]], b = position_[c[(i + 2) % 3]];
    const Vec3f before = cross(a - pu, b - pu);
    const Vec3f after = cross(a - pv, b - pv);
    // Squares of products of edges of 2^16 grid units and more leave the range of float.
    const double d = static_cast<double>(dot(before, after));
    const double bound = least_cosine * least_cosine * static_cast<double>(dot(before, before)) *
                         static_cast<double>(dot(after, after));
    if (!(d > 0) || d * d < bound || !(dot(after, after) > 0)) return false;
  }
  return true;
}

/// Seen from above, no triangle of a field of heights turns over, is seen from its edge, or becomes a needle
/// that only the grid makes: postings in a line are so to within a step.
bool SubstitutionKernel::stays_upright(PointId u, PointId v) const {
  const auto up_at = [this](PointId p) { return vec_cast<double>(vertical_->up(position_[p])); };
  const Vec3d pv = vec_cast<double>(position_[v]), up_v = up_at(v), up = normalized(up_v);
  const auto run = [&](Vec3d e) { return dot(e, e) - dot(e, up) * dot(e, up); };  // squared, seen from above
  for (TriangleId t : star(u)) {
    if (has_corner(t, v)) continue;
    const PointId a = next_corner(t, u), b = previous_corner(t, u);
    const Vec3d pa = vec_cast<double>(position_[a]) - pv, pb = vec_cast<double>(position_[b]) - pv;
    const Vec3d normal = cross(pa, pb);
    const double longest = std::sqrt(std::max({run(pa), run(pb), run(pb - pa)}));
    const double least = std::max(double{least_uprightness} * length(normal), least_width * longest);
    for (const Vec3d& here : {up_v, up_at(a), up_at(b)})
      if (!(dot(normal, here) > least)) return false;
  }
  return true;
}

/// Each wedge of u goes to the wedge of v that it shares a triangle with.
bool SubstitutionKernel::map_wedges(PointId u, PointId v) {
  wedge_map_.clear();
  const auto corner = [this](TriangleId t, PointId p) {
    const auto& c = corners_[t];
    return wedges_[t][c[0] == p ? 0 : c[1] == p ? 1 : 2];
  };
  const auto find = [this](std::uint32_t wedge) {
    return std::find_if(wedge_map_.begin(), wedge_map_.end(),
                        [&](const auto& m) { return m.first == wedge; });
  };
  for (TriangleId t : star(u)) {
    if (!has_corner(t, v)) continue;
    const std::uint32_t from = corner(t, u), to = corner(t, v);
    const auto known = find(from);
    if (known == wedge_map_.end())
      wedge_map_.emplace_back(from, to);
    else if (known->second != to)
      return false;
  }
  for (TriangleId t : star(u))
    if (find(corner(t, u)) == wedge_map_.end()) return false;
  std::sort(wedge_map_.begin(), wedge_map_.end());
  return true;
}

bool SubstitutionKernel::legal(PointId u, PointId v) {
  if (!can_move(u) || removed(v) || !may_join(u, v)) return false;
  closed_hole_ = 0;
  guarded_.clear();
  return (loose_topology_ ? loosely_legal(u, v) : link_condition(u, v)) &&
         (vertical_ ? stays_upright(u, v) : keeps_orientation(u, v)) && (wedges_.empty() || map_wedges(u, v));
}

bool SubstitutionKernel::legal_pair(PointId u, PointId v) {
  if (!can_move(u) || removed(v) || star(u).empty() || star(v).empty()) return false;
  closed_hole_ = 0;
  guarded_.clear();
  if (doubles_triangle(u, v) || !keeps_orientation(u, v)) return false;
  if (wedges_.empty()) return true;
  wedge_map_.clear();
  const std::uint32_t to = vertex_at(star(v)[0], v);
  for (TriangleId t : star(u)) wedge_map_.emplace_back(vertex_at(t, u), to);
  std::sort(wedge_map_.begin(), wedge_map_.end());
  wedge_map_.erase(std::unique(wedge_map_.begin(), wedge_map_.end()), wedge_map_.end());
  return true;
}

/// Triangles that take the samples and are reborn: those that u → v modifies; when it modifies none (u is the
/// tip of an ear), what is left around v, so that v cannot go before u.
void SubstitutionKernel::choose_targets(PointId u, PointId v) {
  targets_.clear();
  for (TriangleId t : star(u))
    if (!has_corner(t, v)) targets_.push_back(t);
  targets_apart_ = targets_.empty();
  if (!targets_apart_) return;
  for (TriangleId t : star(v))
    if (!has_corner(t, u)) targets_.push_back(t);
}

/// What was put together for u → v; none if nothing moves.
Replacement SubstitutionKernel::describe(PointId u, PointId v) {
  target_corners_.clear();
  for (TriangleId t : targets_) {
    auto c = corners_[t];
    for (PointId& p : c)
      if (p == u) p = v;
    target_corners_.push_back(c);
  }
  return {patch_, leaving_, targets_, target_corners_, closed_hole_};
}

Replacement SubstitutionKernel::replacement(PointId u, PointId v) {
  patch_.assign(star(u).begin(), star(u).end());
  leaving_.assign(1, u);
  choose_targets(u, v);
  return describe(u, v);
}

Replacement SubstitutionKernel::absorption(std::span<const PointId> members, PointId v) {
  patch_.clear();
  guarded_.clear();
  leaving_.assign(members.begin(), members.end());
  for (PointId p : members)
    for (TriangleId t : star(p))
      if (corners_[t][0] == p) patch_.push_back(t);  // each triangle once
  targets_.assign(star(v).begin(), star(v).end());
  targets_apart_ = true;
  closed_hole_ = 0;
  return describe(none, none);
}

float SubstitutionKernel::birth_error() const {
  float error = 0;
  for (const auto* triangles : {&patch_, targets_apart_ ? &targets_ : &guarded_, &guarded_})
    for (TriangleId t : *triangles) error = std::max(error, birth_errors_[t]);
  return error;
}

void SubstitutionKernel::remove_from_star(PointId p, TriangleId t) {
  TriangleId* const first = arena_.data() + points_[p].star_begin;
  TriangleId* const last = first + points_[p].star_size;
  TriangleId* const at = std::find(first, last, t);
  std::copy(at + 1, last, at);
  --points_[p].star_size;
}

void SubstitutionKernel::apply(PointId u, PointId v, ErrorCode8 error, std::vector<Child>& children,
                               std::vector<TriangleId>& changed) {
  if (wedges_.empty()) {
    children.push_back({first_vertex_[u], first_vertex_[v], error, false});
  } else {
    for (std::size_t i = 0; i < wedge_map_.size(); ++i)
      children.push_back({wedge_map_[i].first, wedge_map_[i].second, error, i > 0});
  }
  // v's new star is at the arena's end: what it had, less what dies, and u's modified triangles. In a fan it
  // is there already, and stays: copied for each child, a centre of n neighbours would take n² places.
  if (points_[v].star_begin + points_[v].star_size != arena_.size()) {
    const auto begin = static_cast<std::uint32_t>(arena_.size());
    for (std::uint32_t i = 0; i < points_[v].star_size; ++i)
      arena_.push_back(arena_[points_[v].star_begin + i]);
    points_[v].star_begin = begin;
  }
  arena_.erase(std::remove_if(arena_.begin() + points_[v].star_begin, arena_.end(),
                              [&](TriangleId t) { return has_corner(t, u); }),
               arena_.end());
  for (std::uint32_t i = 0; i < points_[u].star_size; ++i) {
    const TriangleId t = arena_[points_[u].star_begin + i];
    auto& c = corners_[t];
    if (has_corner(t, v)) {
      alive_[t] = 0;
      --live_triangles_;
      for (PointId q : c)
        if (q != u && q != v) remove_from_star(q, t);
      continue;
    }
    arena_.push_back(t);
    for (int k = 0; k < 3; ++k) {
      if (c[k] != u) continue;
      c[k] = v;
      if (wedges_.empty()) continue;
      for (const auto& [from, to] : wedge_map_)
        if (wedges_[t][k] == from) {
          wedges_[t][k] = to;
          break;
        }
    }
  }
  changed.insert(changed.end(), targets_.begin(), targets_.end());
  changed.insert(changed.end(), guarded_.begin(), guarded_.end());
  points_[v].star_size = static_cast<std::uint32_t>(arena_.size()) - points_[v].star_begin;
  points_[u].star_size = 0;
  points_[u].flags |= flag_removed;
  if (closed_hole_ > 0) {
    update_border(v);
    update_border(hole_corner_);
  }
}

void SubstitutionKernel::absorb(std::span<const PointId> members, PointId v, ErrorCode8 error,
                                std::vector<Child>& children, std::vector<TriangleId>& changed) {
  std::vector<std::uint32_t> vertices;
  for (TriangleId t : patch_)
    for (std::uint32_t vertex : wedges_.empty() ? corners_[t] : wedges_[t])
      vertices.push_back(wedges_.empty() ? first_vertex_[vertex] : vertex);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    children.push_back({vertices[i], first_vertex_[v], error, i > 0});
  for (TriangleId t : patch_) {
    alive_[t] = 0;
    --live_triangles_;
  }
  for (PointId p : members) {
    points_[p].star_size = 0;
    points_[p].flags |= flag_removed;
  }
  changed.insert(changed.end(), targets_.begin(), targets_.end());
}

void SubstitutionKernel::rebirth(std::span<const TriangleId> changed, float error) {
  for (TriangleId t : changed) birth_errors_[t] = error;
}

}  // namespace cuesta
