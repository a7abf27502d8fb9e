#pragma once
/// The fan-merge passes over one cell: DESIGN §6 "a pass in a cell".
/// Source: Livny, Sokolovsky, El-Sana, "Dual adaptive paths for multiresolution hierarchies", §3.1–3.3; the
/// heap is replaced by passes with a rising threshold, whose fans are disjoint and so independent of order.

#include "hierarchy/cell_mesh.h"

namespace cuesta {

struct SimplifyOptions {
  /// Stop at this many triangles or when nothing is legal any more.
  std::uint32_t target_triangles = 0;
  /// A pass's threshold is at least this quantile of the cheapest substitution into each centre.
  double pass_quantile = 0.1;
  /// A fan that is begun takes further neighbours up to this multiple of the threshold: more children per fan
  /// against a little more error (docs/design-notes.md has the measurements).
  float fan_reach = 2.25f;
};

struct SimplifyResult {
  Script script;
  CellSurvivors survivors;
  std::uint32_t passes = 0;
  /// Some samples of the cell had been left out: errors have a margin for them (chosen_samples_margin).
  bool errors_are_estimates = false;
};

/// Simplifies `cell` (consumed) by fan-merges. Pure and deterministic; knows no threads, files or clocks.
/// @post every substitution was legal when applied (I2), errors and spheres are saturated (I3).
/// @cost about 4 µs per removed vertex; 250 bytes per triangle.
SimplifyResult simplify_cell(CellMesh cell, const SimplifyOptions& options);

}  // namespace cuesta
