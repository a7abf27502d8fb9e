#include "apps/scene_show/part_ray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "apps/view/ray.h"
#include "apps/view/surface_ray.h"

namespace cuesta::scene_show {
namespace {

using view::Ray;

/// An object that the ray may meet: a TOM of a group, or a surface.
struct Candidate {
  double nearest = 0;
  const DrawnInstance* as = nullptr;
  const DrawnGroup* group = nullptr;
  const DrawnSurface* surface = nullptr;
};

/// Nearest balls first.
std::vector<Candidate> candidates(const LiveScene& scene, const Ray& ray) {
  std::vector<Candidate> all;
  const auto add = [&](Candidate c) {
    const Ball& ball = scene.ball(c.as->instance);
    c.nearest = ray.distance(ball.centre, ball.radius);
    if (std::isfinite(c.nearest)) all.push_back(c);
  };
  const SceneDrawList list = scene.list();
  for (const DrawnGroup& g : list.groups)
    for (const DrawnInstance& i : list.instances.subspan(g.first, g.count)) add({0, &i, &g, nullptr});
  for (const DrawnSurface& s : list.surfaces) add({0, &s.as, nullptr, &s});
  std::sort(all.begin(), all.end(),
            [](const Candidate& a, const Candidate& b) { return a.nearest < b.nearest; });
  return all;
}

/// Lengths along it are those of the world's ray: the direction is stretched with the part.
Ray within(const Affine& world, const Ray& ray) {
  const Affine in = inverse(world);
  return {in.point(ray.origin), in.vector(ray.direction)};
}

double distance_to_tom(const DrawnGroup& group, const Ray& ray) {
  const Tom& tom = *group.tom;
  const Ray near{ray.origin - tom.origin, ray.direction};
  const auto at = [&](std::uint32_t v) { return vec_cast<double>(tom.positions[v]); };
  double nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : group.indices->triangles)
    nearest = std::min(nearest, near.distance(at(t[0]), at(t[1]), at(t[2])));
  return nearest;
}

double distance_to_surface(const DrawnSurface& surface, const Directory& directory, const Ray& ray) {
  const double stretch = length(ray.direction);
  const auto d = view::distance_along(surface.list, directory, ray.origin, ray.direction / stretch);
  return d ? *d / stretch : std::numeric_limits<double>::infinity();
}

}  // namespace

std::optional<PartHit> part_along(const LiveScene& scene, Vec3d origin, Vec3d direction) {
  const Ray ray{origin, direction};
  PartHit hit{0, std::numeric_limits<double>::infinity()};
  for (const Candidate& c : candidates(scene, ray)) {
    if (c.nearest > hit.distance) break;
    const Ray in = within(c.as->world, ray);
    const double d = c.group ? distance_to_tom(*c.group, in)
                             : distance_to_surface(*c.surface, *scene.surface_directory(c.as->instance), in);
    if (d < hit.distance) hit = {c.as->instance, d};
  }
  if (!std::isfinite(hit.distance)) return {};
  return hit;
}

}  // namespace cuesta::scene_show
