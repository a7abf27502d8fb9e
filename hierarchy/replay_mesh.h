#pragma once
/// A page's mesh while its script is replayed: corners by vertex and by point, stars, and substitution.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/cell_mesh.h"
#include "hierarchy/page.h"

namespace cuesta {

/// A point is a wedge group, named by its first vertex. Per local vertex, its point.
std::vector<std::uint32_t> points_of(const Page& page);

class ReplayMesh {
 public:
  ReplayMesh(const Page& page, std::span<const Vec3i> positions);

  std::uint32_t point(std::uint32_t vertex) const { return point_[vertex]; }
  const std::array<std::uint32_t, 3>& corners(std::uint32_t triangle) const { return corners_[triangle]; }
  bool alive(std::uint32_t triangle) const { return alive_[triangle] != 0; }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(corners_.size()); }
  bool has_point(std::uint32_t triangle, std::uint32_t p) const;
  /// Live triangles around a point, ascending.
  std::span<const std::uint32_t> star(std::uint32_t p);
  /// Distinct other points of the triangles around p, ascending.
  std::vector<std::uint32_t> ring(std::uint32_t p);
  std::uint32_t edge_triangles(std::uint32_t p, std::uint32_t q);
  /// Twice the area times the unit normal, grid units squared, exact differences.
  Vec3d normal(const std::array<std::uint32_t, 3>& corners) const;
  Vec3d position(std::uint32_t vertex) const { return vec_cast<double>(positions_[vertex]); }

  /// Corners of triangle t after `run` (wedges of one point) has been substituted.
  std::array<std::uint32_t, 3> substituted(std::uint32_t t, std::span<const Child> run) const;
  /// Substitutes; triangles with both points die. @return the number that died.
  std::uint32_t substitute(std::span<const Child> run);
  void remove(std::uint32_t triangle);

 private:
  std::span<const Vec3i> positions_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
  std::vector<std::uint32_t> point_;
  std::vector<std::uint8_t> alive_;
  std::vector<std::vector<std::uint32_t>> stars_;  // by point; dead triangles are dropped when looked at
};

}  // namespace cuesta
