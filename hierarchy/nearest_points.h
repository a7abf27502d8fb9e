#pragma once
/// Nearest neighbours among fixed points, some of which go away. nanoflann's kd-tree behind a small header.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "ooc/vec.h"

namespace cuesta {

class NearestPoints {
 public:
  /// Indexes positions[i] for i in `ids`. @pre ids not empty; `positions` outlives the index.
  NearestPoints(std::span<const Vec3f> positions, std::span<const std::uint32_t> ids);
  ~NearestPoints();
  NearestPoints(NearestPoints&&) noexcept;
  NearestPoints& operator=(NearestPoints&&) noexcept;

  /// The nearest id that `accept`s, the lowest id among equally near ones found together; 0xFFFFFFFF if there
  /// is none.
  std::uint32_t nearest(Vec3f query, const std::function<bool(std::uint32_t)>& accept) const;
  std::size_t size() const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace cuesta
