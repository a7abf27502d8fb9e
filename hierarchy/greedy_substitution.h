#pragma once
/// The greedy framework: a heap of candidates, an oracle that says which substitutions are legal and a
/// fairness predicate that gives them their order. Source: Bouvier, Gobbetti, "TOM: Totally Ordered Mesh",
/// §4.1. Deviation: priorities are brought up to date when they come to the top of the heap, not when
/// something nearby changes.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "hierarchy/substitution_kernel.h"

namespace cuesta {

/// Runs until nothing is legal any more. Ties by number of the point: the order is the same everywhere.
///
/// Oracle:   span<const PointId> candidates(PointId u)   what u could go to, valid until the next call of
/// anything
///           bool legal(PointId u, PointId v)            exactly, now; the kernel can measure and apply it
///           then void applied(PointId u, PointId v)
/// Fairness: void costs(PointId u, span<const PointId> targets, span<float> out)   ≥ 0, the lower the better
///           void applied(PointId u, PointId v, span<const Child>)   after the kernel has applied it to its
///           wedges
/// Apply:    span<const Child> apply(PointId u, PointId v)   measures and applies in the kernel, and records
///           float surcharge(PointId u, PointId v)       of a legal one, ≥ 0: for its measured deviation
template <class Oracle, class Fairness, class Apply>
class GreedySubstitution {
 public:
  GreedySubstitution(SubstitutionKernel& kernel, Oracle& oracle, Fairness& fairness, Apply& apply)
      : kernel_(kernel), oracle_(oracle), fairness_(fairness), apply_(apply), points_(kernel.point_count()) {
    heap_.reserve(kernel.point_count() + kernel.point_count() / 2);
  }

  /// Queues every point anew: what is legal may have changed everywhere.
  void queue_all() {
    heap_.clear();
    for (PointId u = 0; u < kernel_.point_count(); ++u) {
      points_[u].key = parked;
      if (!kernel_.can_move(u) || kernel_.star(u).empty()) continue;
      evaluate(u);
      if (choices_.empty()) continue;
      points_[u].best = static_cast<PointId>(choices_.back());
      points_[u].key = cost_of(choices_.back());
      heap_.push_back(entry(u));
    }
    std::make_heap(heap_.begin(), heap_.end(), std::greater<>());
  }

  /// Applies the cheapest legal substitution; false if there is none.
  bool step() {
    while (!heap_.empty()) {
      const std::uint64_t top = pop();
      const auto u = static_cast<PointId>(top);
      if (kernel_.removed(u) || top != entry(u)) continue;
      const PointId v = choose(u);
      if (v == none) continue;
      substitute(u, v);
      return true;
    }
    return false;
  }

 private:
  /// Near the end each choice shows: below this many triangles keys are brought up to date at once.
  static constexpr std::uint32_t eager_triangles = 8192;
  /// Below this many, what is measured counts, too.
  static constexpr std::uint32_t coarse_triangles = 2048;
  static constexpr float parked = std::numeric_limits<float>::infinity();

  /// Costs are not negative: their bits are in order.
  std::uint64_t entry(PointId u) const { return packed(points_[u].key, u); }
  void push(PointId u, float key) {
    points_[u].key = key;
    heap_.push_back(entry(u));
    std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
  }
  std::uint64_t pop() {
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
    const std::uint64_t top = heap_.back();
    heap_.pop_back();
    return top;
  }

  static std::uint64_t packed(float cost, PointId p) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(cost)} << 32 | p;
  }
  static float cost_of(std::uint64_t packed) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(packed >> 32));
  }

  /// All candidates of u with their costs, the cheapest last.
  void evaluate(PointId u) {
    const auto candidates = oracle_.candidates(u);
    targets_.assign(candidates.begin(), candidates.end());
    costs_.resize(targets_.size());
    fairness_.costs(u, targets_, costs_);
    choices_.clear();
    for (std::size_t i = 0; i < targets_.size(); ++i) choices_.push_back(packed(costs_[i], targets_[i]));
    cheapest_last();
  }
  void cheapest_last() {
    if (!choices_.empty()) std::swap(*std::min_element(choices_.begin(), choices_.end()), choices_.back());
  }

  bool is_coarse() const { return kernel_.live_triangles() < coarse_triangles; }

  /// The best legal target of u, or none: then u is queued again with its right key, or parked.
  PointId choose(PointId u) {
    const PointId tried = points_[u].best;
    if (is_coarse()) return choose_measured(u);
    if (tried != none && oracle_.legal(u, tried)) return tried;
    for (evaluate(u); !choices_.empty(); cheapest_last()) {
      const std::uint64_t choice = choices_.back();
      choices_.pop_back();
      const auto v = static_cast<PointId>(choice);
      if (v == tried) continue;
      if (must_wait(u, cost_of(choice))) return wait(u, v, cost_of(choice));
      if (oracle_.legal(u, v)) return v;
    }
    return park(u);
  }

  /// The same where costs have a surcharge for what is measured.
  PointId choose_measured(PointId u) {
    std::uint64_t best = packed(parked, none);
    PointId looked_at = none;
    for (evaluate(u); !choices_.empty() && choices_.back() < best; cheapest_last()) {
      const float cost = cost_of(choices_.back());
      const auto v = static_cast<PointId>(choices_.back());
      choices_.pop_back();
      if (must_wait(u, cost)) return wait(u, v, cost);
      looked_at = v;
      if (!oracle_.legal(u, v)) continue;
      const std::uint64_t choice = packed(cost + apply_.surcharge(u, v), v);
      if (choice < best) points_[u].extra = cost_of(choice) - cost;
      best = std::min(best, choice);
    }
    const auto v = static_cast<PointId>(best);
    if (v == none) return park(u);
    if (must_wait(u, cost_of(best))) return wait(u, v, cost_of(best));
    if (v != looked_at) oracle_.legal(u, v);  // it is what the kernel applies
    return v;
  }

  bool must_wait(PointId u, float cost) const {
    return cost > points_[u].key && !heap_.empty() && packed(cost, u) > heap_.front();
  }
  PointId wait(PointId u, PointId v, float cost) {
    points_[u].best = v;
    push(u, cost);
    return none;
  }
  PointId park(PointId u) {
    points_[u].key = parked;
    return none;
  }

  void substitute(PointId u, PointId v) {
    fairness_.applied(u, v, apply_.apply(u, v));
    oracle_.applied(u, v);
    ring_.assign(1, v);
    const auto around = oracle_.candidates(v);
    ring_.insert(ring_.end(), around.begin(), around.end());
    for (PointId q : ring_) refresh(q);
  }

  /// Something around q has changed. Its key stays if it can only have grown.
  void refresh(PointId q) {
    points_[q].best = none;
    if (points_[q].key == parked) {
      evaluate(q);
      if (!choices_.empty()) push(q, cost_of(choices_.back()));
    } else if (kernel_.live_triangles() < eager_triangles) {
      evaluate(q);
      if (!choices_.empty() && cost_of(choices_.back()) + points_[q].extra < points_[q].key)
        push(q, cost_of(choices_.back()) + points_[q].extra);
    }
  }

  SubstitutionKernel& kernel_;
  Oracle& oracle_;
  Fairness& fairness_;
  Apply& apply_;
  struct Point {
    float key = parked;   // of its entry in the heap; parked if it has none
    PointId best = none;  // its cheapest candidate, or none if that has to be found
    float extra = 0;      // the surcharge that it had last
  };
  std::vector<Point> points_;
  std::vector<std::uint64_t> heap_;
  std::vector<PointId> targets_;
  std::vector<float> costs_;
  std::vector<std::uint64_t> choices_;
  std::vector<PointId> ring_;
};

}  // namespace cuesta
