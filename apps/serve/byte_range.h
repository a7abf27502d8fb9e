#pragma once
/// The Range header.   Source: RFC 9110 §14.

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace cuesta::serve {

/// Bytes [first, first + count) of a file.
struct ByteRange {
  std::uint64_t first = 0;
  std::uint64_t count = 0;

  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

enum class RangeAnswer : std::uint8_t {
  whole,    ///< no range, another unit than bytes, or not well-formed: such a header counts as absent
  partial,  ///< at least one range has bytes
  refused,  ///< 416: none has any; more than most_ranges; or together more bytes than the file has
};

/// More in one request than any reader of pages asks for.
inline constexpr std::size_t most_ranges = 64;

/// @param header  value of Range; empty: none.   @param file_bytes  of what is asked for.
/// @param ranges  is set to what to send, in the order asked for, without those that lie behind the end. Each
/// is within
///                the file and has bytes; together they are at most `file_bytes`.
/// @cost O(header), and no allocation once `ranges` has had room for as many.
RangeAnswer parse_ranges(std::string_view header, std::uint64_t file_bytes, std::vector<ByteRange>& ranges);

}  // namespace cuesta::serve
