#include "hierarchy/cell_survivors.h"

#include <algorithm>
#include <vector>

#include "hierarchy/sample_choice.h"

namespace cuesta {
namespace {

/// Puts the samples at rims first. Returns how many, 0 where all samples may stay.
std::size_t move_rim_samples_first(const SubstitutionKernel& kernel, TriangleId t, std::span<Vec3f> samples) {
  if (!kernel.vertical() || samples.size() <= max_triangle_samples) return 0;
  auto inner = samples.begin();
  for (std::size_t k = 0; k < 3; ++k) {
    const PointId p = kernel.corners(t)[k], q = kernel.corners(t)[(k + 1) % 3];
    if (!kernel.on_border(p) || !kernel.on_border(q) || kernel.edge_triangles(p, q) != 1) continue;
    const Vec3d a = vec_cast<double>(kernel.positions()[p]), b = vec_cast<double>(kernel.positions()[q]);
    inner = std::stable_partition(inner, samples.end(), [&](const Vec3f& s) {
      return inside_of(vec_cast<double>(s), a, b, normalized(vec_cast<double>(kernel.vertical()->up(s)))) <
             rim_width;
    });
  }
  return static_cast<std::size_t>(inner - samples.begin());
}

}  // namespace

CellSurvivors survivors_of(const SubstitutionKernel& kernel, const SurfaceSamples& samples) {
  CellSurvivors out;
  out.triangles.reserve(kernel.live_triangles());
  out.corners.reserve(kernel.live_triangles());
  out.births.reserve(kernel.live_triangles());
  out.samples.begin.reserve(kernel.live_triangles() + 1);
  out.samples.begin.push_back(0);
  SampleChoice choice(kernel.vertical());
  std::vector<Vec3f> kept;
  for (TriangleId t = 0; t < kernel.triangle_count(); ++t) {
    if (!kernel.alive(t)) continue;
    out.triangles.push_back(t);
    out.corners.push_back(kernel.vertices(t));
    out.births.push_back({kernel.birth_error(t), {}});
    const auto all = samples.of(t);
    kept.assign(all.begin(), all.end());
    const std::span inner = std::span(kept).subspan(move_rim_samples_first(kernel, t, kept));
    const auto at = [&](int k) { return kernel.positions()[kernel.corners(t)[k]]; };
    const std::size_t left_out =
        inner.size() - choice.keep(inner, {at(0), at(1), at(2)}, max_triangle_samples);
    kept.resize(kept.size() - left_out);
    for (const Vec3f& p : kept) out.samples.points.push_back(vec_cast<std::int32_t>(p) + kernel.origin());
    out.samples.begin.push_back(static_cast<std::uint32_t>(out.samples.points.size()));
  }
  return out;
}

}  // namespace cuesta
