#pragma once
/// What the commands that look at a .cuesta file share: opening a cut, settling it, and the model's box.

#include <filesystem>
#include <memory>
#include <vector>

#include "apps/cuesta/machine.h"
#include "apps/cuesta/progress.h"
#include "runtime/cut.h"

namespace cuesta::app {

/// @param cache_bytes  0: half of the machine's memory.   @param load_threads, clock  as Cut::open().
Result<std::unique_ptr<Cut>> open_cut(const std::filesystem::path& path, std::uint64_t cache_bytes,
                                      std::uint32_t load_threads = 0, Clock clock = clock_ms);

/// Cut::settle() with a progress line and a way to stop.
/// @error cancelled; the first error of a page that could not be read: what is drawn would then be coarser
/// than asked.
Result<AdaptReport> settle_cut(Cut& cut, const ErrorScale& scale, double tau, Budgets budgets,
                               Progress& progress);

/// A few thousand points of the surface, in world units, from the base page alone: to place cameras. Moves
/// the cut. Never empty.
std::vector<Vec3d> sketch_points(Cut& cut);

/// In world units.
Box3d world_box(const Directory& directory);

/// Largest distance between a vertex of the input and its place on the file's grid, in world units.
double snapping_error(const Directory& directory);

/// "triangles", "adapt time", …
const char* name(Binding binding);

}  // namespace cuesta::app
