#include "hierarchy/attribute_quadric.h"

#include <cmath>
#include <utility>

namespace cuesta {
namespace {

Vec3d product(const std::array<double, 6>& m, Vec3d d) {
  return {m[0] * d.x + m[1] * d.y + m[2] * d.z, m[1] * d.x + m[3] * d.y + m[4] * d.z,
          m[2] * d.x + m[4] * d.y + m[5] * d.z};
}

}  // namespace

double AttributeQuadricFairness::Sums::at(Vec3d d, const Numbers& values) const {
  double sum = dot(product(gg, d), d) + 2 * dot(gs, d) + ss;
  for (std::size_t k = 0; k < most_numbers; ++k)
    sum += values[k] * (values[k] * weight - 2 * (s[k] + dot(g[k], d)));
  return sum > 0 ? sum : 0;
}

/// Adds sums kept about a position that this one's is at offset d from.
void AttributeQuadricFairness::Sums::add(const Sums& other, Vec3d d) {
  const Vec3d moved = product(other.gg, d);
  weight += other.weight;
  ss += other.ss + 2 * dot(other.gs, d) + dot(moved, d);
  gs = gs + other.gs + moved;
  for (std::size_t i = 0; i < gg.size(); ++i) gg[i] += other.gg[i];
  for (std::size_t k = 0; k < most_numbers; ++k) {
    s[k] += other.s[k] + dot(other.g[k], d);
    g[k] = g[k] + other.g[k];
  }
}

AttributeQuadricFairness::AttributeQuadricFairness(const SubstitutionKernel& kernel, const SurfaceMesh& mesh,
                                                   std::span<const std::uint32_t> source, float scale)
    : kernel_(kernel), planes_(kernel), sums_(source.size()) {
  values_.reserve(source.size());
  for (const std::uint32_t v : source) values_.push_back(numbers_of(mesh, v, scale));
  for (PointId p = 0; p < kernel.point_count(); ++p)
    for (const TriangleId t : kernel.star(p))
      if (kernel.corners(t)[0] == p) add_triangle(t);
}

AttributeQuadricFairness::Numbers AttributeQuadricFairness::numbers_of(const SurfaceMesh& mesh,
                                                                       std::uint32_t v, double scale) const {
  Numbers n{};
  if (!mesh.normals.empty())
    for (int i = 0; i < 3; ++i) n[static_cast<std::size_t>(i)] = scale * mesh.normals[v][i];
  if (!mesh.colours.empty())
    for (std::size_t i = 0; i < 3; ++i) n[3 + i] = scale * mesh.colours[v][i] / 255;
  if (!mesh.texcoords.empty())
    for (std::size_t i = 0; i < 2; ++i) n[6 + i] = scale * mesh.texcoords[v][i];
  for (double& x : n)
    if (!std::isfinite(x)) x = 0;
  return n;
}

/// Numbers are linear over the triangle; to its corners their gradients are the same.
void AttributeQuadricFairness::add_triangle(TriangleId t) {
  const auto& c = kernel_.corners(t);
  const auto at = [&](std::size_t i) { return vec_cast<double>(kernel_.positions()[c[i]]); };
  const Vec3d e1 = at(1) - at(0), e2 = at(2) - at(0), n = cross(e1, e2);
  const double squared = dot(n, n);
  if (!(squared > 0)) return;
  const std::array<std::uint32_t, 3> v{kernel_.vertex_at(t, c[0]), kernel_.vertex_at(t, c[1]),
                                       kernel_.vertex_at(t, c[2])};
  const Vec3d to1 = cross(e2, n) / squared, to2 = cross(n, e1) / squared;
  Sums common;
  common.weight = std::sqrt(squared);
  for (std::size_t k = 0; k < most_numbers; ++k) {
    const Vec3d g = to1 * (values_[v[1]][k] - values_[v[0]][k]) + to2 * (values_[v[2]][k] - values_[v[0]][k]);
    common.g[k] = g * common.weight;
    common.gg[0] += common.weight * g.x * g.x;
    common.gg[1] += common.weight * g.x * g.y;
    common.gg[2] += common.weight * g.x * g.z;
    common.gg[3] += common.weight * g.y * g.y;
    common.gg[4] += common.weight * g.y * g.z;
    common.gg[5] += common.weight * g.z * g.z;
  }
  for (const std::uint32_t vertex : v) {
    Sums own = common;
    for (std::size_t k = 0; k < most_numbers; ++k) {
      const double s = values_[vertex][k];
      own.s[k] = common.weight * s;
      own.ss += common.weight * s * s;
      own.gs = own.gs + common.g[k] * s;
    }
    sums_[vertex].add(own, {});
  }
}

/// Wedges of u that share no triangle with v have no place to go to: such a substitution is not legal, and
/// what it costs does not matter.
void AttributeQuadricFairness::costs(PointId u, std::span<const PointId> targets,
                                     std::span<float> out) const {
  const auto at = kernel_.positions();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const PointId v = targets[i];
    const Vec3d d = vec_cast<double>(at[v]) - vec_cast<double>(at[u]);
    double sum = 0, weight = 0;
    std::uint32_t last = none;
    for (const TriangleId t : kernel_.star(u)) {
      const auto& c = kernel_.corners(t);
      if (c[0] != v && c[1] != v && c[2] != v) continue;
      const std::uint32_t from = kernel_.vertex_at(t, u);
      if (from == std::exchange(last, from)) continue;
      sum += sums_[from].at(d, values_[kernel_.vertex_at(t, v)]);
      weight += sums_[from].weight;
    }
    out[i] = planes_(u, v) + (weight > 0 ? static_cast<float>(sum / std::sqrt(weight)) : 0.0f);
  }
}

void AttributeQuadricFairness::applied(PointId u, PointId v, std::span<const Child> children) {
  planes_.applied(u, v);
  const auto at = kernel_.positions();
  const Vec3d d = vec_cast<double>(at[v]) - vec_cast<double>(at[u]);
  for (const Child& c : children) sums_[c.target].add(sums_[c.vertex], d);
}

}  // namespace cuesta
