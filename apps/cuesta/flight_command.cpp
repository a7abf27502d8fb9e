#include "apps/cuesta/flight_command.h"

#include <fmt/format.h>

#include "apps/cuesta/open_cut.h"
#include "runtime/flight_file.h"
#include "runtime/view_fit.h"

namespace cuesta::app {
namespace {

/// The vertex of the coarsest cut that is nearest to someone who looks at the box's centre from `direction`.
Vec3d surface_point(const DrawList& list, const Box3d& box, Vec3d direction) {
  constexpr double aside_counts = 3;  // so that it is in front of the centre, not at the rim
  const Vec3d centre = (box.lo + box.hi) * 0.5;
  Vec3d best = centre;
  double best_score = -std::numeric_limits<double>::infinity();
  for (const Range& draw : list.draws) {
    for (const std::uint32_t slot : list.indices.subspan(draw.first, draw.count)) {
      const DrawVertex& v = list.vertices[slot];
      const Vec3d p = list.grid.world({v.x, v.y, v.z});
      const double ahead = dot(p - centre, direction);
      const double score = ahead - aside_counts * length(p - centre - direction * ahead);
      if (score > best_score) best = p, best_score = score;
    }
  }
  return best;
}

}  // namespace

Result<void> run_flight(const FlightSettings& s) {
  auto cut = open_cut(s.file, 0);
  if (!cut) return fail(cut.error());
  const Box3d box = world_box((*cut)->directory());
  const Vec3d surface = surface_point((*cut)->draw_list(), box, three_quarter_direction(s.view.up));
  const Flight flight = make_flight(s.kind, {box, surface}, s.view, s.frames, s.fps);
  if (auto r = write_flight(s.output, flight); !r) return r;
  fmt::print("{}: {} keyframes, {} frames at {:g} fps\n", s.output.string(), flight.keyframes.size(),
             s.frames, s.fps);
  return {};
}

}  // namespace cuesta::app
