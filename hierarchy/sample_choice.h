#pragma once
/// Which samples of the original surface a triangle takes along into the next round, when it has too many.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hierarchy/deviation.h"
#include "ooc/vec.h"

namespace cuesta {

/// Chooses, for a triangle at a time, the samples to keep. Scratch memory is reused; one object per cell.
class SampleChoice {
 public:
  /// @param vertical  what distances are along, as DeviationBatch has it
  explicit SampleChoice(std::optional<LocalVertical> vertical = {}) : batch_(vertical) {}
  /// Keeps at most `most` of `samples` and moves them to the front, in their order: the farthest from the
  /// triangle in each of its parts (there are about 3/4 · most equal ones, and a sample belongs to the part
  /// it projects to), then the farthest of the rest. So the farthest of all is kept, and where there was a
  /// sample one is left nearby. Deterministic; of equally far samples the earlier one.
  /// @pre   most ≥ 2
  /// @return how many are kept: min(most, samples).
  /// @cost  O(samples), about 20 ns each.
  std::size_t keep(std::span<Vec3f> samples, const std::array<Vec3f, 3>& triangle, std::size_t most);

 private:
  DeviationBatch batch_;
  std::vector<std::uint32_t> farthest_;  // per part
  std::vector<std::uint8_t> kept_;
  std::vector<std::uint32_t> order_;
};

}  // namespace cuesta
