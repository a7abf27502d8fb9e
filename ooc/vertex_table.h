#pragma once
/// Vertices as a file stores them: quantised positions and attributes, one array each.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ooc/surface_mesh.h"
#include "ooc/vec.h"

namespace cuesta {

inline constexpr int normal_bits = 10;

using OctNormal = std::array<std::int16_t, 2>;      ///< octahedral, normal_bits bits (oct_normal.h)
using FixedTexCoord = std::array<std::int32_t, 2>;  ///< units of 2^-16

/// Attributes are empty, or have one element per position. 12 bytes and up to 16 more per vertex.
struct VertexTable {
  std::vector<Vec3i> positions;  ///< grid units
  std::vector<OctNormal> normals;
  std::vector<Rgba8> colours;
  std::vector<FixedTexCoord> texcoords;

  std::size_t size() const { return positions.size(); }
  AttributeSet attributes() const { return {!normals.empty(), !colours.empty(), !texcoords.empty()}; }

  /// Appends vertex i of `other`, whose attributes are the same. Copies into empty tables define them.
  void append(const VertexTable& other, std::size_t i) {
    positions.push_back(other.positions[i]);
    if (!other.normals.empty()) normals.push_back(other.normals[i]);
    if (!other.colours.empty()) colours.push_back(other.colours[i]);
    if (!other.texcoords.empty()) texcoords.push_back(other.texcoords[i]);
  }
  void reserve(std::size_t count, AttributeSet with) {
    positions.reserve(count);
    if (with.normals) normals.reserve(count);
    if (with.colours) colours.reserve(count);
    if (with.texcoords) texcoords.reserve(count);
  }
};

/// The vertices `order[0]`, `order[1]`, … of `table`.
template <class Index>
VertexTable gather(const VertexTable& table, const std::vector<Index>& order) {
  VertexTable out;
  out.reserve(order.size(), table.attributes());
  for (const Index i : order) out.append(table, i);
  return out;
}

}  // namespace cuesta
