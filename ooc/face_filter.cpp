#include "ooc/face_filter.h"

#include <algorithm>

namespace cuesta {
namespace {

/// Above this many faces that start at one group, sort to find copies instead of comparing all pairs.
constexpr std::size_t kManyFaces = 16;

using Faces = std::span<const Triangle>;

/// The two higher groups of a face that starts at a known group.
std::uint64_t opposite_edge(const Triangle& t, std::span<const std::uint32_t> group) {
  const auto [lo, hi] = std::minmax(group[t[1]], group[t[2]]);
  return std::uint64_t{hi} << 32 | lo;
}

/// Sets copy[i] for the faces of `faces`, which start at one group, that equal an earlier one.
class CopyFinder {
 public:
  explicit CopyFinder(std::span<const std::uint32_t> group) : group_(group) {}

  const std::vector<std::uint8_t>& operator()(Faces faces) {
    copy_.assign(faces.size(), 0);
    if (faces.size() <= kManyFaces)
      compare_pairs(faces);
    else
      sort(faces);
    return copy_;
  }

 private:
  void compare_pairs(Faces faces) {
    std::uint64_t edges[kManyFaces];
    for (std::size_t i = 0; i < faces.size(); ++i) {
      edges[i] = opposite_edge(faces[i], group_);
      for (std::size_t j = 0; j < i; ++j)
        if (edges[j] == edges[i]) copy_[i] = 1;
    }
  }

  void sort(Faces faces) {
    order_.clear();
    for (std::size_t i = 0; i < faces.size(); ++i) order_.push_back({opposite_edge(faces[i], group_), i});
    std::ranges::sort(order_);
    for (std::size_t i = 1; i < order_.size(); ++i)
      if (order_[i].first == order_[i - 1].first) copy_[order_[i].second] = 1;
  }

  std::span<const std::uint32_t> group_;
  std::vector<std::uint8_t> copy_;
  std::vector<std::pair<std::uint64_t, std::size_t>> order_;
};

}  // namespace

FacesDropped drop_impossible_faces(std::vector<Triangle>& triangles, std::span<const std::uint32_t> group) {
  FacesDropped dropped;
  dropped.degenerate = std::erase_if(triangles, [group](Triangle& t) {
    t = smallest_first(t);
    const std::uint32_t a = group[t[0]], b = group[t[1]], c = group[t[2]];
    return a == b || b == c || c == a;
  });
  const std::vector<std::uint32_t> starts = bucket_by_first(triangles, group);
  CopyFinder copies(group);
  std::size_t kept = 0;
  for (std::size_t g = 0; g < group.size(); ++g) {
    const Faces faces = Faces(triangles).subspan(starts[g], starts[g + 1] - starts[g]);
    if (faces.empty()) continue;
    const std::vector<std::uint8_t>& copy = copies(faces);
    for (std::size_t i = 0; i < faces.size(); ++i)
      if (!copy[i]) triangles[kept++] = faces[i];
  }
  dropped.duplicate = triangles.size() - kept;
  triangles.resize(kept);
  return dropped;
}

}  // namespace cuesta
