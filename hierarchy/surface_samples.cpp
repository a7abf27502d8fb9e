#include "hierarchy/surface_samples.h"

#include <algorithm>
#include <utility>

#include "ooc/check.h"

namespace cuesta {

SurfaceSamples::SurfaceSamples(const TriangleSamples& samples, const SubstitutionKernel& kernel)
    : positions_(kernel.positions()),
      runs_(kernel.triangle_count()),
      live_(samples.points.size()),
      batch_(kernel.vertical()) {
  arena_.reserve((samples.points.size() + positions_.size()) * 2);
  for (const Vec3i& p : samples.points) arena_.push_back(vec_cast<float>(p - kernel.origin()));
  if (samples.begin.empty()) return;
  for (TriangleId t = 0; t < runs_.size(); ++t) {
    runs_[t] = {samples.begin[t], samples.begin[t + 1] - samples.begin[t]};
    chosen_ |= runs_[t].count >= max_triangle_samples;
  }
}

float SurfaceSamples::measure(const Replacement& r) {
  batch_.clear();
  for (TriangleId t : r.patch)
    if (runs_[t].count > 0) batch_.add(of(t));
  for (PointId p : r.leaving) batch_.add(positions_[p]);
  corners_.clear();
  for (const auto& c : r.corners) corners_.push_back({positions_[c[0]], positions_[c[1]], positions_[c[2]]});
  batch_.measure(corners_);
  const float bound = batch_.worst_bound();
  return std::max(chosen_ ? bound * (1 + chosen_samples_margin) : bound, r.least_error);
}

/// Each target gets a new run: what it has kept, and what it takes. Points that leave are samples like those
/// they stood for.
void SurfaceSamples::move(const Replacement& r) {
  live_ += r.leaving.size();
  for (TriangleId t : r.patch) runs_[t].count = 0;
  std::size_t kept = 0;
  for (TriangleId t : r.targets) kept += runs_[t].count;
  if (arena_.size() + kept + batch_.size() > arena_.capacity()) pack();
  fill_.assign(r.targets.size(), 0);
  const auto nearest = batch_.nearest();
  std::int32_t lowest = 0;
  for (const std::int32_t k : nearest) lowest = std::min(lowest, k);
  CUESTA_CHECK(lowest == 0);
  std::uint32_t* const fill = fill_.data();
  for (const std::int32_t k : nearest) ++fill[k];
  auto end = static_cast<std::uint32_t>(arena_.size());
  arena_.resize(arena_.size() + kept + batch_.size());
  for (std::size_t k = 0; k < r.targets.size(); ++k) {
    Run& run = runs_[r.targets[k]];
    std::copy_n(arena_.begin() + run.begin, run.count, arena_.begin() + end);
    const std::uint32_t taken = std::exchange(fill_[k], end + run.count);
    run = {end, run.count + taken};
    end += run.count;
  }
  Vec3f* const arena = arena_.data();
  for (std::size_t i = 0; i < nearest.size(); ++i) arena[fill[nearest[i]]++] = batch_.point(i);
}

/// Runs that were left behind go; room for as much again, and for what is about to come.
void SurfaceSamples::pack() {
  std::vector<Vec3f> packed;
  packed.reserve(2 * (live_ + positions_.size()));
  for (Run& run : runs_) {
    if (run.count == 0) continue;
    const auto first = arena_.begin() + run.begin;
    run.begin = static_cast<std::uint32_t>(packed.size());
    packed.insert(packed.end(), first, first + run.count);
  }
  arena_ = std::move(packed);
}

}  // namespace cuesta
