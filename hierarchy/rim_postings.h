#pragma once
/// The postings beside a field of heights: those that its rim has moved away from, and those on the rim.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hierarchy/cell_mesh.h"
#include "hierarchy/deviation.h"
#include "ooc/vec.h"

namespace cuesta {

/// More postings than this are not kept beside a triangle.
inline constexpr std::size_t most_beside = 16'384;

/// Keeps, while the script of a cell is replayed, the postings that lie above and below no triangle, each
/// with a triangle that it is beside. Distances are those of DeviationBatch.
class RimPostings {
 public:
  using Corners = std::array<Vec3i, 3>;

  /// Those among the samples of the cell's triangles.
  /// @pre  cell.vertical has a value
  explicit RimPostings(const CellMesh& cell);

  /// The triangles `patch` go or change, and `made`, with these corners, are there after it; `uncovered` may
  /// be beside them now.
  /// @return upper bound of the distances of all that is beside `made`, grid units; 0 if nothing is. None: it
  /// would be more than most_beside, and is not kept; then nothing less than the size of the whole surface is
  /// a bound, of this step and of all that depend on it.
  std::optional<float> move(std::span<const std::uint32_t> patch, std::span<const Vec3i> uncovered,
                            std::span<const std::uint32_t> made, std::span<const Corners> corners);

  std::span<const Vec3i> beside(std::uint32_t triangle) const { return beside_[triangle]; }

 private:
  void take(std::uint32_t triangle);
  /// Measures what was taken, and keeps what is beside.
  float measure(std::span<const std::uint32_t> triangles, std::span<const Corners> corners);

  Vec3i origin_;
  DeviationBatch batch_;
  std::vector<std::vector<Vec3i>> beside_;  // by triangle
  std::vector<std::array<Vec3f, 3>> local_corners_;
};

}  // namespace cuesta
