#pragma once
/// A piece of a surface in memory, as tiles are made of it.

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/draw_list.h"
#include "runtime/surface_part.h"

namespace cuesta::tiles {

/// Positions are those of the file's grid, bit for bit; all vertices are used.
struct TileMesh {
  std::vector<DrawVertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Takes away what lies more than `margin` grid units outside of the border: triangles over it are cut, with
/// new vertices on the file's grid. A triangle's cut does not depend on its neighbours or on the order of
/// corners, so two meshes that share a triangle cut it alike. A cone is followed to within bow().
/// @post no triangle has two corners at one place.   @cost O(triangles)
void clip(TileMesh& mesh, const PartBorder& border, double margin);

/// The largest distance between a border and a straight line between two of its points that are in one
/// triangle of the mesh; 0 for planes. Grid units.
double bow(const TileMesh& mesh, const PartBorder& border);

/// Puts vertices and triangles into an order that does not tell how the mesh came about: vertices that are
/// alike become one, those that no triangle uses go, and each triangle begins with its first vertex.   @cost
/// O(n log n)
void sort(TileMesh& mesh);

/// Normals as means of the triangles' around each vertex, by area, shared by vertices at one place. Sums are
/// taken in the order of the triangles.
void add_normals(TileMesh& mesh);

/// Of all edges, grid units.
double longest_edge(const TileMesh& mesh);

}  // namespace cuesta::tiles
