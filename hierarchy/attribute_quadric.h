#pragma once
/// Quadrics of attributes: how far normals, colours and texture coordinates of a surface are from those that
/// it would have after a substitution. Source: Hoppe, "New quadric metric for simplifying meshes with
/// appearance attributes", IEEE Visualization 1999, §3; kept about the vertex's own position, as quadric.h
/// is.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/cell_mesh.h"
#include "hierarchy/quadric_cost.h"
#include "hierarchy/substitution_kernel.h"
#include "ooc/surface_mesh.h"

namespace cuesta {

/// Distance from planes and, weighed against it, of attributes (quadric.h and here). A fairness predicate of
/// greedy_substitution.h. 130 bytes per vertex and 32 more for each number of its attributes.
class AttributeQuadricFairness {
 public:
  static constexpr std::size_t most_numbers = 8;  ///< normal 3, colour 3, texture coordinates 2

  /// @param source  per vertex of the kernel's cell, the vertex of `mesh` that it is
  /// @param scale   grid steps that a difference of 1 counts as much as: of normals, of colours of 0 … 1, of
  ///                texture coordinates
  AttributeQuadricFairness(const SubstitutionKernel& kernel, const SurfaceMesh& mesh,
                           std::span<const std::uint32_t> source, float scale);

  void costs(PointId u, std::span<const PointId> targets, std::span<float> out) const;
  void applied(PointId u, PointId v, std::span<const Child> children);

 private:
  using Numbers = std::array<double, most_numbers>;
  /// Over the triangles i that the vertex stands for, with weight w, gradient g of each number k and its
  /// value s at the vertex's position: what a sum of w (g·d + s - s')² over all k needs.
  struct Sums {
    double weight = 0, ss = 0;   ///< Σw; ΣΣ w s²
    std::array<double, 6> gg{};  ///< ΣΣ w g gᵀ: xx, xy, xz, yy, yz, zz
    Vec3d gs;                    ///< ΣΣ w g s
    std::array<Vec3d, most_numbers> g{};
    Numbers s{};

    double at(Vec3d d, const Numbers& values) const;
    void add(const Sums& other, Vec3d d);
  };

  void add_triangle(TriangleId t);
  Numbers numbers_of(const SurfaceMesh& mesh, std::uint32_t v, double scale) const;

  const SubstitutionKernel& kernel_;
  QuadricCost planes_;
  std::vector<Numbers> values_;  // per vertex
  std::vector<Sums> sums_;       // per vertex
};

}  // namespace cuesta
