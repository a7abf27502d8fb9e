/// Soups of triangles between points of a small lattice, half of them a neighbour's: what comes out of
/// cleaning is a chunk that decodes to itself, and of a surface in one chunk it has all that clean_chunk.h
/// promises.

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "ooc/clean_chunk.h"
#include "tests/ooc/check_grid_mesh.h"

namespace {

using namespace cuesta;

/// Eight bytes a triangle: three corners, an attribute, and who owns it.
std::vector<std::byte> soup_records(std::span<const std::uint8_t> bytes, const SoupLayout& layout,
                                    bool neighbours) {
  std::vector<std::byte> records;
  for (std::size_t i = 0; i + 8 <= bytes.size(); i += 8) {
    SoupTriangle t;
    t.ordinal = i / 8;
    t.owner = neighbours ? bytes[i + 6] & 1 : 0;
    for (std::size_t k = 0; k < 3; ++k) {
      t.positions[k] = {bytes[i + k] & 7, bytes[i + k] >> 3 & 7, bytes[i + k] >> 6};
      t.colours[k] = {static_cast<std::uint8_t>(bytes[i + 3 + k] & 1), 0, 0, 255};
      t.normals[k] = {static_cast<std::int16_t>(bytes[i + 7] & 3), 0};
      t.texcoords[k] = {};
    }
    t.area_normal = {0, 0, 1};
    std::array<std::byte, max_soup_record_bytes> buffer;
    const auto record = encode(t, 0, layout, buffer);
    records.insert(records.end(), record.begin(), record.end());
  }
  return records;
}

Box3<float> box_below(float x) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Box3<float> box;
  box.lo = {-infinity, -infinity, -infinity};
  box.hi = {x, infinity, infinity};
  return box;
}

void check(const CleanedChunk& cleaned) {
  const CleanChunk& chunk = cleaned.chunk;
  const auto bytes = encode_chunk(chunk);
  const auto again = decode_chunk(bytes);
  if (!again || encode_chunk(*again) != bytes) std::abort();
  if (!std::is_sorted(chunk.foreign_slots.begin(), chunk.foreign_slots.end()) && !chunk.foreign_slots.empty())
    std::abort();
  for (const ChunkReplies& r : cleaned.replies)
    for (const CornerReply& c : r.corners)
      if (r.chunk == 0 || c.vertex >= chunk.vertices.size()) std::abort();
}

void check_whole(const CleanedChunk& cleaned) {
  const CleanChunk& chunk = cleaned.chunk;
  if (!chunk.foreign_slots.empty() || !cleaned.replies.empty() || chunk.shared != 0) std::abort();
  test::GridMesh mesh;
  mesh.positions = chunk.vertices.positions;
  mesh.colours = chunk.vertices.colours;
  for (std::uint32_t v = 0; v < chunk.wedge.size(); ++v) mesh.wedge_group.push_back(v - chunk.wedge[v]);
  mesh.triangles = chunk.triangles;
  if (!chunk.triangles.empty() && !test::find_violation(mesh).empty()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 9) return 0;
  const std::uint8_t how = data[0];
  const SoupLayout layout{{(how & 1) != 0, (how & 2) != 0, (how & 4) != 0}, (how & 8) != 0};
  const bool neighbours = (how & 16) != 0;
  const auto records = soup_records({data + 1, size - 1}, layout, neighbours);
  const TriangleSoup soup = decode_soup(records, 0, layout);
  const float border = neighbours ? 4 : std::numeric_limits<float>::infinity();
  const CleanedChunk cleaned = clean_chunk(soup, 0, box_below(border), layout.area_normals);
  check(cleaned);
  if (!neighbours) check_whole(cleaned);
  return 0;
}
