#pragma once
/// View-dependence tree (VDT): a binary tree of vertices by edge collapse, what the fan-hierarchy is compared
/// with. Source: El-Sana, Varshney, "Generalized view-dependent simplification", Computer Graphics Forum
/// 18(3), 1999; as it is described in Livny et al., "Dual adaptive paths for multiresolution hierarchies",
/// 2006, §5. Deviations:
///   - the merged vertex is one of the two (half-edge collapse), so no vertex is added;
///   - edges are collapsed by rising quadric distance (Garland, Heckbert 1997), the root of the mean squared
///   distance
///     to the planes, made monotone up the tree; it bounds nothing;
///   - pointers are 32-bit numbers in flat arrays.
/// Nodes are numbered in the order in which they come to be, leaves first: that enumeration is the implicit
/// dependency.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ooc/vec.h"

namespace cuesta::baselines {

using NodeId = std::uint32_t;
inline constexpr NodeId no_node = 0xFFFFFFFFu;

/// A corner of a triangle: triangle · 4 + 0, 1 or 2.
using CornerRef = std::uint32_t;

/// Edge collapse right → left. 28 bytes.
struct InternalNode {
  NodeId left, right;  ///< left keeps its vertex, which is the node's
  std::uint32_t vertex;
  float error;   ///< grid units, ≥ those of left and right
  float radius;  ///< about the vertex: holds the balls of left and right, and the star
  std::uint32_t
      first_corner;  ///< its moved and kept corners, then its removed triangles, up to the next node's
  std::uint16_t moved, kept;  ///< corners that go from right's vertex to left's; corners of left's that stay
};
static_assert(sizeof(InternalNode) == 28);

struct ViewDependenceTree {
  std::uint32_t leaves = 0;            ///< leaf v is vertex v
  std::vector<NodeId> parent;          ///< of all nodes; no_node: a root
  std::vector<InternalNode> internal;  ///< node leaves + i; one more at the end, for its first_corner
  std::vector<CornerRef> corners;      ///< of all internal nodes; removed triangles: triangle · 4
  /// Corners of each triangle as they are just before it is removed, or at the end.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Vec3f> positions;  ///< grid units

  std::uint32_t internal_nodes() const { return static_cast<std::uint32_t>(internal.size() - 1); }
  bool is_leaf(NodeId n) const { return n < leaves; }
  const InternalNode& node(NodeId n) const { return internal[n - leaves]; }
  std::uint32_t vertex_of(NodeId n) const { return is_leaf(n) ? n : node(n).vertex; }
  float error_of(NodeId n) const { return is_leaf(n) ? 0 : node(n).error; }
  std::span<const CornerRef> moved(NodeId n) const {
    return std::span(corners).subspan(node(n).first_corner, node(n).moved);
  }
  /// Moved and kept: the star of the node when it comes to be.
  std::span<const CornerRef> star(NodeId n) const {
    return std::span(corners).subspan(node(n).first_corner, std::size_t{node(n).moved} + node(n).kept);
  }
  std::span<const CornerRef> removed(NodeId n) const {
    const InternalNode& r = node(n);
    const std::size_t first = std::size_t{r.first_corner} + r.moved + r.kept;
    return std::span(corners).subspan(first, internal[n - leaves + 1].first_corner - first);
  }
  /// Of nodes and their lists: 4 per node, 28 per internal node, 4 per entry; without positions and
  /// triangles.
  std::uint64_t bytes() const;
};

/// Collapses edges until none can be: a closed component ends as a tetrahedron or a little more.
/// Every collapse keeps the surface manifold (link condition), its borders, and turns no triangle over.
/// @param positions  integers below 2^24   @pre manifold with border; every vertex is used.
/// @cost one thread, O(n log n) by a heap.
ViewDependenceTree build_view_dependence_tree(std::span<const Vec3f> positions,
                                              std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace cuesta::baselines
