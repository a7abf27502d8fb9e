#pragma once
/// Scenes made in memory for tests: bumpy balls as TOMs in segments, in a row or where a test puts them.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>

#include "hierarchy/build_tom.h"
#include "runtime/live_scene.h"

namespace cuesta::test {

/// A ball of radius 1 with bumps; 2 · rings · sectors - 2 · sectors triangles.
inline SurfaceMesh bumpy_ball(std::uint32_t rings, std::uint32_t sectors, bool with_normals = false) {
  SurfaceMesh mesh;
  const auto add = [&](double polar, double turn) {
    const double r = 1 + 0.05 * std::sin(5 * turn) * std::sin(polar) * std::sin(4 * polar);
    mesh.positions.push_back(
        {r * std::sin(polar) * std::cos(turn), r * std::cos(polar), -r * std::sin(polar) * std::sin(turn)});
  };
  add(0, 0);
  for (std::uint32_t i = 1; i < rings; ++i)
    for (std::uint32_t k = 0; k < sectors; ++k)
      add(std::numbers::pi * i / rings, 2 * std::numbers::pi * k / sectors);
  add(std::numbers::pi, 0);
  const auto at = [&](std::uint32_t i, std::uint32_t k) { return 1 + (i - 1) * sectors + k % sectors; };
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t k = 0; k < sectors; ++k) {
    mesh.triangles.push_back({0, at(1, k), at(1, k + 1)});
    mesh.triangles.push_back({last, at(rings - 1, k + 1), at(rings - 1, k)});
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  if (with_normals)
    for (const Vec3d p : mesh.positions) mesh.normals.push_back(vec_cast<float>(normalized(p)));
  return mesh;
}

/// What a file gives when only its first vertices have come.
inline Tom prefix_of(const Tom& whole, Resolution n) {
  Tom tom = whole;
  tom.positions.resize(n);
  if (!tom.normals.empty()) tom.normals.resize(n);
  tom.substitute.resize(n);
  tom.triangles.resize(triangle_count(whole, n));
  for (Triangle& t : tom.triangles) t = active_corners(whole, t, n);
  std::erase_if(tom.errors, [n](const TomErrorStep& s) { return s.below > n; });
  return tom;
}

struct SmallScene {
  std::vector<Tom> toms;
  SceneDirectory directory;
  std::atomic<std::uint32_t> reads{0};

  /// @return its number
  std::uint32_t add_part(const SurfaceMesh& mesh) {
    toms.push_back(build_tom(mesh).value());
    const Tom& tom = toms.back();
    ScenePartEntry part;
    part.name = "part " + std::to_string(toms.size());
    for (const Vec3f p : tom.positions) part.box.add(tom.origin + vec_cast<double>(p));
    part.vertices = tom.full(), part.triangles = tom.triangles.size();
    part.attributes.normals = !tom.normals.empty();
    for (const std::uint32_t share : {64u, 16u, 4u, 1u}) {
      const Resolution n = whole_resolution(tom, std::max(tom.full() / share, 12u));
      part.segments.push_back({{}, n, triangle_count(tom, n), error_at(tom, n)});
    }
    directory.parts.push_back(part);
    return static_cast<std::uint32_t>(toms.size() - 1);
  }
  std::uint32_t add_node(std::uint32_t part, Vec3d at, std::uint32_t parent = no_index) {
    if (directory.scene.materials.empty()) directory.scene.materials.emplace_back();
    SceneNode node;
    node.part = part, node.parent = parent, node.local = Trs{at, {0, 0, 0, 1}, {1, 1, 1}};
    node.material = part == no_index ? no_index : 0;
    directory.scene.nodes.push_back(node);
    return static_cast<std::uint32_t>(directory.scene.nodes.size() - 1);
  }

  PrefixReader reader() {
    return [this](std::uint32_t part, const Tom* have, std::uint32_t have_segments,
                  std::uint32_t segments) -> Result<Tom> {
      ++reads;
      EXPECT_EQ(have != nullptr, have_segments > 0);
      return prefix_of(toms[part], directory.parts[part].segments[segments - 1].vertices);
    };
  }
};

inline std::uint64_t bytes_of_all(const SmallScene& scene) {
  std::uint64_t bytes = 0;
  for (const Tom& tom : scene.toms) bytes += size_bytes(tom);
  return bytes;
}

}  // namespace cuesta::test
