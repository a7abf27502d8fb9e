#include "tools/baselines/vdt_cut.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "ooc/check.h"

namespace cuesta::baselines {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

/// True if error / (tau · scale) is above 1 at this distance of the eye from the centre; `limit` is tau ·
/// unit.
bool too_coarse(float error, float radius, double distance, double limit) {
  return static_cast<double>(error) >
         limit * std::max(distance - static_cast<double>(radius), ErrorScale::nearest);
}

}  // namespace

VdtCut::VdtCut(const ViewDependenceTree& tree) : tree_(tree), drawn_(tree.triangles) {
  const auto triangles = static_cast<std::uint32_t>(drawn_.size());
  node_of_.assign(tree.positions.size(), no_node);
  entry_of_.assign(tree.positions.size(), 0);
  place_.resize(triangles);
  at_place_.resize(triangles);
  std::iota(place_.begin(), place_.end(), 0u);
  std::iota(at_place_.begin(), at_place_.end(), 0u);
  triangle_count_ = triangles;
  for (NodeId n = tree.leaves; n < tree.parent.size(); ++n)
    for (const CornerRef r : tree.removed(n)) swap_places(place_[r / 4], --triangle_count_);
  for (NodeId n = 0; n < tree.parent.size(); ++n)
    if (tree.parent[n] == no_node) activate(n);
}

void VdtCut::swap_places(std::uint32_t a, std::uint32_t b) {
  if (a == b) return;
  std::swap(drawn_[a], drawn_[b]);
  std::swap(at_place_[a], at_place_[b]);
  place_[at_place_[a]] = a;
  place_[at_place_[b]] = b;
}

VdtCut::Entry VdtCut::entry_for(NodeId n) const {
  Entry e{tree_.positions[tree_.vertex_of(n)], -1, 0, infinite, 0, n};
  if (!tree_.is_leaf(n)) e.split_error = tree_.node(n).error, e.split_radius = tree_.node(n).radius;
  if (const NodeId p = tree_.parent[n]; p != no_node && tree_.node(p).left == n)
    e.collapse_error = tree_.node(p).error, e.collapse_radius = tree_.node(p).radius;
  return e;
}

void VdtCut::activate(NodeId n) {
  const std::uint32_t v = tree_.vertex_of(n);
  node_of_[v] = n;
  entry_of_[v] = static_cast<std::uint32_t>(entries_.size());
  entries_.push_back(entry_for(n));
}

/// A neighbour that comes later than n, or no_node. While there is none, all of the star is drawn.
NodeId VdtCut::later_neighbour(NodeId n) const {
  for (const CornerRef r : tree_.star(n)) {
    const std::uint32_t place = place_[r / 4];
    if (place >= triangle_count_) continue;
    for (const std::uint32_t v : drawn_[place])
      if (node_of_[v] > n) return node_of_[v];
  }
  return no_node;
}

bool VdtCut::may_collapse(NodeId n) const {
  const InternalNode& node = tree_.node(n);
  if (!is_active(node.left) || !is_active(node.right)) return false;
  for (const CornerRef r : tree_.star(n))
    for (const std::uint32_t v : drawn_[place_[r / 4]])
      if (tree_.parent[node_of_[v]] < n) return false;
  return true;
}

void VdtCut::split(NodeId n) {
  const InternalNode& node = tree_.node(n);
  const std::uint32_t from = tree_.vertex_of(node.right);
  node_of_[node.vertex] = node.left;
  entries_[entry_of_[node.vertex]] = entry_for(node.left);
  activate(node.right);
  for (const CornerRef r : tree_.moved(n)) drawn_[place_[r / 4]][r % 4] = from;
  for (const CornerRef r : tree_.removed(n)) swap_places(place_[r / 4], triangle_count_++);
}

void VdtCut::collapse(NodeId n) {
  const InternalNode& node = tree_.node(n);
  const std::uint32_t from = tree_.vertex_of(node.right);
  for (const CornerRef r : tree_.removed(n)) swap_places(place_[r / 4], --triangle_count_);
  for (const CornerRef r : tree_.moved(n)) drawn_[place_[r / 4]][r % 4] = node.vertex;
  const std::uint32_t gone = entry_of_[from];
  entries_[gone] = entries_.back();
  entry_of_[tree_.vertex_of(entries_[gone].node)] = gone;
  entries_.pop_back();
  node_of_[from] = no_node;
  node_of_[node.vertex] = n;
  entries_[entry_of_[node.vertex]] = entry_for(n);
}

void VdtCut::force_split(NodeId n, VdtReport& report) {
  stack_.assign(1, n);
  while (!stack_.empty()) {
    const NodeId top = stack_.back();
    if (const NodeId later = later_neighbour(top); later != no_node) {
      stack_.push_back(later);
      continue;
    }
    stack_.pop_back();
    split(top);
    ++report.splits;
    report.forced_splits += top != n;
  }
}

/// Collapses into n, and on upwards while the view and the neighbours allow it.
void VdtCut::collapse_from(NodeId n, const ErrorScale& scale, double limit, VdtReport& report) {
  while (n != no_node) {
    const InternalNode& node = tree_.node(n);
    const double distance = length(vec_cast<double>(tree_.positions[node.vertex]) - scale.eye());
    if (too_coarse(node.error, node.radius, distance, limit) || !is_active(node.left) ||
        !is_active(node.right))
      return;
    if (!may_collapse(n)) {
      ++report.put_off;
      return;
    }
    collapse(n);
    ++report.collapses;
    n = tree_.parent[n];
  }
}

VdtReport VdtCut::adapt(const ErrorScale& scale, double tau) {
  CUESTA_CHECK(!scale.is_uniform() && tau > 0, tau);
  VdtReport report;
  const double limit = tau * scale.unit();
  const Vec3d eye = scale.eye();
  candidates_.clear();
  for (std::size_t i = 0; i < entries_.size();) {
    const Entry& e = entries_[i];
    const double distance = length(vec_cast<double>(e.position) - eye);
    if (too_coarse(e.split_error, e.split_radius, distance, limit)) {
      force_split(e.node, report);
      continue;  // the left child is where the node was, the right one at the end of the list
    }
    if (!too_coarse(e.collapse_error, e.collapse_radius, distance, limit))
      candidates_.push_back(tree_.parent[e.node]);
    ++i;
  }
  for (const NodeId n : candidates_) collapse_from(n, scale, limit, report);
  report.triangles = triangle_count_;
  report.active_nodes = entries_.size();
  return report;
}

void VdtCut::refine_fully() {
  VdtReport ignored;
  for (std::size_t i = 0; i < entries_.size();)
    if (const NodeId n = entries_[i].node; tree_.is_leaf(n))
      ++i;
    else
      force_split(n, ignored);
}

std::vector<NodeId> VdtCut::active_nodes() const {
  std::vector<NodeId> nodes;
  for (const Entry& e : entries_) nodes.push_back(e.node);
  return nodes;
}

double VdtCut::sse(const ErrorScale& scale, NodeId n) const {
  const float radius = tree_.is_leaf(n) ? 0 : tree_.node(n).radius;
  return scale.sse(tree_.error_of(n), {tree_.positions[tree_.vertex_of(n)], radius});
}

std::uint64_t VdtCut::bytes() const {
  return entries_.size() * sizeof(Entry) + (node_of_.size() + entry_of_.size()) * 4;
}

}  // namespace cuesta::baselines
