#include "apps/cuesta/build_fingerprint.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <system_error>

#include "apps/cuesta/build_summary.h"
#include "apps/cuesta/machine.h"
#include "apps/cuesta/stop_signal.h"
#include "hierarchy/cuesta_file.h"
#include "ooc/container_file.h"
#include "ooc/fingerprint.h"

namespace cuesta::app {
namespace {

/// Those that decide about the output: inputs, what belongs to rasters and the image, a geoid of the user's.
std::vector<std::filesystem::path> all_files(const BuildSettings& settings) {
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

std::uint64_t bytes_of_all(const BuildSettings& settings) {
  std::uint64_t total = 0;
  for (const auto& path : all_files(settings)) {
    std::error_code failed;
    const auto bytes = std::filesystem::file_size(path, failed);
    if (!failed) total += bytes;
  }
  return total;
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
  print.add(fmt::format("cuesta {}, container {}", version_number(), container_version));
  print.add(options_json(settings));
  const std::uint64_t total = bytes_of_all(settings);
  std::uint64_t before = 0;
  for (const auto& path : all_files(settings)) {
    std::uint64_t within = 0;
    print.add(path.filename().string());
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
  const auto open = CuestaFile::open(file);
  if (!open) return false;
  const auto metadata = nlohmann::json::parse(open->directory().metadata, nullptr, false);
  if (!metadata.is_object()) return false;
  const auto kept = metadata.find("fingerprint");
  return kept != metadata.end() && kept->is_string() && *kept == fingerprint;
}

}  // namespace cuesta::app
