#include "apps/cuesta/open_cut.h"

#include <algorithm>
#include <cmath>

#include "apps/cuesta/machine.h"
#include "apps/cuesta/stop_signal.h"
#include "runtime/extract.h"

namespace cuesta::app {
namespace {

constexpr std::uint32_t pages_per_call = 32;  // so that the progress line moves, and a stop is noticed
constexpr std::uint64_t sketch_triangles = 4000;
constexpr double least_sketch = 0.8;  // of the box's diagonal, for a sketch to stand for the surface
constexpr int most_calls = 100000;    // more than any file needs; a cut that does not settle ends too

std::vector<Vec3d> corners(const Box3d& box) {
  std::vector<Vec3d> points;
  for (const double x : {box.lo.x, box.hi.x})
    for (const double y : {box.lo.y, box.hi.y})
      for (const double z : {box.lo.z, box.hi.z}) points.push_back({x, y, z});
  return points;
}

}  // namespace

Result<std::unique_ptr<Cut>> open_cut(const std::filesystem::path& path, std::uint64_t cache_bytes,
                                      std::uint32_t load_threads, Clock clock) {
  auto file = CuestaFile::open(path);
  if (!file) return fail(file.error());
  return Cut::open(std::move(*file), cache_bytes > 0 ? cache_bytes : physical_memory_bytes() / 2,
                   std::move(clock), load_threads);
}

Result<AdaptReport> settle_cut(Cut& cut, const ErrorScale& scale, double tau, Budgets budgets,
                               Progress& progress) {
  budgets.page_loads = std::min(budgets.page_loads, pages_per_call);
  AdaptReport sum;
  for (int call = 0; call < most_calls && !sum.settled; ++call) {
    if (!progress.update("adapt", Unit::pages, cut.cache().resident_ids().size(), 0)) break;
    AdaptReport last = cut.adapt(scale, tau, budgets);
    if (last.pages_missing > 0 && !cut.cache().loads_inline()) cut.cache().wait();
    last.add_work_of(sum);
    sum = last;
  }
  sum.achieved = cut.achieved(scale);
  if (auto r = check_stop(); !r) return fail(r.error());
  return sum;
}

std::vector<Vec3d> sketch_points(Cut& cut) {
  Budgets budgets;
  budgets.triangles = sketch_triangles;
  budgets.page_loads = 0;
  const Directory& d = cut.directory();
  cut.adapt(ErrorScale::uniform(d.grid), 0, budgets);
  const auto sketch = extract_mesh(cut.draw_list(), {false, false});
  const Box3d whole = world_box(d);
  // The sketch of a surface of thousands of pieces may lack most of them: then the box stands for it.
  Box3d sketched;
  if (sketch)
    for (const Vec3d& p : sketch->positions) sketched.add(p);
  if (!sketched.empty() && length(sketched.hi - sketched.lo) > least_sketch * length(whole.hi - whole.lo))
    return sketch->positions;
  return corners(whole);
}

Box3d world_box(const Directory& d) {
  Box3d box;
  box.add(d.grid.world(d.lo));
  box.add(d.grid.world(d.hi));
  return box;
}

double snapping_error(const Directory& d) {
  return d.grid.step * std::sqrt(3.0) / 2;
}

const char* name(Binding binding) {
  switch (binding) {
    case Binding::nothing:
      return "nothing";
    case Binding::adapt_time:
      return "adapt time";
    case Binding::triangles:
      return "triangles";
    case Binding::page_loads:
      return "page loads";
    case Binding::resident_bytes:
      return "resident bytes";
    case Binding::upload_bytes:
      return "upload bytes";
  }
  return "nothing";
}

}  // namespace cuesta::app
