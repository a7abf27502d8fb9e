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
/// Oracle:   span<const PointId> candidates(PointId u)   what u could go to, valid until the next call of anything
///           bool legal(PointId u, PointId v)            exactly, now; the kernel can measure and apply it then
///           void applied(PointId u, PointId v)
/// Fairness: void costs(PointId u, span<const PointId> targets, span<float> out)   ≥ 0, the lower the better
///           void applied(PointId u, PointId v)          after the kernel has applied it
///           constexpr bool never_falls                  a cost only grows while others are substituted
/// Apply:    void apply(PointId u, PointId v)            measures and applies in the kernel, and records
template <class Oracle, class Fairness, class Apply>
class GreedySubstitution {
 public:
  GreedySubstitution(SubstitutionKernel& kernel, Oracle& oracle, Fairness& fairness, Apply& apply)
      : kernel_(kernel),
        oracle_(oracle),
        fairness_(fairness),
        apply_(apply),
        key_(kernel.point_count(), parked),
        best_(kernel.point_count(), none) {
    heap_.reserve(kernel.point_count() + kernel.point_count() / 2);
  }

  /// Queues every point anew: what is legal may have changed everywhere.
  void queue_all() {
    heap_.clear();
    for (PointId u = 0; u < kernel_.point_count(); ++u) {
      key_[u] = parked;
      if (!kernel_.can_move(u) || kernel_.star(u).empty()) continue;
      evaluate(u);
      if (choices_.empty()) continue;
      best_[u] = static_cast<PointId>(choices_.back());
      key_[u] = cost_of(choices_.back());
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
  static constexpr float parked = std::numeric_limits<float>::infinity();

  /// Costs are not negative: their bits are in order.
  std::uint64_t entry(PointId u) const {
    return packed(key_[u], u);
  }
  void push(PointId u, float key) {
    key_[u] = key;
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
  static float cost_of(std::uint64_t packed) { return std::bit_cast<float>(static_cast<std::uint32_t>(packed >> 32)); }

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

  /// The best legal target of u, or none: then u is queued again with its right key, or parked.
  PointId choose(PointId u) {
    const PointId tried = best_[u];
    if (tried != none && oracle_.legal(u, tried)) return tried;
    for (evaluate(u); !choices_.empty(); cheapest_last()) {
      const float cost = cost_of(choices_.back());
      const auto v = static_cast<PointId>(choices_.back());
      choices_.pop_back();
      if (v == tried) continue;
      if (cost > key_[u] && !heap_.empty() && packed(cost, u) > heap_.front()) {
        best_[u] = v;
        push(u, cost);
        return none;
      }
      if (oracle_.legal(u, v)) return v;
    }
    key_[u] = parked;
    return none;
  }

  void substitute(PointId u, PointId v) {
    apply_.apply(u, v);
    fairness_.applied(u, v);
    oracle_.applied(u, v);
    ring_.assign(1, v);
    const auto around = oracle_.candidates(v);
    ring_.insert(ring_.end(), around.begin(), around.end());
    for (PointId q : ring_) refresh(q, v);
  }

  /// Something around q has changed. Its key stays if it can only have grown.
  void refresh(PointId q, PointId v) {
    best_[q] = none;
    if (key_[q] == parked) {
      evaluate(q);
      if (!choices_.empty()) push(q, cost_of(choices_.back()));
    } else if (!Fairness::never_falls && q != v) {
      float cost = 0;
      fairness_.costs(q, {&v, 1}, {&cost, 1});
      if (cost < key_[q]) push(q, cost);
    }
  }

  SubstitutionKernel& kernel_;
  Oracle& oracle_;
  Fairness& fairness_;
  Apply& apply_;
  std::vector<float> key_;     // per point, of its entry in the heap; parked if it has none
  std::vector<PointId> best_;  // per point, its cheapest candidate, or none if that has to be found
  std::vector<std::uint64_t> heap_;
  std::vector<PointId> targets_;
  std::vector<float> costs_;
  std::vector<std::uint64_t> choices_;
  std::vector<PointId> ring_;
};

}  // namespace cuesta
