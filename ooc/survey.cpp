#include "ooc/survey.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "ooc/choose_grid.h"
#include "ooc/ordered_tasks.h"

namespace cuesta {
namespace {

constexpr std::uint64_t run_vertices = std::uint64_t{1} << 18;
constexpr int most_sample_bits = 20;

/// A well-mixed number: vertices that are a row of a raster apart are not a pattern to it.
std::uint64_t mixed(std::uint64_t v) {
  v = (v ^ (v >> 31)) * 0x7fb5d329728ea185;
  v = (v ^ (v >> 27)) * 0x81dadef4bc2dd44d;
  return v ^ (v >> 33);
}

/// What one run of vertices gives.
struct RunSurvey {
  Box3d box;
  std::vector<Vec3d> samples;
  std::uint64_t nonfinite = 0, unused = 0;
};

RunSurvey survey_run(const RawSurface& raw, std::span<const Vec3d> positions, std::uint64_t first,
                     std::uint64_t sample_mask) {
  RunSurvey out;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const bool used = raw.is_used(first + i);
    if (!is_finite(positions[i])) {
      ++out.nonfinite;
    } else if (!used) {
      ++out.unused;
    } else {
      out.box.add(positions[i]);
      if ((mixed(first + i) & sample_mask) == 0) out.samples.push_back(positions[i]);
    }
  }
  return out;
}

Result<std::vector<double>> edge_lengths(const RawSurface& raw) {
  std::vector<std::uint64_t> vertices;
  for (const auto& t : raw.sample()) vertices.insert(vertices.end(), t.begin(), t.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  const auto positions = raw.positions_of(vertices);
  if (!positions) return fail(positions.error());
  const auto position = [&](std::uint64_t v) {
    return (*positions)[static_cast<std::size_t>(std::lower_bound(vertices.begin(), vertices.end(), v) -
                                                 vertices.begin())];
  };
  std::vector<double> lengths;
  for (const auto& t : raw.sample())
    for (std::size_t k = 0; k < 3; ++k) {
      const double l = length(position(t[k]) - position(t[(k + 1) % 3]));
      if (std::isfinite(l)) lengths.push_back(l);
    }
  return lengths;
}

}  // namespace

Result<Survey> survey(const RawSurface& raw, double step) {
  Survey out;
  const std::uint64_t vertices = raw.counts().vertices;
  const int drop = std::max(0, static_cast<int>(std::bit_width(vertices)) - most_sample_bits);
  const std::uint64_t sample_mask = (std::uint64_t{1} << drop) - 1;
  Box3d box;
  std::vector<Vec3d> samples;
  auto surveyed = run_in_order<RunSurvey>(
      0, (vertices + run_vertices - 1) / run_vertices, arena_threads() * 2,
      [&](std::uint64_t i) -> Result<RunSurvey> {
        const std::uint64_t first = i * run_vertices;
        const auto positions = raw.positions_run(first, std::min(run_vertices, vertices - first));
        if (!positions) return fail(positions.error());
        return survey_run(raw, *positions, first, sample_mask);
      },
      [&](std::uint64_t, RunSurvey run) -> Result<void> {
        box.add(run.box);
        samples.insert(samples.end(), run.samples.begin(), run.samples.end());
        out.nonfinite_vertices += run.nonfinite;
        out.unused_vertices += run.unused;
        return {};
      });
  if (!surveyed) return fail(surveyed.error());
  out.used_vertices = vertices - out.nonfinite_vertices - out.unused_vertices;
  auto lengths = edge_lengths(raw);
  if (!lengths) return fail(lengths.error());
  const auto grid = choose_grid(box, std::move(*lengths), step);
  if (!grid) return fail(grid.error());
  out.grid = *grid;
  if (!box.empty()) {
    out.box.add(grid->snap(box.lo));
    out.box.add(grid->snap(box.hi));
  }
  out.samples.reserve(samples.size());
  for (const Vec3d& p : samples) out.samples.push_back(vec_cast<float>(grid->snap(p)));
  return out;
}

}  // namespace cuesta
