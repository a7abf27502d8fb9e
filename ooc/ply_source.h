#pragma once
/// The two ways of a PLY body, text and bytes, behind the same three functions, so that rows are read by one
/// template.

#include <bit>
#include <cstdint>
#include <cstring>

#include "ooc/ply_header.h"
#include "ooc/text_cursor.h"

namespace cuesta {

template <class T, bool swapped>
T load_ply(const char* at) {
  std::array<char, sizeof(T)> bytes;
  if constexpr (swapped) {
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes[i] = at[sizeof(T) - 1 - i];
  } else {
    std::memcpy(bytes.data(), at, sizeof(T));
  }
  return std::bit_cast<T>(bytes);
}

/// Calls `f` with a zero of the C++ type.
template <class F>
auto with_ply_type(PlyType type, F&& f) {
  switch (type) {
    case PlyType::i8:
      return f(std::int8_t{});
    case PlyType::u8:
      return f(std::uint8_t{});
    case PlyType::i16:
      return f(std::int16_t{});
    case PlyType::u16:
      return f(std::uint16_t{});
    case PlyType::i32:
      return f(std::int32_t{});
    case PlyType::u32:
      return f(std::uint32_t{});
    case PlyType::f32:
      return f(float{});
    case PlyType::f64:
      break;
  }
  return f(double{});
}

/// A value that is no number or out of range becomes -1: an index that no file has.
inline std::int64_t index_from_real(double value) {
  return value >= 0 && value < 9e15 ? static_cast<std::int64_t>(value) : -1;
}

template <bool swapped>
struct PlyBytes {
  static constexpr bool ascii = false;
  const char* at;
  const char* end;

  std::uint64_t left() const { return static_cast<std::uint64_t>(end - at); }
  bool real(PlyType type, double& value) {
    if (left() < ply_bytes(type)) return false;
    value = with_ply_type(
        type, [this](auto zero) { return static_cast<double>(load_ply<decltype(zero), swapped>(at)); });
    at += ply_bytes(type);
    return true;
  }
  bool whole(PlyType type, std::int64_t& value) {
    if (left() < ply_bytes(type)) return false;
    value = with_ply_type(type, [this](auto zero) {
      using T = decltype(zero);
      const T loaded = load_ply<T, swapped>(at);
      if constexpr (std::is_floating_point_v<T>)
        return index_from_real(static_cast<double>(loaded));
      else
        return static_cast<std::int64_t>(loaded);
    });
    at += ply_bytes(type);
    return true;
  }
  bool skip(PlyType type, std::uint64_t count) {
    if (count > left() / ply_bytes(type)) return false;
    at += count * ply_bytes(type);
    return true;
  }
  /// False if `count` more values cannot be there.
  bool has(PlyType type, std::uint64_t count) const { return count <= left() / ply_bytes(type); }
};

struct PlyText {
  static constexpr bool ascii = true;
  const char* at;
  const char* end;

  std::uint64_t left() const { return static_cast<std::uint64_t>(end - at); }
  bool real(PlyType, double& value) {
    TextCursor text{at, end};
    text.skip_spaces();
    const std::optional<double> number = text.real();
    at = text.at;
    if (!number || !text.at_word_end()) return false;
    value = *number;
    return true;
  }
  bool whole(PlyType, std::int64_t& value) {
    TextCursor text{at, end};
    text.skip_spaces();
    const std::optional<std::int64_t> number = text.integer();
    at = text.at;
    if (!number || !text.at_word_end()) return false;
    value = *number;
    return true;
  }
  bool skip(PlyType, std::uint64_t count) {
    TextCursor text{at, end};
    for (; count > 0; --count) {
      text.skip_spaces();
      if (text.word().empty()) return false;
    }
    at = text.at;
    return true;
  }
  bool has(PlyType, std::uint64_t count) const { return count <= left() / 2 + 1; }
};

}  // namespace cuesta
