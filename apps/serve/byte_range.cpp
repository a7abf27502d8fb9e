#include "apps/serve/byte_range.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>

namespace cuesta::serve {
namespace {

constexpr std::string_view blanks = " \t";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(blanks);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Digits only. What does not fit 64 bits lies behind the end of every file, and is the largest number there
/// is.
std::optional<std::uint64_t> parse_position(std::string_view digits) {
  if (digits.empty() || digits.find_first_not_of("0123456789") != digits.npos) return std::nullopt;
  std::uint64_t value = 0;
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return read.ec == std::errc() ? value : std::numeric_limits<std::uint64_t>::max();
}

/// A range of no bytes is one that cannot be satisfied.   @return nothing if it is not well-formed.
std::optional<ByteRange> parse_range(std::string_view spec, std::uint64_t file_bytes) {
  const auto dash = spec.find('-');
  if (dash == spec.npos) return std::nullopt;
  const std::string_view before = spec.substr(0, dash), after = spec.substr(dash + 1);
  if (before.empty()) {
    const auto suffix = parse_position(after);
    if (!suffix) return std::nullopt;
    const std::uint64_t count = std::min(*suffix, file_bytes);
    return ByteRange{file_bytes - count, count};
  }
  const auto first = parse_position(before);
  const auto last = after.empty() ? std::numeric_limits<std::uint64_t>::max() : parse_position(after);
  if (!first || !last || *first > *last) return std::nullopt;
  if (*first >= file_bytes) return ByteRange{};
  return ByteRange{*first, std::min(*last, file_bytes - 1) - *first + 1};
}

bool is_bytes_unit(std::string_view header) {
  constexpr std::string_view unit = "bytes=";
  if (header.size() < unit.size()) return false;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const char c = header[i];
    if ((c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c) != unit[i]) return false;
  }
  return true;
}

}  // namespace

RangeAnswer parse_ranges(std::string_view header, std::uint64_t file_bytes, std::vector<ByteRange>& ranges) {
  ranges.clear();
  if (!is_bytes_unit(header)) return RangeAnswer::whole;
  std::string_view rest = header.substr(6);
  std::size_t specs = 0;
  std::uint64_t total = 0;
  bool too_much = false;
  while (!rest.empty()) {
    const auto comma = std::min(rest.find(','), rest.size());
    const std::string_view spec = trimmed(rest.substr(0, comma));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
    if (spec.empty()) continue;
    const auto range = parse_range(spec, file_bytes);
    if (!range) return ranges.clear(), RangeAnswer::whole;
    too_much = too_much || ++specs > most_ranges || range->count > file_bytes - total;
    if (too_much || range->count == 0) continue;
    total += range->count;
    ranges.push_back(*range);
  }
  if (specs == 0) return RangeAnswer::whole;
  if (too_much) ranges.clear();
  return ranges.empty() ? RangeAnswer::refused : RangeAnswer::partial;
}

}  // namespace cuesta::serve
