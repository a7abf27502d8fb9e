#pragma once
/// What a build tells: the JSON kept in the file, and the summary on the screen.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/cuesta/build_command.h"
#include "hierarchy/build_hierarchy.h"
#include "hierarchy/build_scene.h"
#include "ooc/clean_report.h"
#include "ooc/ingest.h"
#include "ooc/mesh_reader.h"

namespace cuesta::app {

struct InputFacts {
  std::string name;         ///< without its directory
  std::uint64_t bytes = 0;  ///< of the file
  ReadReport read;
};

struct BuildFacts {
  std::vector<InputFacts> inputs;
  std::string fingerprint;
  MissingAttributes missing;
  CleanReport clean;
  BuildReport built;
  std::optional<TerrainFacts> terrain;
  std::optional<SceneBuildReport> scene;
  std::vector<std::string> warnings;
  std::uint64_t cells_made = 0, cells_known = 0;  ///< of an incremental build
  std::uint64_t triangles = 0, vertices = 0;      ///< of the clean surface
  AttributeSet attributes;
  double seconds = 0;
};

/// Names and counts: stable ones of the metadata, or words of the screen.
using Counts = std::vector<std::pair<const char*, std::uint64_t>>;
Counts read_counts(const ReadReport& report);
Counts clean_counts(const CleanReport& report);
nlohmann::ordered_json counts_json(const Counts& counts);

/// The options that decide the bytes of the file, as a JSON object: all that the metadata and the fingerprint
/// know of them.
std::string options_json(const BuildSettings& settings);

/// JSON object for the file: the same for any threads and memory (I6), so no times and no paths in it.
/// No fingerprint if an input names other files, as their bytes are not in it: such a build is always done.
std::string build_metadata(const BuildFacts& facts, const BuildSettings& settings);

/// Lines for the screen; counts that are zero are left out.
std::string build_summary(const BuildFacts& facts, const BuildSettings& settings);

}  // namespace cuesta::app
