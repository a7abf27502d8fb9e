#pragma once
/// One square of a terrain as a chunk of surface.

#include <cstdint>
#include <span>
#include <vector>

#include "terrain/lattice_patch.h"
#include "terrain/terrain_surface.h"

namespace cuesta {

/// Heights of a square and of a rim of postings around it: 1 to the north and west, 2 to the south and east.
struct PostingWindow {
  LatticeSquare square;
  std::uint64_t width = 0, height = 0;  ///< with the rim
  std::vector<float> heights_m;
  std::vector<std::uint8_t> has_height;
  std::vector<Vec3d> positions_m;

  std::size_t index(std::int64_t x, std::int64_t y) const {
    return static_cast<std::size_t>(y + 1) * width + static_cast<std::size_t>(x + 1);
  }
};

class TerrainChunk {
 public:
  TerrainChunk(const TerrainSurface& surface, std::uint32_t chunk);

  Result<SurfaceChunk> make();

  /// What a survey wants to know.
  struct Facts {
    std::uint64_t triangles = 0, vertices = 0;
    Box3d box_m;
  };
  Result<Facts> facts();

 private:
  using Key = std::uint32_t;  // of a corner: its posting and fan
  struct Vertex {
    VertexId id = 0;
    LatticePatch::Corner at;  // or:
    const PostingRef* elsewhere = nullptr;
  };

  Result<void> read();
  Key key_of(const LatticePatch::Corner& corner) const;
  PostingRef place(const LatticePatch::Corner& corner) const;
  LatticePatch patch() const;
  /// The triangles of the square's own cells.
  void collect(const LatticePatch& patch);
  /// All vertices of the triangles and seams, by id.
  std::vector<Vertex> vertices() const;
  Result<void> add(const Vertex& vertex, SurfaceChunk& out) const;
  bool is_locked(const Vertex& vertex) const;
  Result<void> add_colours(std::span<const Vertex> all, SurfaceChunk& out) const;

  const TerrainSurface& surface_;
  std::uint32_t chunk_;
  PostingWindow window_;
  std::vector<std::array<LatticePatch::Corner, 3>> triangles_;
  std::span<const SeamTriangle> seams_;
};

/// Reads a window of a store and places it. @param square  may be any rectangle of a layer
Result<PostingWindow> read_postings(const PostingStore& store, const PostingPositions& positions,
                                    const LatticeSquare& square);

}  // namespace cuesta
