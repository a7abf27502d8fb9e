#pragma once
/// What a substitution u → v, or a component that goes as a whole, puts in place of what: all that samples of
/// the original need to know of it.

#include <array>
#include <cstdint>
#include <span>

namespace cuesta {

using PointId = std::uint32_t;
using TriangleId = std::uint32_t;

/// A view, valid until the kernel is asked again.
struct Replacement {
  std::span<const TriangleId> patch;    ///< triangles that go or change: their samples are measured
  std::span<const PointId> leaving;     ///< points that go, samples from now on
  std::span<const TriangleId> targets;  ///< triangles that take the samples, and keep those they have if they
                                        ///< are no part of the patch
  std::span<const std::array<PointId, 3>> corners;  ///< of the targets, after it
  float least_error = 0;                            ///< that it has whatever the samples say, grid units
};

}  // namespace cuesta
