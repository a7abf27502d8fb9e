#pragma once
/// TOM, the totally ordered mesh: one triangle mesh at every resolution, in the arrays of the finest one.
/// Source: Bouvier, Gobbetti, "TOM: Totally Ordered Mesh", §3. Deviations: degenerate triangles at attribute
/// discontinuities are not stored, because vertices at one position are neighbours in the order and go in one
/// step (whole_resolution()); errors are measured and kept with it.
///
/// Frame and units: world = origin + position, in the input's units; counter-clockwise is outside.
/// Threads: const calls are concurrent. Memory: 16 bytes per vertex, 12 more with normals, 4 with colours, 8
/// with texture coordinates; 12 per triangle; 8 per step of the error, which are at most 200. A mesh with
/// normals as vertices and faces alone takes 4 bytes per vertex less: 100 : 108.3.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ooc/surface_mesh.h"
#include "ooc/triangle_order.h"

namespace cuesta {

/// Number of active vertices; they are the first ones of the arrays.
using Resolution = std::uint32_t;

/// Below this resolution, down to that of the next step, the cut deviates by at most `error`.
struct TomErrorStep {
  Resolution below = 0;
  float error = 0;

  friend bool operator==(const TomErrorStep&, const TomErrorStep&) = default;
};

/// Arrays in the order of resolution: at resolution n the vertices 0 … n - 1 are active, every other one
/// stands for its substitute, and the first triangle_count(n) triangles are those that have three different
/// corners.
struct Tom {
  Vec3d origin;     ///< world units
  double step = 1;  ///< world units > 0: positions are integer multiples of it, below 2^23
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< attributes as in SurfaceMesh: empty, or one per vertex
  std::vector<Rgba8> colours;
  std::vector<TexCoord> texcoords;
  std::vector<std::uint32_t> substitute;  ///< [v] < v; below base_vertices it is v itself
  std::vector<Triangle> triangles;        ///< original corners, by rising resolution
  std::vector<TomErrorStep> errors;       ///< by falling resolution, rising error
  float snap_error = 0;          ///< what moving the input's vertices to multiples of `step` moved at most
  Resolution base_vertices = 0;  ///< the lowest resolution; 0 only if there are no vertices
  Box3<float> bounds;            ///< of all positions; empty without vertices

  Resolution full() const { return static_cast<Resolution>(positions.size()); }
};

/// The triangle's corners at resolution n: each corner's first active ancestor.
/// @pre base_vertices ≤ n ≤ full()
inline Triangle active_corners(const Tom& tom, Triangle t, Resolution n) {
  for (std::uint32_t& c : t)
    while (c >= n) c = tom.substitute[c];
  return t;
}

/// The lowest resolution at which three corners are different: base_vertices for a triangle of the base mesh.
/// @cost O(length of the substitution chains), some twenty steps.
Resolution triangle_resolution(std::span<const std::uint32_t> substitute, Resolution base_vertices,
                               Triangle t);

/// How many triangles there are at resolution n. @cost a binary search over triangle_resolution().
std::uint32_t triangle_count(const Tom& tom, Resolution n);

/// The highest resolution ≤ n, but at least base_vertices, that separates no vertices of one position: where
/// attributes are discontinuous, no other has closed seams. Draw at these.
Resolution whole_resolution(const Tom& tom, Resolution n);

/// The highest whole resolution with at most so many triangles; the lowest if even that has more.
Resolution resolution_of_triangles(const Tom& tom, std::uint32_t triangles);

/// The lowest whole resolution whose error_at() is at most `error`; full() if none is.
Resolution resolution_of_error(const Tom& tom, float error);

/// Bound of the distance from each vertex of the input, as snapped to the step, to the surface at resolution
/// n; add snap_error for the input as it was. Measured while it was simplified: falls as n rises.
float error_at(const Tom& tom, Resolution n);

/// Writes the triangles of resolution n: indices below n, ready to be drawn with the vertex arrays as they
/// are.
/// @pre base_vertices ≤ n ≤ full(); out.size() ≥ triangle_count(n)
/// @return how many were written.
/// @cost some ns per triangle. TomCursor is faster, with memory.
std::uint32_t extract_triangles(const Tom& tom, Resolution n, std::span<Triangle> out);

/// A vertex between itself and what is to replace it. Source: TOM §3.4.
struct TomVertex {
  Vec3f position;
  Vec3f normal;    ///< zero without normals
  Rgba8 colour{};  ///< zero without colours
  TexCoord texcoord{};
};
/// @param amount  0: vertex v itself; 1: its substitute, so that drawing at resolution v instead changes
/// nothing. The vertices that go in the next step from resolution n are whole_resolution(n - 1) … n - 1.
TomVertex geomorph(const Tom& tom, std::uint32_t v, float amount);

/// What the arrays take in memory.
std::uint64_t size_bytes(const Tom& tom);

/// The mesh of resolution n, on its own; positions in world units.
SurfaceMesh surface_at(const Tom& tom, Resolution n);

/// Whether all that is said above of the arrays is so: sizes, order of substitutes, of triangles and of
/// errors.
bool is_consistent(const Tom& tom);

}  // namespace cuesta
