#pragma once
/// Pairs of numbers as people write them: "46.5 7.25", "46.5, 7.25", one pair a line in a file.

#include <istream>
#include <span>
#include <string>
#include <vector>

#include "ooc/result.h"
#include "terrain/crs_definition.h"

namespace cuesta::sample {

/// Numbers in the order written: latitude and longitude, or x and y.
struct NumberPair {
  double first = 0, second = 0;
};

/// Numbers separated by spaces or commas, over any number of words.
/// @error invalid_input: a word that is no finite number, or an odd count.
Result<std::vector<NumberPair>> pairs_of_words(std::span<const std::string> words);

/// A pair a line; what follows them on the line, and lines that are empty or begin with '#', are passed over.
/// @param name  of the stream, for messages.
/// @error invalid_input with the line; io.
Result<std::vector<NumberPair>> pairs_of_lines(std::istream& in, const std::string& name);

/// @error invalid_input: a latitude beyond a pole, or a longitude beyond ±360 degrees.
Result<LatLon> place_of(NumberPair pair);

}  // namespace cuesta::sample
