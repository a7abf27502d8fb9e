#include "hierarchy/component_absorber.h"

#include <algorithm>
#include <tuple>

namespace cuesta {

ComponentAbsorber::ComponentAbsorber(SubstitutionKernel& kernel, SurfaceSamples& samples)
    : kernel_(kernel), samples_(samples) {
  locked_.assign(kernel.component_count(), 0);
  if (locked_.size() < 2) return;
  component_.assign(kernel.components().begin(), kernel.components().end());
  for (PointId p = 0; p < kernel.point_count(); ++p)
    if (!kernel.can_move(p) || kernel.star(p).empty()) locked_[component_[p]] = 1;
  known_.assign(locked_.size(), 0);
}

/// Counting sort of the live points by component.
void ComponentAbsorber::count(std::span<const PointId> live) {
  first_.assign(locked_.size() + 1, 0);
  for (PointId p : live) ++first_[component_[p] + 1];
  for (std::size_t c = 0; c < locked_.size(); ++c) first_[c + 1] += first_[c];
  members_.resize(first_.back());
  std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
  for (PointId p : live) members_[fill[component_[p]]++] = p;
}

std::span<const PointId> ComponentAbsorber::members(const Candidate& candidate) const {
  const std::uint32_t c = candidate.component;
  return std::span(members_).subspan(first_[c], first_[c + 1] - first_[c]);
}

PointId ComponentAbsorber::nearest_target(std::uint32_t component, std::span<const PointId> live) {
  // Points that have gone stay in the index; build it anew when they are many.
  if (!index_ || index_->size() > 4 * live.size())
    index_ = std::make_unique<NearestPoints>(kernel_.positions(), live);
  return index_->nearest(kernel_.positions()[members_[first_[component]]], [&](std::uint32_t p) {
    return component_[p] != component && !kernel_.star(p).empty();
  });
}

const std::vector<ComponentAbsorber::Candidate>& ComponentAbsorber::candidates(std::span<const PointId> live,
                                                                               std::uint32_t most_points,
                                                                               float reach) {
  candidates_.clear();
  if (locked_.size() < 2) return candidates_;
  count(live);
  for (std::uint32_t c = 0; c < locked_.size(); ++c) {
    const std::uint32_t points = first_[c + 1] - first_[c];
    if (locked_[c] || points == 0 || points > most_points || known_[c] > reach) continue;
    const PointId target = nearest_target(c, live);
    if (target == none) continue;
    Candidate candidate{0, c, target};
    candidate.distance = samples_.measure(kernel_.absorption(members(candidate), target));
    known_[c] = candidate.distance;
    if (candidate.distance <= reach) candidates_.push_back(candidate);
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.distance, a.component) < std::tie(b.distance, b.component);
  });
  return candidates_;
}

}  // namespace cuesta
