#include "hierarchy/substitution_oracle.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace cuesta {
namespace {

/// Points sorted along x: those within a threshold of each other are not far apart in the array.
std::vector<PointId> along_x(std::span<const Vec3f> at) {
  std::vector<PointId> order(at.size());
  std::iota(order.begin(), order.end(), PointId{0});
  std::sort(order.begin(), order.end(),
            [&](PointId a, PointId b) { return at[a].x != at[b].x ? at[a].x < at[b].x : a < b; });
  return order;
}

}  // namespace

PairOracle::PairOracle(SubstitutionKernel& kernel, float threshold)
    : kernel_(kernel), partners_(kernel.point_count()), gone_to_(kernel.point_count()) {
  std::iota(gone_to_.begin(), gone_to_.end(), PointId{0});
  kernel_.loosen_topology();
  if (threshold > 0 && kernel_.component_count() > 1) find_partners(threshold);
}

/// Sweeps along x.
void PairOracle::find_partners(float threshold) {
  const auto at = kernel_.positions();
  const auto component = kernel_.components();
  const auto order = along_x(at);
  std::vector<std::vector<std::pair<float, PointId>>> near(at.size());
  for (std::size_t i = 0, first = 0; i < order.size(); ++i) {
    const PointId u = order[i];
    while (at[order[first]].x < at[u].x - threshold) ++first;
    for (std::size_t k = first; k < i; ++k) {
      const PointId v = order[k];
      const float d = length(at[u] - at[v]);
      if (component[u] == component[v] || d > threshold) continue;
      near[u].emplace_back(d, v);
      near[v].emplace_back(d, u);
    }
  }
  for (PointId u = 0; u < at.size(); ++u) {
    std::sort(near[u].begin(), near[u].end());
    for (std::size_t k = 0; k < std::min(most_partners, near[u].size()); ++k)
      partners_[u].push_back(near[u][k].second);
  }
}

PointId PairOracle::current(PointId p) {
  while (gone_to_[p] != p) p = gone_to_[p] = gone_to_[gone_to_[p]];
  return p;
}

std::span<const PointId> PairOracle::candidates(PointId u) {
  auto& partners = partners_[u];
  for (PointId& p : partners) p = current(p);
  std::sort(partners.begin(), partners.end());
  partners.erase(std::unique(partners.begin(), partners.end()), partners.end());
  std::erase_if(partners,
                [&](PointId p) { return p == u || kernel_.star(p).empty() || kernel_.adjacent(u, p); });
  const auto around = kernel_.neighbours(u);
  candidates_.assign(around.begin(), around.end());
  candidates_.insert(candidates_.end(), partners.begin(), partners.end());
  return candidates_;
}

void PairOracle::applied(PointId u, PointId v) {
  gone_to_[u] = v;
  auto& to = partners_[v];
  to.insert(to.end(), partners_[u].begin(), partners_[u].end());
  partners_[u] = {};
}

}  // namespace cuesta
