#pragma once
/// Roughness as a scanner sees it: octaves of smooth noise along the normals of a mesh.

#include <cstdint>
#include <vector>

#include "ooc/surface_mesh.h"

namespace cuesta::tools {

/// Gradient noise on the integer lattice, in about [-1, 1], zero at lattice points; continuous first
/// derivatives. Source: K. Perlin, "Improving Noise", SIGGRAPH 2002; the permutation table is a hash of
/// (cell, seed).
/// @pre |p| < 2^31.   @cost about 40 ns.
double gradient_noise(Vec3d p, std::uint64_t seed);

struct Octave {
  double wavelength = 0;  ///< units of the mesh
  double amplitude = 0;   ///< units; the largest displacement is about this
};

/// Octaves whose amplitudes add up to `total`: the finest has a wavelength of four mean edges and an
/// amplitude of about a quarter of one; each further octave doubles both.
std::vector<Octave> scan_octaves(double mean_edge, double total);

/// Area-weighted vertex normals of `mesh` (unit, zero where undefined), written to mesh.normals.
void set_normals(SurfaceMesh& mesh);

/// Mean length of the triangles' edges; 0 without triangles. @cost one pass.
double mean_edge_length(const SurfaceMesh& mesh);

/// Moves each vertex along mesh.normals by the sum of the octaves. Parallel, the same bits for any number of
/// threads.
/// @pre normals are set.
void roughen(SurfaceMesh& mesh, const std::vector<Octave>& octaves, std::uint64_t seed);

}  // namespace cuesta::tools
