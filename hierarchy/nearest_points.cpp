#include "hierarchy/nearest_points.h"

#include <algorithm>
#include <nanoflann.hpp>
#include <vector>

namespace cuesta {
namespace {

struct Cloud {
  std::span<const Vec3f> positions;
  std::vector<std::uint32_t> ids;

  std::size_t kdtree_get_point_count() const { return ids.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return positions[ids[i]][static_cast<int>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::uint32_t>;

}  // namespace

struct NearestPoints::Index {
  Cloud cloud;
  Tree tree;
  Index(std::span<const Vec3f> positions, std::span<const std::uint32_t> ids)
      : cloud{positions, {ids.begin(), ids.end()}},
        tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {
    tree.buildIndex();
  }
};

NearestPoints::NearestPoints(std::span<const Vec3f> positions, std::span<const std::uint32_t> ids)
    : index_(std::make_unique<Index>(positions, ids)) {}
NearestPoints::~NearestPoints() = default;
NearestPoints::NearestPoints(NearestPoints&&) noexcept = default;
NearestPoints& NearestPoints::operator=(NearestPoints&&) noexcept = default;

std::size_t NearestPoints::size() const {
  return index_->cloud.ids.size();
}

std::uint32_t NearestPoints::nearest(Vec3f query, const std::function<bool(std::uint32_t)>& accept) const {
  const float q[3] = {query.x, query.y, query.z};
  for (std::size_t k = 8;; k = std::min(k * 4, size())) {
    std::vector<std::uint32_t> found(std::min(k, size()));
    std::vector<float> squared(found.size());
    found.resize(index_->tree.knnSearch(q, found.size(), found.data(), squared.data()));
    std::uint32_t best = 0xFFFFFFFFu;
    float best_squared = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const std::uint32_t id = index_->cloud.ids[found[i]];
      if (best != 0xFFFFFFFFu && squared[i] > best_squared) break;
      if (!accept(id)) continue;
      if (best == 0xFFFFFFFFu || id < best) best = id;
      best_squared = squared[i];
    }
    if (best != 0xFFFFFFFFu || k >= size()) return best;
  }
}

}  // namespace cuesta
