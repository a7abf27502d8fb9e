#pragma once
/// The mutable mesh of one cell and its one operation, the substitution u → v.
/// Topology is per point (a wedge group is one point); wedges follow their point.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hierarchy/cell_mesh.h"
#include "hierarchy/replacement.h"
#include "hierarchy/vertical_deviation.h"

namespace cuesta {

inline constexpr std::uint32_t none = 0xFFFFFFFFu;

/// Flat arrays, about 30 bytes per triangle and 40 per point, plus stars in one arena that only grows. Of
/// samples it knows nothing: SurfaceSamples measures what replacement() says, now or later.
class SubstitutionKernel {
 public:
  explicit SubstitutionKernel(const CellMesh& cell);

  std::uint32_t point_count() const { return static_cast<std::uint32_t>(position_.size()); }
  std::uint32_t live_triangles() const { return live_triangles_; }
  bool removed(PointId p) const { return (points_[p].flags & flag_removed) != 0; }
  bool can_move(PointId p) const { return (points_[p].flags & (flag_removed | flag_locked)) == 0; }
  std::span<const TriangleId> star(PointId p) const {
    return {arena_.data() + points_[p].star_begin, points_[p].star_size};
  }
  const std::array<PointId, 3>& corners(TriangleId t) const { return corners_[t]; }

  /// Distinct neighbours of p, valid until the next call.
  std::span<const PointId> neighbours(PointId p);

  bool is_field_of_heights() const { return vertical_.has_value(); }

  /// True if u → v needs no look at geometry to be refused: u is on a border and v is not, say.
  bool may_join(PointId u, PointId v) const { return loose_topology_ || !(border(u) && !border(v)); }

  /// True if the triangles around every point that can move form one fan or half-fan; at the start.
  bool is_manifold() const { return manifold_; }
  /// Loops that keep a surface from becoming small: handles, holes, and borders beyond one a component; at
  /// the start.
  std::uint32_t loops() const { return loops_; }
  /// Per point, the component it is in, numbered by their lowest points; at the start.
  std::span<const std::uint32_t> components() const { return component_; }
  std::uint32_t component_count() const { return component_count_; }
  /// From now on legal() lets go of the link condition and of borders: handles close, sheets touch along
  /// edges. Errors stay measured and saturated. For surfaces that are mostly loops, as cracked photogrammetry
  /// becomes.
  void loosen_topology() { loose_topology_ = true; }

  /// Link condition, borders, seams, locked neighbours, inversion: is u → v legal now?
  bool legal(PointId u, PointId v);
  /// The same for points that share no triangle and may be of different components: all triangles around u go
  /// over to v, and only seams, orientation and doubled triangles are looked at. @pre topology is loose
  bool legal_pair(PointId u, PointId v);
  bool on_border(PointId p) const { return border(p); }
  /// Whether a triangle has both as corners.
  bool adjacent(PointId u, PointId v) const { return edge_triangles(u, v) > 0; }
  std::uint32_t edge_triangles(PointId p, PointId q) const;  ///< that have both as corners
  /// The vertex that triangle t has at its corner at p.
  std::uint32_t vertex_at(TriangleId t, PointId p) const {
    if (wedges_.empty()) return first_vertex_[p];
    const auto& c = corners_[t];
    return wedges_[t][c[0] == p ? 0 : c[1] == p ? 1 : 2];
  }
  /// What u → v, which must be legal, replaces.
  Replacement replacement(PointId u, PointId v);
  /// What a whole component, `members` being all its points, leaves to the triangles around v, a point of
  /// another component. @pre no member is locked, v has triangles.
  Replacement absorption(std::span<const PointId> members, PointId v);
  /// Largest birth error of the triangles around u.
  float birth_error_around(PointId u) const {
    float error = 0;
    for (TriangleId t : star(u)) error = std::max(error, birth_errors_[t]);
    return error;
  }
  /// Largest birth error of the triangles that the last replacement depends on.
  float birth_error() const;
  /// Applies u → v, the last replacement; appends the wedge substitutions with this error to `children`, and
  /// the triangles it changed to `changed`.
  void apply(PointId u, PointId v, ErrorCode8 error, std::vector<Child>& children,
             std::vector<TriangleId>& changed);
  /// The third corner of the border loop that the substitution applied last closed, or none: it and v may
  /// have left the border, so what may join them has changed.
  PointId closed_hole_corner() const { return closed_hole_ > 0 ? hole_corner_ : none; }
  /// Removes the component, the last replacement: all its vertices go to v together. Arguments as apply().
  void absorb(std::span<const PointId> members, PointId v, ErrorCode8 error, std::vector<Child>& children,
              std::vector<TriangleId>& changed);

  /// The fan that changed these triangles is complete: they are reborn with its error. (Its ball is
  /// cover_fans()'.)
  void rebirth(std::span<const TriangleId> changed, float error);

  std::span<const Vec3f> positions() const { return position_; }  ///< per point, about the cell's own origin
  Vec3i grid_position(PointId p) const {
    return vec_cast<std::int32_t>(vec_cast<double>(position_[p])) + origin_;
  }
  std::uint32_t first_vertex(PointId p) const { return first_vertex_[p]; }
  Vec3i origin() const { return origin_; }  ///< grid position of the cell's own origin
  const std::optional<LocalVertical>& vertical() const { return vertical_; }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(corners_.size()); }
  bool alive(TriangleId t) const { return alive_[t] != 0; }
  /// The vertices at the corners of t.
  const std::array<std::uint32_t, 3>& vertices(TriangleId t) const {
    return wedges_.empty() ? corners_[t] : wedges_[t];
  }
  float birth_error(TriangleId t) const { return birth_errors_[t]; }

 private:
  static constexpr std::uint8_t flag_removed = 1, flag_locked = 2, flag_border = 4;
  /// What a look at a point needs in one place, but for where it is.
  struct Point {
    std::uint32_t star_begin = 0, star_size = 0;  // in the arena
    std::uint32_t stamp = 0;                      // scratch: when it was seen last
    std::uint8_t flags = 0;
  };

  bool border(PointId p) const { return (points_[p].flags & flag_border) != 0; }
  bool has_corner(TriangleId t, PointId p) const {
    const auto& c = corners_[t];
    return c[0] == p || c[1] == p || c[2] == p;
  }
  /// The corners of t after and before p, counter-clockwise.
  PointId next_corner(TriangleId t, PointId p) const {
    const auto& c = corners_[t];
    return c[0] == p ? c[1] : c[1] == p ? c[2] : c[0];
  }
  PointId previous_corner(TriangleId t, PointId p) const {
    const auto& c = corners_[t];
    return c[0] == p ? c[2] : c[1] == p ? c[0] : c[1];
  }
  PointId third_corner(TriangleId t, PointId p, PointId q) const {
    const auto& c = corners_[t];
    return c[0] != p && c[0] != q ? c[0] : c[1] != p && c[1] != q ? c[1] : c[2];
  }
  void build_stars();
  void walk_edges();
  void walk_edges_around(PointId p, std::uint64_t& rings);
  bool is_manifold_at(PointId p);
  void find_components(std::uint64_t rings);
  std::span<const PointId> walked_neighbours(PointId p);
  bool link_condition(PointId u, PointId v);
  bool loosely_legal(PointId u, PointId v);
  bool doubles_triangle(PointId u, PointId v) const;
  bool doubles_triangle(PointId u, PointId v, PointId w, PointId x) const;
  bool closes_hole(PointId u, PointId v);
  void update_border(PointId p);
  bool ear_has_neighbour(PointId u, PointId v) const;
  bool keeps_orientation(PointId u, PointId v) const;
  bool stays_upright(PointId u, PointId v) const;
  bool map_wedges(PointId u, PointId v);
  Replacement describe(PointId u, PointId v);
  void choose_targets(PointId u, PointId v);
  void remove_from_star(PointId p, TriangleId t);
  std::uint32_t next_stamp();

  Vec3i origin_;                           // grid position of the local frame
  std::optional<LocalVertical> vertical_;  // of a field of heights
  std::vector<Vec3f> position_;            // per point, local, exact integers
  std::vector<Point> points_;
  std::vector<TriangleId> arena_;
  std::vector<std::uint32_t> first_vertex_;           // per point
  std::vector<std::array<std::uint32_t, 3>> wedges_;  // per triangle, vertices; empty without wedges

  std::vector<std::array<PointId, 3>> corners_;  // per triangle
  std::vector<std::uint8_t> alive_;
  std::vector<float> birth_errors_;  // per triangle
  std::uint32_t live_triangles_ = 0;

  // Scratch of one substitution.
  std::uint32_t current_stamp_ = 0;
  std::vector<PointId> ring_;
  std::vector<TriangleId> patch_, targets_;  // triangles that go or change; those that take their samples
  std::vector<std::array<PointId, 3>> target_corners_;
  bool targets_apart_ = false;       // targets are no part of the patch
  std::vector<TriangleId> guarded_;  // reborn too: nothing at the corners of what goes may change before it
  std::vector<PointId> leaving_;
  bool loose_topology_ = false;
  bool oriented_ = true;  // no two triangles run along an edge in one direction
  bool manifold_ = true;
  std::uint32_t loops_ = 0;
  std::vector<std::uint32_t> component_;
  std::uint32_t component_count_ = 0;
  float closed_hole_ = 0;  // > 0: the substitution closes a hole with edges up to this length
  PointId hole_corner_ = none;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> wedge_map_;
};

}  // namespace cuesta
