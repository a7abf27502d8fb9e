#include "ooc/space_tree.h"

#include <algorithm>
#include <limits>

#include "ooc/check.h"

namespace cuesta {
namespace {

int longest_axis(std::span<const Vec3f> points) {
  Box3<float> box;
  for (const Vec3f& p : points) box.add(p);
  const Vec3f e = box.hi - box.lo;
  return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
}

}  // namespace

SpaceTree::SpaceTree(std::vector<Vec3f> samples, std::uint32_t leaves, const Axes& axes) : axes_(axes) {
  CUESTA_CHECK(leaves > 0);
  for (Vec3f& p : samples) p = turn(axes, p);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Box3<float> everything;
  everything.lo = {-infinity, -infinity, -infinity};
  everything.hi = {infinity, infinity, infinity};
  split(samples, leaves, everything);
}

void SpaceTree::split(std::span<Vec3f> samples, std::uint32_t leaves, const Box3<float>& box) {
  const std::size_t node = nodes_.size();
  nodes_.emplace_back();
  const std::uint32_t left = leaves / 2;
  const std::size_t middle = samples.size() * left / std::max(1u, leaves);
  if (left > 0 && middle > 0 && middle < samples.size()) {
    const int axis = longest_axis(samples);
    const auto less = [axis](const Vec3f& a, const Vec3f& b) { return a[axis] < b[axis]; };
    std::nth_element(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(middle), samples.end(),
                     less);
    float cut = samples[middle][axis];
    const auto put_left = [&] {
      const auto border =
          std::partition(samples.begin(), samples.end(), [&](const Vec3f& p) { return p[axis] < cut; });
      return static_cast<std::size_t>(border - samples.begin());
    };
    std::size_t on_left = put_left();
    if (on_left == 0) {  // many samples lie on the cut: the next one up
      float next = std::numeric_limits<float>::infinity();
      for (const Vec3f& p : samples)
        if (p[axis] > cut) next = std::min(next, p[axis]);
      cut = next;
      on_left = put_left();
    }
    if (on_left < samples.size()) {
      nodes_[node].cut = cut;
      nodes_[node].axis = axis;
      Box3<float> lower = box, upper = box;
      lower.hi[axis] = upper.lo[axis] = cut;
      split(samples.first(on_left), left, lower);
      nodes_[node].right = static_cast<std::uint32_t>(nodes_.size());
      split(samples.subspan(on_left), leaves - left, upper);
      return;
    }
  }
  nodes_[node].right = static_cast<std::uint32_t>(boxes_.size());
  boxes_.push_back(box);
}

std::uint32_t SpaceTree::leaf_of(Vec3f p) const {
  std::uint32_t n = 0;
  while (nodes_[n].axis >= 0) n = p[nodes_[n].axis] < nodes_[n].cut ? n + 1 : nodes_[n].right;
  return nodes_[n].right;
}

}  // namespace cuesta
