#include "tools/scan_generator/surface_noise.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "ooc/check.h"
#include "tools/scan_generator/random.h"

namespace cuesta::tools {
namespace {

double fade(double t) {
  return t * t * t * (t * (t * 6 - 15) + 10);
}

double lerp(double t, double a, double b) {
  return a + t * (b - a);
}

/// One of twelve gradients, (±1, ±1, 0) and its turns, dotted with the way from the lattice point.
double gradient_dot(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t seed, Vec3d way) {
  const std::uint64_t cell = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ull ^
                             static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4full ^
                             static_cast<std::uint64_t>(z) * 0x165667b19e3779f9ull;
  const std::uint64_t bits = mixed(cell + seed);
  const double u = bits & 1 ? 1 : -1, v = bits & 2 ? 1 : -1;
  switch ((bits >> 32) % 3) {
    case 0:
      return u * way.x + v * way.y;
    case 1:
      return u * way.y + v * way.z;
    default:
      return u * way.z + v * way.x;
  }
}

Vec3d random_shift(std::uint64_t seed) {
  const auto part = [seed](std::uint64_t i) { return unit_interval(mixed(seed + i)); };
  return {part(1), part(2), part(3)};
}

}  // namespace

double gradient_noise(Vec3d p, std::uint64_t seed) {
  const Vec3d cell{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
  const Vec3d t = p - cell;
  const auto x = static_cast<std::int64_t>(cell.x), y = static_cast<std::int64_t>(cell.y),
             z = static_cast<std::int64_t>(cell.z);
  const auto at = [&](int i, int j, int k) {
    return gradient_dot(x + i, y + j, z + k, seed, {t.x - i, t.y - j, t.z - k});
  };
  const double u = fade(t.x), v = fade(t.y), w = fade(t.z);
  return lerp(w, lerp(v, lerp(u, at(0, 0, 0), at(1, 0, 0)), lerp(u, at(0, 1, 0), at(1, 1, 0))),
              lerp(v, lerp(u, at(0, 0, 1), at(1, 0, 1)), lerp(u, at(0, 1, 1), at(1, 1, 1))));
}

std::vector<Octave> scan_octaves(double mean_edge, double total) {
  if (!(mean_edge > 0) || !(total > 0)) return {};
  const double finest = mean_edge / 4;
  const int count = std::max(1, static_cast<int>(std::lround(std::log2(total / finest + 1))));
  const double scale = total / (std::exp2(count) - 1);
  std::vector<Octave> octaves;
  for (int i = 0; i < count; ++i) octaves.push_back({mean_edge * 4 * std::exp2(i), scale * std::exp2(i)});
  return octaves;
}

void set_normals(SurfaceMesh& mesh) {
  // In f32: sums of a handful of cross products, scaled by a typical one so that none underflows.
  const double edge = mean_edge_length(mesh);
  const double scale = edge > 0 ? 1 / (edge * edge) : 0;
  mesh.normals.assign(mesh.positions.size(), {});
  for (const auto& t : mesh.triangles) {
    const Vec3d a = mesh.positions[t[0]];
    const Vec3d n = cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a) * scale;
    for (const std::uint32_t v : t) mesh.normals[v] = mesh.normals[v] + vec_cast<float>(n);
  }
  for (Vec3f& n : mesh.normals) n = normalized(n);
}

double mean_edge_length(const SurfaceMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) sum += length(mesh.positions[t[(i + 1) % 3]] - mesh.positions[t[i]]);
  }
  return mesh.triangles.empty() ? 0 : sum / (3 * static_cast<double>(mesh.triangles.size()));
}

void roughen(SurfaceMesh& mesh, const std::vector<Octave>& octaves, std::uint64_t seed) {
  CUESTA_CHECK(mesh.normals.size() == mesh.positions.size());
  const auto displacement = [&](Vec3d p) {
    double d = 0;
    for (std::size_t i = 0; i < octaves.size(); ++i) {
      const std::uint64_t own = mixed(seed * 1000 + i);
      d += octaves[i].amplitude * gradient_noise(p / octaves[i].wavelength + random_shift(own), own);
    }
    return d;
  };
  using Range = tbb::blocked_range<std::size_t>;
  tbb::parallel_for(Range(0, mesh.positions.size(), 4096), [&](const Range& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      const Vec3d p = mesh.positions[v];
      mesh.positions[v] = p + vec_cast<double>(mesh.normals[v]) * displacement(p);
    }
  });
}

}  // namespace cuesta::tools
