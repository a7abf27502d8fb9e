#pragma once
/// What a build starts from: a clean surface in chunks, each of which fits in memory.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ooc/grid.h"
#include "ooc/result.h"
#include "ooc/triangle_order.h"
#include "ooc/vertex_table.h"
#include "ooc/vertical.h"

namespace cuesta {

/// Number of a vertex of the whole surface: the chunk that its position lies in, and its number there. The
/// vertices of a wedge group have consecutive numbers.
using VertexId = std::uint64_t;

constexpr VertexId vertex_id(std::uint32_t chunk, std::uint32_t number) {
  return VertexId{chunk} << 32 | number;
}

/// A chunk with everything that its triangles use. Vertices that other chunks use too are locked.
struct SurfaceChunk {
  std::vector<VertexId> ids;         ///< ascending
  std::vector<std::uint32_t> wedge;  ///< place of each vertex in its wedge group
  VertexTable vertices;
  std::vector<std::uint8_t> locked;
  std::vector<Triangle> triangles;
  VertexId first_free = 0;  ///< ids of vertices that are not locked may become any from here on
};

/// Its invariants are those of CleanChunk. Const calls are concurrent, and their answers always the same.
class InputSurface {
 public:
  virtual ~InputSurface() = default;

  Grid grid;
  Box3<std::int32_t> box;  ///< of all vertices, grid units
  std::uint64_t vertices = 0, triangles = 0;
  AttributeSet attributes;
  std::optional<Vertical> vertical;  ///< grid units, of a field of heights: its errors are along it

  virtual std::uint32_t chunk_count() const = 0;
  virtual std::uint64_t triangles_of(std::uint32_t chunk) const = 0;
  /// @error io; corrupt when it is not what was read before
  virtual Result<SurfaceChunk> chunk(std::uint32_t c) const = 0;
  /// Asks for a chunk ahead.
  virtual void prefetch(std::uint32_t) const {}
  /// Gives back what is kept of a chunk that nobody needs any more.
  virtual void discard(std::uint32_t) const {}

  /// Of a field of heights: the largest vertical distance between each triangle and all postings above and
  /// below it, in grid units; 0 where there is none. In the calling TBB arena.
  /// @param corners    of each triangle in grid units, counter-clockwise seen from above
  /// @pre   vertical has a value, and `distances` is as long as `corners`
  virtual Result<void> measure(std::span<const std::array<Vec3i, 3>> corners,
                               std::span<float> distances) const;
  /// The postings above and below each triangle, grid units: what measure() looks at. Nothing for a triangle
  /// that may have more than `most`.
  /// @pre  vertical has a value
  virtual Result<std::vector<std::optional<std::vector<Vec3i>>>> postings_over(
      std::span<const std::array<Vec3i, 3>> corners, std::size_t most) const;
};

}  // namespace cuesta
