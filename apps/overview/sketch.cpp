#include "apps/overview/sketch.h"

#include "apps/overview/file_facts.h"
#include "runtime/extract.h"
#include "runtime/view_fit.h"

namespace cuesta::app {
namespace {

constexpr std::uint64_t sketch_triangles = 4000;
constexpr double least_sketch = 0.8;  // of the box's diagonal, for a sketch to stand for the surface

std::vector<Vec3d> corners(const Box3d& box) {
  std::vector<Vec3d> points;
  for (const double x : {box.lo.x, box.hi.x})
    for (const double y : {box.lo.y, box.hi.y})
      for (const double z : {box.lo.z, box.hi.z}) points.push_back({x, y, z});
  return points;
}

}  // namespace

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

View first_view(Cut& cut, const std::optional<terrain_view::TerrainLook>& look, const View& view) {
  const auto points = sketch_points(cut);
  return look ? terrain_view::first_view(*look, points, view)
              : fit_view(points, three_quarter_direction(view.up), view);
}

}  // namespace cuesta::app
