#pragma once
/// Walks mapped text: blanks, words and numbers, never past the end. Numbers are correctly rounded.

#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

namespace cuesta {

struct TextCursor {
  const char* at = nullptr;
  const char* end = nullptr;

  bool done() const { return at == end; }

  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }
  static bool is_space(char c) { return is_blank(c) || c == '\n'; }

  void skip_blanks() {
    while (at != end && is_blank(*at)) ++at;
  }
  void skip_spaces() {
    while (at != end && is_space(*at)) ++at;
  }
  /// Moves past the next newline, or to the end.
  void skip_line() {
    const void* newline = at == end ? nullptr : std::memchr(at, '\n', static_cast<std::size_t>(end - at));
    at = newline ? static_cast<const char*>(newline) + 1 : end;
  }
  /// The characters up to the next white space; empty at the end.
  std::string_view word() {
    const char* first = at;
    while (at != end && !is_space(*at)) ++at;
    return {first, static_cast<std::size_t>(at - first)};
  }
  bool at_word_end() const { return at == end || is_space(*at); }

  std::optional<double> real();
  std::optional<std::int64_t> integer();

 private:
  std::optional<double> real_slowly(const char* first);
};

/// A real number that starts right here; the cursor moves past it.
/// The short cut is Clinger's: a mantissa under 2^53 times or over an exact power of ten rounds once.
inline std::optional<double> TextCursor::real() {
  static constexpr std::array<double, 23> powers{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                 1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const char* first = at;
  const char* p = at;
  const bool negative = p != end && *p == '-';
  if (p != end && (*p == '-' || *p == '+')) ++p;
  std::uint64_t mantissa = 0;
  const char* digits = p;
  while (p != end && *p >= '0' && *p <= '9') mantissa = mantissa * 10 + static_cast<unsigned>(*p++ - '0');
  auto digit_count = p - digits;
  int exponent = 0;
  if (p != end && *p == '.') {
    const char* fraction = ++p;
    while (p != end && *p >= '0' && *p <= '9') mantissa = mantissa * 10 + static_cast<unsigned>(*p++ - '0');
    digit_count += p - fraction;
    exponent = digit_count > 18 ? 0 : -static_cast<int>(p - fraction);
  }
  if (digit_count == 0 || digit_count > 18) return real_slowly(first);
  if (p != end && (*p == 'e' || *p == 'E')) {
    const char* q = p + 1;
    if (q != end && *q == '+') ++q;
    int written = 0;
    const auto [stop, error] = std::from_chars(q, end, written);
    if (error != std::errc{} || written > 400 || written < -400) return real_slowly(first);
    exponent += written;
    p = stop;
  }
  if (mantissa >= (std::uint64_t{1} << 53) || exponent < -22 || exponent > 22) return real_slowly(first);
  double value = static_cast<double>(mantissa);
  value = exponent < 0 ? value / powers[static_cast<std::size_t>(-exponent)]
                       : value * powers[static_cast<std::size_t>(exponent)];
  at = p;
  return negative ? -value : value;
}

/// Whatever from_chars takes ("inf" and "nan" too), with a plus sign; too large is infinite, too small is
/// zero.
inline std::optional<double> TextCursor::real_slowly(const char* first) {
  const char* p = first;
  if (p != end && *p == '+') ++p;
  double value = 0;
  const auto [stop, error] = std::from_chars(p, end, value);
  if (error == std::errc::invalid_argument) return std::nullopt;
  at = stop;
  if (error == std::errc::result_out_of_range) {
    const std::string_view text(p, static_cast<std::size_t>(stop - p));
    const bool tiny = text.find("e-") != text.npos || text.find("E-") != text.npos ||
                      text.starts_with("0.") || text.starts_with("-0.") || text.starts_with(".");
    value = tiny ? 0 : std::numeric_limits<double>::infinity();
    if (*p == '-') value = -value;
  }
  return value;
}

/// A whole number that starts right here, also one written as "3.0"; the cursor moves past it.
inline std::optional<std::int64_t> TextCursor::integer() {
  const char* first = at;
  const char* p = at;
  const bool negative = p != end && *p == '-';
  if (p != end && (*p == '-' || *p == '+')) ++p;
  std::int64_t value = 0;
  const char* digits = p;
  while (p != end && *p >= '0' && *p <= '9' && p - digits < 18) value = value * 10 + (*p++ - '0');
  const bool plain =
      p != digits && (p == end || !((*p >= '0' && *p <= '9') || *p == '.' || *p == 'e' || *p == 'E'));
  if (plain) {
    at = p;
    return negative ? -value : value;
  }
  const std::optional<double> written = real();
  if (written && *written >= -9e15 && *written <= 9e15 &&
      *written == static_cast<double>(static_cast<std::int64_t>(*written))) {
    return static_cast<std::int64_t>(*written);
  }
  at = first;
  return std::nullopt;
}

}  // namespace cuesta
