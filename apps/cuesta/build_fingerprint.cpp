#include "apps/cuesta/build_fingerprint.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <system_error>

#include "apps/cuesta/build_summary.h"
#include "apps/cuesta/machine.h"
#include "apps/cuesta/scene_build.h"
#include "apps/cuesta/stop_signal.h"
#include "hierarchy/cuesta_file.h"
#include "hierarchy/scene_file.h"
#include "ooc/container_file.h"
#include "ooc/fingerprint.h"

namespace cuesta::app {
namespace {

/// Those that decide about the output: inputs, what belongs to rasters and the image, a geoid of the user's;
/// of a scene, all that it names.
Result<std::vector<std::filesystem::path>> all_files(const BuildSettings& settings) {
  if (settings.type == BuildType::scene) return files_of_scene(settings);
  std::vector<std::filesystem::path> files;
  for (const auto& path : settings.inputs) {
    if (!is_raster(path)) {
      files.push_back(path);
      continue;
    }
    const auto of_raster = files_of_raster(path);
    files.insert(files.end(), of_raster.begin(), of_raster.end());
  }
  if (!settings.terrain.drape.empty()) {
    const auto of_image = files_of_raster(settings.terrain.drape);
    files.insert(files.end(), of_image.begin(), of_image.end());
  }
  std::error_code ignored;
  if (std::filesystem::is_regular_file(settings.terrain.geoid, ignored))
    files.emplace_back(settings.terrain.geoid);
  return files;
}

/// In a folder that is a scene, also where in it.
std::string name_of(const std::filesystem::path& path, const BuildSettings& settings) {
  std::error_code ignored;
  const auto& input = settings.inputs.front();
  const bool is_inside = settings.type == BuildType::scene && std::filesystem::is_directory(input, ignored);
  return (is_inside ? path.lexically_relative(input) : path.filename()).string();
}

std::uint64_t bytes_of_all(const std::vector<std::filesystem::path>& files) {
  std::uint64_t total = 0;
  for (const auto& path : files) {
    std::error_code failed;
    const auto bytes = std::filesystem::file_size(path, failed);
    if (!failed) total += bytes;
  }
  return total;
}

/// Empty if it cannot be read.
std::string metadata_in(const std::filesystem::path& file) {
  const auto kind = ContainerReader::kind_of(file);
  if (kind && *kind == ContainerKind::scene) {
    const auto scene = SceneFile::open(file);
    return scene && scene->is_whole() ? scene->directory().metadata : "";
  }
  const auto surface = CuestaFile::open(file);
  return surface ? surface->directory().metadata : "";
}

bool is_program_newer(const std::filesystem::path& file) {
  std::error_code failed;
  const auto program = std::filesystem::last_write_time("/proc/self/exe", failed);
  if (failed) return false;
  const auto output = std::filesystem::last_write_time(file, failed);
  return failed || output < program;
}

}  // namespace

Result<std::string> build_fingerprint(const BuildSettings& settings, Progress& progress) {
  Fingerprint print;
  print.add(fmt::format(
      "cuesta {}, container {}", version_number(),
      container_version(settings.type == BuildType::scene ? ContainerKind::scene : ContainerKind::surface)));
  print.add(options_json(settings));
  const auto files = all_files(settings);
  if (!files) return fail(files.error());
  const std::uint64_t total = bytes_of_all(*files);
  std::uint64_t before = 0;
  for (const auto& path : *files) {
    std::uint64_t within = 0;
    print.add(name_of(path, settings));
    const auto added = print.add_file(path, [&](std::uint64_t done) {
      within = done;
      return progress.update("fingerprint", Unit::bytes, before + done, total);
    });
    if (auto stopped = check_stop(); !stopped) return fail(stopped.error());
    if (!added) return fail(added.error());
    before += within;
  }
  return print.hex();
}

bool is_up_to_date(const std::filesystem::path& file, const std::string& fingerprint) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored) || is_program_newer(file)) return false;
  const auto metadata = nlohmann::json::parse(metadata_in(file), nullptr, false);
  if (!metadata.is_object()) return false;
  const auto kept = metadata.find("fingerprint");
  return kept != metadata.end() && kept->is_string() && *kept == fingerprint;
}

}  // namespace cuesta::app
