#pragma once
/// What the commands that look at a .cuesta file share: opening a cut, and settling it.

#include <filesystem>
#include <memory>

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

/// "triangles", "adapt time", …
const char* name(Binding binding);

}  // namespace cuesta::app
