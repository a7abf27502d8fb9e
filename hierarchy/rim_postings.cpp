#include "hierarchy/rim_postings.h"

#include <algorithm>

namespace cuesta {
namespace {

Vec3i lowest(std::span<const Vec3i> positions) {
  Vec3i lo = positions.empty() ? Vec3i{} : positions.front();
  for (const Vec3i& p : positions) lo = min(lo, p);
  return lo;
}

}  // namespace

RimPostings::RimPostings(const CellMesh& cell)
    : origin_(lowest(cell.positions)),
      batch_(LocalVertical(*cell.vertical, origin_)),
      beside_(cell.triangles.size()) {
  if (cell.samples.begin.empty()) return;
  for (std::uint32_t t = 0; t < cell.triangles.size(); ++t) {
    const std::uint32_t first = cell.samples.begin[t], end = cell.samples.begin[t + 1];
    if (first == end) continue;
    for (std::uint32_t i = first; i < end; ++i) batch_.add(vec_cast<float>(cell.samples.points[i] - origin_));
    const auto& c = cell.triangles[t];
    const Corners corners{cell.positions[c[0]], cell.positions[c[1]], cell.positions[c[2]]};
    measure({&t, 1}, {&corners, 1});
  }
}

void RimPostings::take(std::uint32_t triangle) {
  for (const Vec3i& p : beside_[triangle]) batch_.add(vec_cast<float>(p - origin_));
  beside_[triangle].clear();
}

float RimPostings::measure(std::span<const std::uint32_t> triangles, std::span<const Corners> corners) {
  if (batch_.size() == 0) return 0;
  local_corners_.clear();
  for (const Corners& c : corners)
    local_corners_.push_back(
        {vec_cast<float>(c[0] - origin_), vec_cast<float>(c[1] - origin_), vec_cast<float>(c[2] - origin_)});
  batch_.measure(local_corners_);
  float worst = 0;
  for (std::size_t i = 0; i < batch_.size(); ++i) {
    if (batch_.inside(i) >= rim_width) continue;
    worst = std::max(worst, batch_.bound(i));
    beside_[triangles[static_cast<std::size_t>(batch_.nearest(i))]].push_back(
        vec_cast<std::int32_t>(batch_.point(i)) + origin_);
  }
  batch_.clear();
  return worst;
}

std::optional<float> RimPostings::move(std::span<const std::uint32_t> patch, std::span<const Vec3i> uncovered,
                                       std::span<const std::uint32_t> made,
                                       std::span<const Corners> corners) {
  for (const std::uint32_t t : patch) take(t);
  for (const std::uint32_t t : made) take(t);
  for (const Vec3i& p : uncovered) batch_.add(vec_cast<float>(p - origin_));
  if (batch_.size() <= most_beside) return measure(made, corners);
  batch_.clear();
  return {};
}

}  // namespace cuesta
