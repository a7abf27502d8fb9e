#pragma once
/// Scans of any size from small ones: a real scan, smoothly subdivided and roughened again, for tests and
/// benchmarks larger than any scan that could travel with them. Same input and options give the same bytes,
/// for any number of threads.

#include <cstdint>
#include <filesystem>

#include "ooc/result.h"
#include "ooc/surface_mesh.h"

namespace cuesta::tools {

struct ScanOptions {
  std::uint64_t triangles = 1'000'000;  ///< at least so many; each level has four times the one before
  std::uint64_t seed = 1;               ///< of the roughness
  double roughness = 0.003;  ///< sum of the octaves' amplitudes, share of the bounding diagonal; 0: smooth
};

/// Subdivides until there are enough triangles, then displaces along the normals (scan_octaves); normals are
/// set.
/// @pre   is_consistent(input).
/// @error invalid_input: no triangles, a soup without shared vertices, or not manifold (subdivide_loop);
/// out_of_budget: more than 2^31 triangles.
/// @cost  about 1 µs and 38 bytes per resulting triangle at the peak (71 M: 77 s with writing, 2.7 GB, two
/// cores).
Result<SurfaceMesh> make_scan(const SurfaceMesh& input, const ScanOptions& options);

enum class ScanOrder : std::uint8_t {
  first_use,  ///< triangles as they are, vertices as triangles first use them: what a good exporter does
  permuted,   ///< both in random order: the worst case of an out-of-core reader
};

/// Writes binary little-endian PLY (f32 x y z nx ny nz, uchar + 3 int32 per face) in blocks; vertices that no
/// triangle uses are left out. The file appears whole or not at all.
/// @error io, invalid_input without normals.   @cost 12 bytes per triangle for the orders, on top of the
/// mesh.
Result<void> write_scan(const std::filesystem::path& path, const SurfaceMesh& mesh, ScanOrder order,
                        std::uint64_t seed = 1);

}  // namespace cuesta::tools
