#include "apps/tiles/quantized_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace cuesta::tiles {
namespace {

constexpr std::uint32_t not_used = std::numeric_limits<std::uint32_t>::max();
constexpr double always_seen = 1e3;  // radii: from nowhere is such a point behind the horizon

class Bytes {
 public:
  std::vector<std::byte> all;
  template <class T>
  void put(T value) {
    const auto raw = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
    all.insert(all.end(), raw.begin(), raw.end());
  }
  void put(Vec3d v) {
    for (const double c : {v.x, v.y, v.z}) put(c);
  }
  void align(std::size_t to) { all.resize((all.size() + to - 1) / to * to); }
};

/// Vertices in the order in which triangles name them first, as the coding of indices asks for.
struct Numbered {
  std::vector<TerrainVertex> vertices;
  std::vector<std::uint32_t> indices;
};

Numbered by_first_use(const TerrainTileMesh& tile) {
  Numbered n;
  std::vector<std::uint32_t> number(tile.vertices.size(), not_used);
  for (const auto& t : tile.triangles)
    for (const std::uint32_t corner : t) {
      if (number[corner] == not_used) {
        number[corner] = static_cast<std::uint32_t>(n.vertices.size());
        n.vertices.push_back(tile.vertices[corner]);
      }
      n.indices.push_back(number[corner]);
    }
  return n;
}

Vec3d ecef_of(const GeoBox& box, const TerrainVertex& v) {
  const double u = static_cast<double>(v.u) / terrain_steps, w = static_cast<double>(v.v) / terrain_steps;
  return Frame::ecef().position_m(
      Geodetic{std::lerp(box.south_deg, box.north_deg, w), std::lerp(box.west_deg, box.east_deg, u), v.h_m});
}

/// In units of the ellipsoid's half axes.
Vec3d scaled(Vec3d p) {
  const double a = wgs84_ellipsoid.equatorial_radius_m, b = a * (1 - 1 / wgs84_ellipsoid.inverse_flattening);
  return {p.x / a, p.y / a, p.z / b};
}

/// A point that is behind the horizon only where all the others are. Source: Cozzi and Ring, "3D Engine
/// Design for Virtual Globes", 2011, and Cesium's blog, "Horizon culling".
Vec3d horizon_point(const std::vector<Vec3d>& points, Vec3d centre) {
  const Vec3d direction = normalized(scaled(centre));
  double most = 0;
  for (const Vec3d& p : points) {
    const Vec3d s = scaled(p);
    const double size = std::max(length(s), 1.0);
    const double cos_a = dot(normalized(s), direction), sin_a = length(cross(normalized(s), direction));
    const double cos_b = 1 / size, sin_b = std::sqrt(size * size - 1) * cos_b;
    const double down = cos_a * cos_b - sin_a * sin_b;
    most = std::max(most, down > 1 / always_seen ? 1 / down : always_seen);
  }
  return direction * most;
}

void put_header(Bytes& out, const std::vector<Vec3d>& points, double least, double most) {
  Box3d box;
  for (const Vec3d& p : points) box.add(p);
  const Vec3d centre = (box.lo + box.hi) * 0.5;
  double radius = 0;
  for (const Vec3d& p : points) radius = std::max(radius, length(p - centre));
  out.put(centre);
  out.put(static_cast<float>(least));
  out.put(static_cast<float>(most));
  out.put(centre);
  out.put(radius);
  out.put(horizon_point(points, centre));
}

template <class Of>
void put_deltas(Bytes& out, const std::vector<TerrainVertex>& vertices, const Of& of) {
  std::int32_t last = 0;
  for (const TerrainVertex& v : vertices) {
    const std::int32_t delta = of(v) - last;
    last += delta;
    out.put(static_cast<std::uint16_t>((delta << 1) ^ (delta >> 31)));
  }
}

template <class Index>
void put_indices(Bytes& out, const Numbered& n) {
  out.align(sizeof(Index));
  out.put(static_cast<std::uint32_t>(n.indices.size() / 3));
  std::uint32_t highest = 0;
  for (const std::uint32_t index : n.indices) {
    out.put(static_cast<Index>(highest - index));
    highest += index == highest;
  }
  const auto put_edge = [&](auto on_edge, auto along) {
    std::vector<std::uint32_t> edge;
    for (std::uint32_t v = 0; v < n.vertices.size(); ++v)
      if (on_edge(n.vertices[v])) edge.push_back(v);
    std::sort(edge.begin(), edge.end(),
              [&](std::uint32_t a, std::uint32_t b) { return along(n.vertices[a]) < along(n.vertices[b]); });
    out.put(static_cast<std::uint32_t>(edge.size()));
    for (const std::uint32_t v : edge) out.put(static_cast<Index>(v));
  };
  const auto u = [](const TerrainVertex& v) { return v.u; };
  const auto v = [](const TerrainVertex& w) { return w.v; };
  put_edge([](const TerrainVertex& w) { return w.u == 0; }, v);
  put_edge([](const TerrainVertex& w) { return w.v == 0; }, u);
  put_edge([](const TerrainVertex& w) { return w.u == terrain_steps; }, v);
  put_edge([](const TerrainVertex& w) { return w.v == terrain_steps; }, u);
}

/// Octahedral, a byte each, 0 to 255.
void put_normal(Bytes& out, Vec3f n) {
  const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  float x = n.x / sum, y = n.y / sum;
  if (n.z < 0) {
    const float folded = (1 - std::abs(y)) * (x < 0 ? -1.0f : 1.0f);
    y = (1 - std::abs(x)) * (y < 0 ? -1.0f : 1.0f);
    x = folded;
  }
  for (const float c : {x, y})
    out.put(static_cast<std::uint8_t>(std::lround((std::clamp(c, -1.0f, 1.0f) + 1) * 127.5f)));
}

}  // namespace

std::vector<std::byte> encode_quantized_mesh(const TerrainTileMesh& tile) {
  const Numbered n = by_first_use(tile);
  const auto [lowest, highest] = std::minmax_element(
      n.vertices.begin(), n.vertices.end(), [](const auto& a, const auto& b) { return a.h_m < b.h_m; });
  // As the header's f32 have them, and around all heights.
  const double least = static_cast<double>(std::nextafter(static_cast<float>(lowest->h_m), -1e9f));
  const double most = static_cast<double>(std::nextafter(static_cast<float>(highest->h_m), 1e9f));
  std::vector<Vec3d> points;
  for (const TerrainVertex& v : n.vertices) points.push_back(ecef_of(tile.box, v));
  Bytes out;
  put_header(out, points, least, most);
  out.put(static_cast<std::uint32_t>(n.vertices.size()));
  put_deltas(out, n.vertices, [](const TerrainVertex& v) { return v.u; });
  put_deltas(out, n.vertices, [](const TerrainVertex& v) { return v.v; });
  put_deltas(out, n.vertices, [&](const TerrainVertex& v) {
    return static_cast<std::int32_t>(std::lround((v.h_m - least) / (most - least) * terrain_steps));
  });
  if (n.vertices.size() > 65536)
    put_indices<std::uint32_t>(out, n);
  else
    put_indices<std::uint16_t>(out, n);
  out.put(std::uint8_t{1});  // octvertexnormals
  out.put(static_cast<std::uint32_t>(2 * n.vertices.size()));
  for (const TerrainVertex& v : n.vertices) put_normal(out, v.normal);
  return out.all;
}

}  // namespace cuesta::tiles
