#pragma once
/// What a .cuesta file's directory says, in numbers for people and programs.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "hierarchy/directory.h"

namespace cuesta::app {

/// In world units.
Box3d world_box(const Directory& directory);

/// Largest distance between a vertex of the input and its place on the file's grid, in world units.
double snapping_error(const Directory& directory);

/// World units: no substitution has a smaller error, but for zero.
double least_error(const Directory& directory);

/// What a round of the build came to. Errors in world units.
struct RoundFacts {
  std::uint32_t pages = 0;
  std::uint64_t triangles = 0, owned_triangles = 0, bytes = 0;
  double least_error = 0, largest_error = 0;
};
std::vector<RoundFacts> rounds_of(const Directory& directory);

/// The metadata as JSON; as a string where a hand-made file holds something else.
nlohmann::ordered_json metadata_of(const Directory& directory);
nlohmann::ordered_json metadata_of(const std::string& text);

/// Counts, bounds, grid, errors, attributes and rounds, with the keys of cuesta info --json. World units.
nlohmann::ordered_json directory_json(const Directory& directory);

/// A vector as an array.
nlohmann::ordered_json vector_json(Vec3d v);

/// As text; what is not UTF-8 is replaced.   @param indent  -1: one line.
std::string json_text(const nlohmann::ordered_json& json, int indent);

}  // namespace cuesta::app
