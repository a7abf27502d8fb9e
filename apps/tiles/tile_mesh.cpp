#include "apps/tiles/tile_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "ooc/oct_normal.h"

namespace cuesta::tiles {
namespace {

constexpr int normal_bits = 16;

Vec3i place(const DrawVertex& v) {
  return {v.x, v.y, v.z};
}

Vec3d position(const DrawVertex& v) {
  return vec_cast<double>(place(v));
}

Vec3f normal(const DrawVertex& v) {
  return decode_oct({v.normal_u, v.normal_v}, normal_bits);
}

void set_normal(DrawVertex& v, Vec3f n) {
  const auto code = encode_oct(n, normal_bits);
  v.normal_u = code[0];
  v.normal_v = code[1];
}

bool before(const DrawVertex& a, const DrawVertex& b) {
  return std::tie(a.x, a.y, a.z, a.normal_u, a.normal_v, a.colour) <
         std::tie(b.x, b.y, b.z, b.normal_u, b.normal_v, b.colour);
}

/// Where the border is on the way between two points on either side of it. A cone is met a little beside the
/// line of distances: a few steps of the secant come to it.
double crossing(Vec3d a, Vec3d b, const PartBorder& border, double margin) {
  double low = 0, high = 1;
  double at_low = border.distance(a) + margin, at_high = border.distance(b) + margin;
  double t = at_low / (at_low - at_high);
  for (int i = 0; i < 8 && border.radial != 0; ++i) {
    const double at = border.distance(a + (b - a) * t) + margin;
    if ((at < 0) == (at_low < 0))
      low = t, at_low = at;
    else
      high = t, at_high = at;
    if (at_low == at_high) break;
    t = low + (high - low) * at_low / (at_low - at_high);
  }
  return t;
}

class Clipping {
 public:
  Clipping(TileMesh& mesh, const PartBorder& border, double margin)
      : mesh_(mesh), border_(border), margin_(margin) {
    outside_.reserve(mesh.vertices.size());
    for (const DrawVertex& v : mesh.vertices) outside_.push_back(border.distance(position(v)) + margin < 0);
  }

  void run() {
    const auto triangles = std::exchange(mesh_.triangles, {});
    mesh_.triangles.reserve(triangles.size());
    for (const auto& t : triangles) {
      const int out = outside_[t[0]] + outside_[t[1]] + outside_[t[2]];
      if (out == 0)
        mesh_.triangles.push_back(t);
      else if (out < 3)
        cut(t);
    }
  }

 private:
  void cut(const std::array<std::uint32_t, 3>& t) {
    std::array<std::uint32_t, 4> polygon{};
    std::size_t corners = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      if (!outside_[a]) polygon[corners++] = a;
      if (outside_[a] != outside_[b]) polygon[corners++] = between(a, b);
    }
    for (std::size_t i = 2; i < corners; ++i) add({polygon[0], polygon[i - 1], polygon[i]});
  }

  void add(const std::array<std::uint32_t, 3>& t) {
    const Vec3i a = place(mesh_.vertices[t[0]]), b = place(mesh_.vertices[t[1]]),
                c = place(mesh_.vertices[t[2]]);
    if (a != b && b != c && c != a) mesh_.triangles.push_back(t);
  }

  std::uint32_t between(std::uint32_t a, std::uint32_t b) {
    if (before(mesh_.vertices[b], mesh_.vertices[a])) std::swap(a, b);
    const auto [at, is_new] = made_.try_emplace({a, b}, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(mix(mesh_.vertices[a], mesh_.vertices[b]));
    return at->second;
  }

  DrawVertex mix(const DrawVertex& a, const DrawVertex& b) const {
    const double t = crossing(position(a), position(b), border_, margin_);
    const Vec3d p = position(a) + (position(b) - position(a)) * t;
    DrawVertex v = t < 0.5 ? a : b;
    v.x = static_cast<std::int32_t>(std::lround(p.x));
    v.y = static_cast<std::int32_t>(std::lround(p.y));
    v.z = static_cast<std::int32_t>(std::lround(p.z));
    const auto f = static_cast<float>(t);
    const Vec3f n = normal(a) * (1 - f) + normal(b) * f;
    if (dot(n, n) > 0) set_normal(v, normalized(n));
    for (std::size_t i = 0; i < v.colour.size(); ++i)
      v.colour[i] = static_cast<std::uint8_t>(std::lround(a.colour[i] * (1 - t) + b.colour[i] * t));
    return v;
  }

  TileMesh& mesh_;
  const PartBorder& border_;
  double margin_;
  std::vector<std::uint8_t> outside_;  // of the vertices that were there before
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> made_;
};

}  // namespace

void clip(TileMesh& mesh, const PartBorder& border, double margin) {
  Clipping(mesh, border, margin).run();
}

double bow(const TileMesh& mesh, const PartBorder& border) {
  if (border.radial == 0) return 0;
  const double axial_sq = 1 - border.radial * border.radial;
  double most = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3d p[3] = {position(mesh.vertices[t[0]]), position(mesh.vertices[t[1]]),
                        position(mesh.vertices[t[2]])};
    const bool out[3] = {border.distance(p[0]) < 0, border.distance(p[1]) < 0, border.distance(p[2]) < 0};
    if (out[0] == out[1] && out[1] == out[2]) continue;
    const Vec3d q = p[0] - border.apex;
    const double from_axis = length(q - border.inward * (dot(border.inward, q) / axial_sq));
    double length_sq = 0;
    for (int i = 0; i < 3; ++i)
      length_sq = std::max(length_sq, dot(p[i] - p[(i + 1) % 3], p[i] - p[(i + 1) % 3]));
    // No more than the edge itself, next to the axis.
    most = std::max(most, std::min(length_sq / 8 * std::abs(border.radial) / std::max(from_axis, 1.0),
                                   std::sqrt(length_sq)));
  }
  return most;
}

void sort(TileMesh& mesh) {
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t corner : t) used[corner] = 1;
  std::vector<std::uint32_t> order;
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (used[v]) order.push_back(v);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return before(mesh.vertices[a], mesh.vertices[b]); });
  std::vector<std::uint32_t> number(mesh.vertices.size());
  std::vector<DrawVertex> vertices;
  for (const std::uint32_t v : order) {
    if (vertices.empty() || before(vertices.back(), mesh.vertices[v])) vertices.push_back(mesh.vertices[v]);
    number[v] = static_cast<std::uint32_t>(vertices.size() - 1);
  }
  for (auto& t : mesh.triangles) {
    for (std::uint32_t& corner : t) corner = number[corner];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  }
  std::sort(mesh.triangles.begin(), mesh.triangles.end());
  mesh.vertices = std::move(vertices);
}

void add_normals(TileMesh& mesh) {
  struct Hash {
    std::size_t operator()(Vec3i p) const {
      const auto mixed = [](std::int32_t v, std::uint64_t k) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)) * k;
      };
      return mixed(p.x, 0x9E3779B97F4A7C15u) ^ mixed(p.y, 0xC2B2AE3D27D4EB4Fu) ^
             mixed(p.z, 0x165667B19E3779F9u);
    }
  };
  std::unordered_map<Vec3i, Vec3d, Hash> sums;
  for (const auto& t : mesh.triangles) {
    const Vec3d a = position(mesh.vertices[t[0]]);
    const Vec3d area = cross(position(mesh.vertices[t[1]]) - a, position(mesh.vertices[t[2]]) - a);
    for (const std::uint32_t corner : t) {
      Vec3d& sum = sums[place(mesh.vertices[corner])];
      sum = sum + area;
    }
  }
  for (DrawVertex& v : mesh.vertices) {
    const auto sum = sums.find(place(v));
    if (sum != sums.end()) set_normal(v, vec_cast<float>(normalized(sum->second)));
  }
}

double longest_edge(const TileMesh& mesh) {
  double most = 0;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d way = position(mesh.vertices[t[i]]) - position(mesh.vertices[t[(i + 1) % 3]]);
      most = std::max(most, dot(way, way));
    }
  return std::sqrt(most);
}

}  // namespace cuesta::tiles
