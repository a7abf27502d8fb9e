#pragma once
/// What cuesta-bench-fan compares on: the same clean surface for the fan-hierarchy and for a view-dependence
/// tree.

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "hierarchy/build_hierarchy.h"
#include "ooc/result.h"
#include "runtime/cut.h"
#include "tools/baselines/view_dependence_tree.h"

namespace cuesta::bench {

/// Seconds of wall clock and of the process's threads together.
struct Seconds {
  double wall = 0, processor = 0;
};

struct Built {
  Seconds ingest, build;
  BuildReport report;
};

/// Reads, cleans and builds `mesh` with so many threads, in a new folder beside `out`.
Result<Built> build_file(const std::filesystem::path& mesh, const std::filesystem::path& out, int threads);

struct BuiltTree {
  baselines::ViewDependenceTree tree;
  Seconds build;
};

/// A tree over what the cut has at full resolution.   @post all pages of the cut are resident, at full
/// resolution.
Result<BuiltTree> build_tree(Cut& cut);

/// Writes the meshes side by side, each scaled to a diagonal of one.
Result<void> write_scene(const std::filesystem::path& out, std::span<const std::filesystem::path> meshes);

/// Draws fan_route.csv and fan_frames.csv of the folder as fan.svg.
Result<void> draw_results(const std::filesystem::path& folder);

}  // namespace cuesta::bench
