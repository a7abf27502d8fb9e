#include "apps/cuesta/scene_build.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/cuesta/machine.h"
#include "apps/cuesta/text_forms.h"
#include "ooc/unpacked_file.h"

namespace cuesta::app {
namespace {

std::string lower_inner_extension(const std::filesystem::path& path) {
  std::string text = name_inside(path.filename()).extension().string();
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

Result<std::unique_ptr<SceneSource>> open(const BuildSettings& s, const std::filesystem::path& temp) {
  return open_scene(s.inputs.front(), s.memory_bytes / 4, temp);
}

bool has_rasters(const std::filesystem::path& folder) {
  std::error_code failed;
  for (std::filesystem::recursive_directory_iterator at(folder, failed), end; !failed && at != end;
       at.increment(failed))
    if (at->is_regular_file(failed) && is_raster(at->path())) return true;
  return false;
}

/// More than one thing to show, or something that moves.
bool has_structure(const Scene& scene) {
  const auto instances = std::count_if(scene.nodes.begin(), scene.nodes.end(),
                                       [](const SceneNode& n) { return n.part != no_index; });
  return instances > 1 || !scene.clips.empty();
}

std::string row(std::string_view name, std::string_view value) {
  return fmt::format("  {:<12}{}\n", name, value);
}

}  // namespace

Result<bool> looks_like_scene(const BuildSettings& s) {
  if (s.inputs.size() != 1) return false;
  const auto& path = s.inputs.front();
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return !has_rasters(path) && open(s, s.temp).has_value();
  const std::string extension = lower_inner_extension(path);
  if (extension != ".gltf" && extension != ".glb") return false;
  const auto scene = open(s, s.temp);
  if (!scene) return fail(scene.error());
  return has_structure((*scene)->scene());
}

Result<std::vector<std::filesystem::path>> files_of_scene(const BuildSettings& s) {
  const auto scene = open(s, s.temp);
  if (!scene) return fail(scene.error());
  return (*scene)->files();
}

Result<void> build_scene_file(WorkFolder& folder, const BuildSettings& s, BuildFacts& facts,
                              MemoryBudget& memory, Progress& progress) {
  auto source = open(s, folder.path());
  if (!source) return fail(source.error());
  facts.warnings = (*source)->warnings();
  SceneBuildOptions options;
  options.step = s.step;
  options.make_normals = s.make_normals;
  options.cell_triangles = s.cell_triangles;
  options.largest_tom = s.largest_tom;
  options.metadata = [&](const SceneBuildReport& report) { return scene_metadata(report, facts, s); };
  const auto update = [&](std::string_view stage, std::uint64_t done, std::uint64_t total) {
    const Unit unit = stage == "survey" ? Unit::none : Unit::triangles;
    return progress.update(stage.starts_with("round") ? "build" : stage, unit, done, total);
  };
  auto built = build_scene(**source, s.output, options, folder, memory, update);
  if (!built) return fail(built.error());
  facts.scene = *built;
  facts.inputs.front().read = built->read;
  facts.clean = built->clean;
  facts.triangles = built->triangles;
  return {};
}

std::string scene_metadata(const SceneBuildReport& r, const BuildFacts& facts, const BuildSettings& s) {
  nlohmann::ordered_json json;
  json["program"] = "cuesta " + version_number();
  json["inputs"] = nlohmann::ordered_json::array();
  for (const InputFacts& input : facts.inputs)
    json["inputs"].push_back({{"name", input.name}, {"bytes", input.bytes}});
  json["scene"] = {{"nodes", r.nodes},
                   {"instances", r.instances},
                   {"materials", r.materials},
                   {"clips", r.clips},
                   {"parts_read", r.parts_read},
                   {"parts_equal", r.parts_equal},
                   {"parts_empty", r.parts_empty},
                   {"toms", r.toms},
                   {"surfaces", r.surfaces},
                   {"triangles", r.triangles},
                   {"instanced_triangles", r.instanced_triangles},
                   {"instanced_read", r.instanced_read}};
  json["read"] = counts_json(read_counts(r.read));
  json["clean"] = counts_json(clean_counts(r.clean));
  json["warnings"] = facts.warnings;
  json["options"] = nlohmann::ordered_json::parse(options_json(s));
  json["fingerprint"] = facts.fingerprint;
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string scene_rows(const SceneBuildReport& r) {
  std::string text = row(
      "scene", fmt::format("{} nodes, {} instances of {} parts; {} materials, {} clips", with_commas(r.nodes),
                           with_commas(r.instances), with_commas(r.toms + r.surfaces), r.materials, r.clips));
  text += row("triangles", fmt::format("{} in parts, {} in instances", with_commas(r.triangles),
                                       with_commas(r.instanced_triangles)));
  if (r.surfaces > 0)
    text += row("", fmt::format("{} parts are fan-hierarchies, {} are TOMs", with_commas(r.surfaces),
                                with_commas(r.toms)));
  if (r.parts_equal > 0)
    text += row("", with_commas(r.parts_equal) + " parts are equal to others: stored once");
  if (r.parts_empty > 0) text += row("", with_commas(r.parts_empty) + " parts dropped: without triangles");
  text += row("file", fmt::format("{}, {:.2f} bytes per triangle; all coarsest parts in the first {}",
                                  byte_count(r.file_bytes),
                                  static_cast<double>(r.file_bytes) /
                                      static_cast<double>(std::max<std::uint64_t>(1, r.triangles)),
                                  byte_count(r.coarsest_bytes)));
  return text;
}

}  // namespace cuesta::app
