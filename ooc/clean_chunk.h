#pragma once
/// One chunk of the input made clean: welded, without impossible faces, an oriented manifold with borders.
/// A chunk is clean on its own: its soup has its own triangles (their centres lie in its box) and all others
/// that have a corner in its box, so what it decides about the points in its box holds everywhere; what it
/// must know of points outside, their chunks tell it in replies.

#include <array>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "ooc/clean_report.h"
#include "ooc/result.h"
#include "ooc/space_tree.h"
#include "ooc/triangle_order.h"
#include "ooc/triangle_soup.h"
#include "ooc/vertex_table.h"

namespace cuesta {

/// A triangle's corner at a point of another chunk: which vertex it is there. 24 bytes.
struct CornerReply {
  std::uint64_t slot = 0;    ///< 4 · ordinal of the triangle + corner
  std::uint32_t vertex = 0;  ///< number in the chunk that replies
  std::uint32_t wedge = 0;   ///< place in its wedge group
  OctNormal normal{};        ///< as that chunk has it; of no meaning without normals
  std::uint32_t zero = 0;    ///< in place of padding, as it is written byte by byte
};
static_assert(std::has_unique_object_representations_v<CornerReply>);

/// Replies of a chunk to another, ascending by slot.
struct ChunkReplies {
  std::uint32_t chunk = 0;  ///< of clean_chunk(): who they are for; of InputSurface: who they are from
  std::vector<CornerReply> corners;
};

/// Invariants of the surface as a whole: every vertex is used by a triangle; the vertices of one wedge group
/// (one position, different attributes) are consecutive; taken group by group it is an oriented manifold with
/// borders: each edge has one or two triangles that run along it in opposite directions, the triangles around
/// a group form one fan or half-fan, no triangle uses a group twice, no two triangles use the same three
/// groups.
struct CleanChunk {
  /// At points of the chunk's box: the shared ones along a space-filling curve, then the others along it.
  VertexTable vertices;
  std::vector<std::uint32_t> wedge;  ///< per vertex: its place in its group, 0 for the first
  std::uint32_t shared = 0;          ///< so many vertices, the first ones, are used by other chunks too
  /// Corners count the vertices, then `foreign`. Sorted by lowest corner.
  std::vector<Triangle> triangles;
  VertexTable foreign;                       ///< one per corner at a point outside the box, not welded
  std::vector<std::uint64_t> foreign_slots;  ///< 4 · ordinal + corner of each, ascending
};

struct CleanedChunk {
  CleanChunk chunk;
  std::vector<ChunkReplies> replies;  ///< ascending by chunk
  CleanReport report;                 ///< what was found at this chunk's points and triangles
  std::uint64_t vertices_used = 0;    ///< welded vertices that a face used before any was dropped
};

/// Cleans chunk `self`. Pure.
/// @param soup  its triangles and the others' that have a corner in its box
/// @param make_normals  fill normals that are missing from the area normals of the soup
/// @cost O(n log n) time, about 250 bytes per triangle.
CleanedChunk clean_chunk(const TriangleSoup& soup, std::uint32_t self, const Box3<float>& box,
                         bool make_normals);

/// The chunk as bytes and back; replies apart. @error corrupt
std::vector<std::byte> encode_chunk(const CleanChunk& chunk);
Result<CleanChunk> decode_chunk(std::span<const std::byte> bytes);

}  // namespace cuesta
