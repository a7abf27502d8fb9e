#pragma once
/// Triangles that carry their corners with them, on the grid: what a join of triangles with vertices gives,
/// and what chunks are made of before they are clean.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ooc/vertex_table.h"

namespace cuesta {

/// One triangle of a soup.
struct SoupTriangle {
  std::uint64_t ordinal = 0;  ///< place among all triangles of the input
  std::uint32_t owner = 0;    ///< chunk that it belongs to; others have it as a neighbour
  std::array<Vec3i, 3> positions;
  std::array<OctNormal, 3> normals;  ///< this and the following: as the layout says
  std::array<Rgba8, 3> colours;
  std::array<FixedTexCoord, 3> texcoords;
  Vec3f area_normal;  ///< from positions before snapping; its length is twice the area, in square grid steps
};

/// Which parts a record has.
struct SoupLayout {
  AttributeSet attributes;
  bool area_normals = false;

  /// Of a triangle whose corners are less than 2^15 grid steps apart and that lies in its owner's bucket:
  /// nearly all. 30 to 84 bytes.
  std::uint32_t typical_record_bytes() const {
    return 30 + 3 * (4 * attributes.normals + 4 * attributes.colours + 8 * attributes.texcoords) +
           6 * area_normals;
  }
};
inline constexpr std::size_t max_soup_record_bytes = 6 + 4 + 36 + 3 * 16 + 6;

/// Records are what an out-of-core build writes and reads most of, so they are short: second and third corner
/// relative to the first, area normals in 6 bytes (a direction to 0.005°, a length to 0.4 %).
/// @param bucket  where it goes: the owner is stored where it is another
/// @return what was written of `out`
std::span<const std::byte> encode(const SoupTriangle& triangle, std::uint32_t bucket,
                                  const SoupLayout& layout, std::span<std::byte, max_soup_record_bytes> out);

/// Many of them; corner k of triangle i is vertex 3 i + k.
struct TriangleSoup {
  std::vector<std::uint64_t> ordinals;  ///< ascending
  std::vector<std::uint32_t> owners;
  VertexTable corners;
  std::vector<Vec3f> area_normals;

  std::size_t size() const { return ordinals.size(); }
};

/// Records of a bucket in any order → a soup in input order. Bytes after the last whole record are left out.
TriangleSoup decode_soup(std::span<const std::byte> records, std::uint32_t bucket, const SoupLayout& layout);

/// Triangle i of a soup by itself. Area normals are as exact as records keep them.
SoupTriangle triangle_of(const TriangleSoup& soup, std::size_t i);

/// Takes records of some triangles out of a bucket. @param ordinals  ascending
void remove_triangles(std::vector<std::byte>& records, std::span<const std::uint64_t> ordinals,
                      const SoupLayout& layout);

}  // namespace cuesta
