#pragma once
/// Small scenes for tests that draw: pools with everything changed, a sphere, single triangles.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "ooc/oct_normal.h"
#include "runtime/draw/picture_compare.h"
#include "runtime/draw/renderer.h"

namespace cuesta::test {

constexpr Rgba8 white{255, 255, 255, 255};

/// Pools and ranges of a DrawList. Counter-clockwise is outside.
struct Scene {
  Grid grid;
  std::vector<DrawVertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<Range> draws, changed_vertices, changed_indices;

  std::uint32_t add_vertex(Vec3i p, Vec3f normal = {}, Rgba8 colour = white) {
    const auto code = encode_oct(normal, 16);
    vertices.push_back({p.x, p.y, p.z, code[0], code[1], colour});
    return static_cast<std::uint32_t>(vertices.size() - 1);
  }
  /// Three vertices of their own, shaded flat.
  void add_triangle(Vec3i a, Vec3i b, Vec3i c, Rgba8 colour = white) {
    for (const Vec3i p : {a, b, c}) indices.push_back(add_vertex(p, {}, colour));
  }
  void add_quad(Vec3i a, Vec3i b, Vec3i c, Vec3i d, Rgba8 colour = white) {
    add_triangle(a, b, c, colour);
    add_triangle(a, c, d, colour);
  }
  void draw_all() { draws = {{0, static_cast<std::uint32_t>(indices.size())}}; }
  DrawList list() const { return {grid, vertices, {}, indices, draws, changed_vertices, changed_indices}; }
};

/// Icosahedron, each triangle cut in four `levels` times; smooth normals. Positions rounded to grid steps.
inline Scene sphere(int levels, double radius_steps, Vec3i centre = {}) {
  const double g = std::numbers::phi;
  std::vector<Vec3d> points;
  for (const double s : {-1.0, 1.0})
    for (const double t : {-g, g}) {
      points.push_back(normalized(Vec3d{0, s, t}));
      points.push_back(normalized(Vec3d{s, t, 0}));
      points.push_back(normalized(Vec3d{t, 0, s}));
    }
  using Face = std::array<std::uint32_t, 3>;
  std::vector<Face> faces;
  const double edge = 2 / std::sqrt(1 + g * g);
  const auto near = [&](std::uint32_t i, std::uint32_t j) {
    return std::abs(length(points[i] - points[j]) - edge) < 1e-6;
  };
  for (std::uint32_t i = 0; i < 12; ++i)
    for (std::uint32_t j = i + 1; j < 12; ++j)
      for (std::uint32_t k = j + 1; k < 12; ++k) {
        if (!near(i, j) || !near(j, k) || !near(i, k)) continue;
        const bool outside = dot(cross(points[j] - points[i], points[k] - points[i]), points[i]) > 0;
        faces.push_back(outside ? Face{i, j, k} : Face{i, k, j});
      }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, added] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (added) points.push_back(normalized(points[a] + points[b]));
      return at->second;
    };
    std::vector<Face> finer;
    for (const auto& [a, b, c] : faces) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {Face{a, ab, ca}, Face{ab, b, bc}, Face{ca, bc, c}, Face{ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  Scene scene;
  for (const Vec3d p : points) {
    const Vec3d q = p * radius_steps;
    scene.add_vertex(centre + Vec3i{static_cast<std::int32_t>(std::lround(q.x)),
                                    static_cast<std::int32_t>(std::lround(q.y)),
                                    static_cast<std::int32_t>(std::lround(q.z))},
                     vec_cast<float>(p));
  }
  for (const Face& face : faces) scene.indices.insert(scene.indices.end(), face.begin(), face.end());
  scene.draw_all();
  return scene;
}

/// From `distance` on the z axis in front of `target`, looking along -z.
inline View view_from_front(double distance, Vec3d target = {}) {
  View view;
  view.eye = target + Vec3d{0, 0, distance};
  view.target = target;
  view.width_px = 320;
  view.height_px = 240;
  return view;
}

inline std::unique_ptr<Renderer> make_renderer() {
  auto context = make_osmesa_context();
  if (!context) throw std::runtime_error(context.error().text());
  auto renderer = Renderer::create(std::move(*context));
  if (!renderer) throw std::runtime_error(renderer.error().text());
  return std::move(*renderer);
}

inline Picture draw(Renderer& renderer, const Scene& scene, const View& view,
                    const DrawOptions& options = {}) {
  const auto drawn = renderer.draw(scene.list(), view, options);
  if (!drawn) throw std::runtime_error(drawn.error().text());
  auto picture = renderer.read();
  if (!picture) throw std::runtime_error(picture.error().text());
  return std::move(*picture);
}

inline Picture draw(const Scene& scene, const View& view, const DrawOptions& options = {}) {
  return draw(*make_renderer(), scene, view, options);
}

inline Rgba8 at(const Picture& picture, int x, int y) {
  return picture.pixels[static_cast<std::size_t>(y * picture.width_px + x)];
}

inline int brightness(Rgba8 c) {
  return c[0] + c[1] + c[2];
}

/// Pixels of another colour than `background`.
inline std::size_t covered(const Picture& picture, Rgba8 background = white) {
  return picture.pixels.size() - static_cast<std::size_t>(std::ranges::count(picture.pixels, background));
}

}  // namespace cuesta::test
