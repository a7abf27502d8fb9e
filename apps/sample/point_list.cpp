#include "apps/sample/point_list.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace cuesta::sample {
namespace {

constexpr std::string_view separators = " \t,;\r";

/// The next word of `text`, which is shortened by it; empty at the end.
std::string_view next_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(separators), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(separators));
  text.remove_prefix(word.size());
  return word;
}

std::optional<double> number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) return {};
  return value;
}

tl::unexpected<Error> no_number(std::string file, std::string place, std::string_view word) {
  return fail(ErrorCode::invalid_input, std::move(file), std::move(place),
              fmt::format("expected two numbers, found \"{}\"", word));
}

}  // namespace

Result<std::vector<NumberPair>> pairs_of_words(std::span<const std::string> words) {
  std::vector<double> numbers;
  for (const std::string& text : words) {
    std::string_view rest = text;
    for (auto word = next_word(rest); !word.empty(); word = next_word(rest)) {
      const auto value = number(word);
      if (!value) return no_number("", "points", word);
      numbers.push_back(*value);
    }
  }
  if (numbers.size() % 2 != 0)
    return fail(ErrorCode::invalid_input, "", "points",
                fmt::format("expected pairs of numbers, found {} numbers", numbers.size()));
  std::vector<NumberPair> pairs;
  for (std::size_t i = 0; i < numbers.size(); i += 2) pairs.push_back({numbers[i], numbers[i + 1]});
  return pairs;
}

Result<std::vector<NumberPair>> pairs_of_lines(std::istream& in, const std::string& name) {
  std::vector<NumberPair> pairs;
  std::string line;
  for (std::size_t n = 1; std::getline(in, line); ++n) {
    std::string_view rest = line;
    const std::string_view first = next_word(rest);
    if (first.empty() || first.starts_with('#')) continue;
    const std::string_view second = next_word(rest);
    const auto a = number(first), b = number(second);
    if (!a || !b) return no_number(name, fmt::format("line {}", n), a ? second : first);
    pairs.push_back({*a, *b});
  }
  if (in.bad()) return fail(ErrorCode::io, name, "", "cannot be read");
  return pairs;
}

Result<LatLon> place_of(NumberPair pair) {
  if (std::abs(pair.first) <= 90 && std::abs(pair.second) <= 360) return LatLon{pair.first, pair.second};
  return fail(ErrorCode::invalid_input, "", fmt::format("{}, {}", pair.first, pair.second),
              "expected a latitude within ±90 degrees and a longitude within ±360; latitude comes first");
}

}  // namespace cuesta::sample
