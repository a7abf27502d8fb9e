#pragma once
/// A cut of a view-dependence tree, kept between frames: active-nodes list, drawing list, and dependencies
/// that are checked while it runs. Source: as view_dependence_tree.h, real-time part; Livny et al. 2006, §3.3
/// and §5.
///   - a collapse is legal while the parents of all neighbours of the two vertices come later than the merged
///   node:
///     else it is put off;
///   - a split is legal while all neighbours come earlier than the node: else the later ones are split first.
/// The list is walked once a frame: O(active nodes) and what changes.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/error_scale.h"
#include "tools/baselines/view_dependence_tree.h"

namespace cuesta::baselines {

struct VdtReport {
  std::uint64_t triangles = 0, active_nodes = 0;  ///< after the call
  std::uint32_t splits = 0;                       ///< forced ones included
  std::uint32_t forced_splits = 0;                ///< for the sake of another node
  std::uint32_t collapses = 0;
  std::uint32_t put_off = 0;  ///< collapses that the view allows and a neighbour does not
};

class VdtCut {
 public:
  /// Begins with the coarsest cut.   @param tree  outlives the cut.
  explicit VdtCut(const ViewDependenceTree& tree);

  /// Splits every active node with sse > tau, and collapses pairs whose node has sse ≤ tau where that is
  /// legal.
  /// @param tau  pixels, > 0   @pre scale is perspective, in the grid of the tree.
  /// @post legal; no active node has sse > tau.   @cost O(active nodes + changes).
  VdtReport adapt(const ErrorScale& scale, double tau);
  /// Splits everything.
  void refine_fully();

  /// Three vertices per drawn triangle, without gaps.
  std::span<const std::array<std::uint32_t, 3>> drawing_list() const {
    return std::span(drawn_).first(triangle_count_);
  }
  /// Nodes of the cut, in no order.
  std::vector<NodeId> active_nodes() const;
  bool is_active(NodeId n) const { return node_of_[tree_.vertex_of(n)] == n; }
  bool may_collapse(NodeId n) const;
  /// sse as adapt() takes it.
  double sse(const ErrorScale& scale, NodeId n) const;

  /// Of the active-nodes list and of which node and entry are at each vertex; without the drawing list.
  std::uint64_t bytes() const;

 private:
  /// An active node with what is needed to test it and its parent; both are at its vertex. 32 bytes.
  struct Entry {
    Vec3f position;
    float split_error, split_radius;        // of the node; a leaf's error is negative
    float collapse_error, collapse_radius;  // of its parent, if the node is its left child, else infinite
    NodeId node;
  };
  static_assert(sizeof(Entry) == 32);

  Entry entry_for(NodeId n) const;
  void activate(NodeId n);
  void force_split(NodeId n, VdtReport& report);
  NodeId later_neighbour(NodeId n) const;
  void split(NodeId n);
  void collapse(NodeId n);
  void collapse_from(NodeId n, const ErrorScale& scale, double limit, VdtReport& report);
  bool is_drawn(std::uint32_t t) const { return place_[t] < triangle_count_; }
  void swap_places(std::uint32_t a, std::uint32_t b);

  const ViewDependenceTree& tree_;
  std::vector<Entry> entries_;
  std::vector<NodeId> node_of_;  // of each vertex: the active node there, or no_node
  std::vector<std::uint32_t> entry_of_;
  std::vector<std::array<std::uint32_t, 3>> drawn_;  // all triangles, drawn ones first
  std::vector<std::uint32_t> place_, at_place_;
  std::uint32_t triangle_count_ = 0;
  std::vector<NodeId> stack_, candidates_;
};

}  // namespace cuesta::baselines
