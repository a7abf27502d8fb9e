#pragma once
/// The header of a PLY file: elements, their properties, and where the data begins.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ooc/read_job.h"

namespace cuesta {

enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

constexpr std::uint32_t ply_bytes(PlyType type) {
  switch (type) {
    case PlyType::i8:
    case PlyType::u8:
      return 1;
    case PlyType::i16:
    case PlyType::u16:
      return 2;
    case PlyType::i32:
    case PlyType::u32:
    case PlyType::f32:
      return 4;
    case PlyType::f64:
      return 8;
  }
  return 8;
}
constexpr bool is_real(PlyType type) {
  return type == PlyType::f32 || type == PlyType::f64;
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;  ///< of the value, or of a list's items
  std::optional<PlyType> list_count;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Bytes of a binary row; nothing when a list makes rows differ.
  std::optional<std::uint64_t> row_bytes() const;
  /// The fewest bytes that a row can take.
  std::uint64_t least_row_bytes(bool ascii) const;
  /// Index of a property, or -1.
  int find(std::string_view property) const;
};

enum class PlyEncoding : std::uint8_t { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::uint64_t data_byte = 0;  ///< where the first element begins
};

/// @error corrupt with the line; unsupported_version for another version than 1.0.
Result<PlyHeader> parse_ply_header(const ReadJob& job);

}  // namespace cuesta
