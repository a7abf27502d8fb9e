#pragma once
/// Nearest point on a triangle soup: a four-wide tree of boxes over triangles in flat arrays. Exists to judge
/// the rest of the project, so it shares no geometry code with it. Source: C. Ericson, "Real-Time Collision
/// Detection", 2005, §5.1.5; needle triangles fall back to their edges. Units: the mesh's own. Boxes are f32
/// about the tree's centre and padded outwards, distances are f64; coordinates up to 1e18. Threads: const
/// calls are concurrent.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "ooc/vec.h"

namespace cuesta::measure {

inline constexpr std::uint32_t no_triangle = 0xffffffffu;

/// Where a query ended. Without a triangle nearer than the caller's bound: triangle == slot == no_triangle,
/// and distance_sq is that bound.
struct NearestPoint {
  double distance_sq = std::numeric_limits<double>::infinity();  ///< units²
  std::uint32_t triangle = no_triangle;                          ///< as the caller numbered it
  std::uint32_t slot = no_triangle;                              ///< hint for a query close by
  Vec3d point;                                                   ///< on that triangle
};

/// Squared distance from `p` to the triangle a, a + ab, a + ac; *nearest is the point that attains it.
/// Degenerate triangles (edges, points) are fine. @cost about 20 ns.
double squared_distance(Vec3d p, Vec3d a, Vec3d ab, Vec3d ac, Vec3d* nearest);

/// About 105 bytes per triangle, which it owns; building needs 16 more for a while.
class TriangleTree {
 public:
  /// Triangles with a corner that is not finite are left out and counted.
  /// @pre  indices are in range, fewer than 2^29 triangles.   @cost O(n log n), in the calling TBB arena.
  TriangleTree(std::span<const Vec3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles);

  bool empty() const { return ids_.empty(); }
  std::uint64_t triangles_left_out() const { return left_out_; }

  /// Nearest point to `p` among all triangles nearer than sqrt(bound_sq). `hint_slot` (the slot of an earlier
  /// answer) only speeds it up: distance_sq is the same bits for every hint.
  /// @cost about 0.5 µs with a good hint on 10^5 triangles; no allocation.
  NearestPoint nearest(Vec3d p, std::uint32_t hint_slot = no_triangle,
                       double bound_sq = std::numeric_limits<double>::infinity()) const;

 private:
  static constexpr std::uint32_t leaf_bit =
      0x80000000u;  ///< a child is a node, or leaf_bit | (count - 1) << 29 | slot
  static constexpr std::uint32_t leaf_size = 4;
  struct Node {
    float lo[3][4], hi[3][4];
    std::uint32_t child[4];
  };
  struct Triangle {
    Vec3d a, ab, ac;
  };
  struct Item {
    Vec3f centre;
    std::uint32_t id;
  };
  struct Source;

  void collect(const Source& source, std::vector<Item>& items);
  Box3d build(const Source& source, std::span<Item> items, std::uint32_t first, std::uint32_t node);
  Box3d build_child(const Source& source, std::span<Item> items, std::uint32_t first, std::uint32_t next_node,
                    std::uint32_t& child);
  Box3d fill_leaf(const Source& source, std::span<const Item> items, std::uint32_t first);
  void set_lane(Node& node, int lane, const Box3d& box) const;
  void test(Vec3d local, std::uint32_t slot, NearestPoint& best) const;

  Vec3d centre_;
  double pad_ = 0;
  std::uint64_t left_out_ = 0;
  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace cuesta::measure
