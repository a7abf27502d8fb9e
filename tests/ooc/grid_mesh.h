#pragma once
/// A clean surface in one piece, for tests: all chunks of an ingested surface put together.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "ooc/clean_report.h"
#include "ooc/grid.h"
#include "ooc/ingest.h"
#include "ooc/result.h"
#include "ooc/surface_mesh.h"

namespace cuesta::test {

/// What clean_chunk.h promises of the whole, in 32-bit numbers. Vertices are in order of (chunk, number),
/// triangles by their lowest vertex.
struct GridMesh {
  Grid grid;
  std::vector<Vec3i> positions;
  std::vector<Vec3f> normals;  ///< empty or one per vertex, as the other attributes
  std::vector<Rgba8> colours;
  std::vector<TexCoord> texcoords;
  std::vector<std::uint32_t> wedge_group;  ///< index of the first vertex of its group
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct CleanOptions {
  double step = 0;
  bool make_normals = true;
  std::uint32_t chunk_triangles = 1u << 18;
  std::uint64_t block_vertices = 0;
  double weld_tolerance = 0;
};

/// Gives a mesh in memory to the sink, in blocks as readers do.
Result<std::vector<ReadReport>> feed(const SurfaceMesh& mesh, RawSurface& sink);

/// Ingests `mesh` in a folder of its own, and puts the chunks together.
Result<GridMesh> clean_mesh(const SurfaceMesh& mesh, const CleanOptions& options, CleanReport& report);

GridMesh put_together(const InputSurface& surface);

}  // namespace cuesta::test
