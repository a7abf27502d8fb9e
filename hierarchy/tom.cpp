#include "hierarchy/tom.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hierarchy/tom_ancestors.h"
#include "ooc/check.h"

namespace cuesta {
namespace {

/// The number of triangles for which `below(triangle_resolution)` holds; these are the first.
template <class Below>
std::uint32_t count_while(const Tom& tom, const Below& below) {
  const auto end = std::partition_point(tom.triangles.begin(), tom.triangles.end(), [&](const Triangle& t) {
    return below(triangle_resolution(tom.substitute, tom.base_vertices, t));
  });
  return static_cast<std::uint32_t>(end - tom.triangles.begin());
}

/// Up to so many, extract_triangles() makes a table.
constexpr std::uint64_t table_entries_per_triangle = 8;

template <class T>
bool fits(const std::vector<T>& attribute, std::size_t vertices) {
  return attribute.empty() || attribute.size() == vertices;
}

/// Exact at both ends.
float mixed(float a, float b, float amount) {
  return a * (1 - amount) + b * amount;
}
Vec3f mixed(Vec3f a, Vec3f b, float amount) {
  return a * (1 - amount) + b * amount;
}

bool substitutes_precede(const Tom& tom) {
  for (std::uint32_t v = 0; v < tom.substitute.size(); ++v)
    if (v < tom.base_vertices ? tom.substitute[v] != v : tom.substitute[v] >= v) return false;
  return tom.substitute.size() == tom.positions.size();
}

bool triangles_rise(const Tom& tom) {
  Resolution last = 0;
  for (const Triangle& t : tom.triangles) {
    for (std::uint32_t c : t)
      if (c >= tom.full()) return false;
    if (is_degenerate(t)) return false;
    const Resolution r = triangle_resolution(tom.substitute, tom.base_vertices, t);
    if (r < last) return false;
    last = r;
  }
  return true;
}

bool errors_rise(const Tom& tom) {
  TomErrorStep last{tom.full() + 1, 0};
  for (const TomErrorStep& s : tom.errors) {
    if (s.below > last.below || !(s.error > last.error) || !std::isfinite(s.error)) return false;
    if (s.below <= tom.base_vertices) return false;
    last = s;
  }
  return true;
}

}  // namespace

Resolution triangle_resolution(std::span<const std::uint32_t> substitute, Resolution base_vertices,
                               Triangle t) {
  for (;;) {
    std::uint32_t& last = t[0] > t[1] ? (t[0] > t[2] ? t[0] : t[2]) : (t[1] > t[2] ? t[1] : t[2]);
    if (last < base_vertices) return base_vertices;
    const std::uint32_t removed = last;
    last = substitute[last];
    if (is_degenerate(t)) return removed + 1;
  }
}

std::uint32_t triangle_count(const Tom& tom, Resolution n) {
  return count_while(tom, [n](Resolution r) { return r <= n; });
}

Resolution whole_resolution(const Tom& tom, Resolution n) {
  n = std::clamp(n, tom.base_vertices, tom.full());
  while (n > tom.base_vertices && n < tom.full() && tom.positions[n] == tom.positions[n - 1]) --n;
  return n;
}

Resolution resolution_of_triangles(const Tom& tom, std::uint32_t triangles) {
  if (triangles >= tom.triangles.size()) return tom.full();
  // The first triangle too many must not be there yet.
  const Resolution too_fine =
      triangle_resolution(tom.substitute, tom.base_vertices, tom.triangles[triangles]);
  return whole_resolution(tom, std::max<Resolution>(too_fine, 1) - 1);
}

Resolution resolution_of_error(const Tom& tom, float error) {
  const auto step = std::partition_point(tom.errors.begin(), tom.errors.end(),
                                         [error](const TomErrorStep& s) { return s.error <= error; });
  if (step == tom.errors.end()) return tom.base_vertices;
  Resolution n = step->below;
  if (n > tom.full()) return tom.full();
  while (whole_resolution(tom, n) != n) ++n;
  return n;
}

float error_at(const Tom& tom, Resolution n) {
  const auto step = std::partition_point(tom.errors.begin(), tom.errors.end(),
                                         [n](const TomErrorStep& s) { return s.below > n; });
  return step == tom.errors.begin() ? 0.0f : (step - 1)->error;
}

std::uint32_t extract_triangles(const Tom& tom, Resolution n, std::span<Triangle> out) {
  CUESTA_CHECK(n >= tom.base_vertices && n <= tom.full(), n);
  const std::uint32_t count = triangle_count(tom, n);
  CUESTA_CHECK(out.size() >= count, out.size(), count);
  const auto triangles = std::span(tom.triangles).first(count);
  // A table of what has gone is faster than chains where it is not much longer than what is written.
  if (const std::uint32_t gone = tom.full() - n; n > 0 && gone < table_entries_per_triangle * count) {
    TomAncestors ancestors;
    ancestors.fill(tom.substitute, n, tom.full());
    ancestors.look_up(triangles, out.data());
  } else {
    std::transform(triangles.begin(), triangles.end(), out.begin(),
                   [&](const Triangle& t) { return active_corners(tom, t, n); });
  }
  return count;
}

TomVertex geomorph(const Tom& tom, std::uint32_t v, float amount) {
  const std::uint32_t s = tom.substitute[v];
  TomVertex out;
  out.position = mixed(tom.positions[v], tom.positions[s], amount);
  if (!tom.normals.empty()) out.normal = normalized(mixed(tom.normals[v], tom.normals[s], amount));
  if (!tom.colours.empty())
    for (std::size_t i = 0; i < 4; ++i) {
      out.colour[i] =
          static_cast<std::uint8_t>(std::lround(mixed(tom.colours[v][i], tom.colours[s][i], amount)));
    }
  if (!tom.texcoords.empty())
    for (std::size_t i = 0; i < 2; ++i)
      out.texcoord[i] = mixed(tom.texcoords[v][i], tom.texcoords[s][i], amount);
  return out;
}

std::uint64_t size_bytes(const Tom& tom) {
  const auto bytes = [](const auto& array) { return std::span(array).size_bytes(); };
  return bytes(tom.positions) + bytes(tom.normals) + bytes(tom.colours) + bytes(tom.texcoords) +
         bytes(tom.substitute) + bytes(tom.triangles) + bytes(tom.errors);
}

SurfaceMesh surface_at(const Tom& tom, Resolution n) {
  SurfaceMesh mesh;
  mesh.positions.reserve(n);
  for (Resolution v = 0; v < n; ++v)
    mesh.positions.push_back(tom.origin + vec_cast<double>(tom.positions[v]));
  const auto prefix = [n](auto& to, const auto& from) {
    if (!from.empty()) to.assign(from.begin(), from.begin() + n);
  };
  prefix(mesh.normals, tom.normals);
  prefix(mesh.colours, tom.colours);
  prefix(mesh.texcoords, tom.texcoords);
  mesh.triangles.resize(triangle_count(tom, n));
  extract_triangles(tom, n, mesh.triangles);
  return mesh;
}

bool is_consistent(const Tom& tom) {
  const std::size_t n = tom.positions.size();
  if (!fits(tom.normals, n) || !fits(tom.colours, n) || !fits(tom.texcoords, n)) return false;
  if (!(tom.step > 0) || tom.base_vertices > n || (tom.base_vertices == 0) != (n == 0)) return false;
  return substitutes_precede(tom) && triangles_rise(tom) && errors_rise(tom);
}

}  // namespace cuesta
