#include "apps/cuesta/build_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <system_error>

#include "apps/cuesta/build_fingerprint.h"
#include "apps/cuesta/build_summary.h"
#include "apps/cuesta/machine.h"
#include "apps/cuesta/progress.h"
#include "apps/cuesta/scene_build.h"
#include "apps/cuesta/stop_signal.h"
#include "apps/cuesta/text_forms.h"
#include "ooc/fingerprint.h"
#include "ooc/ingest.h"
#include "ooc/unpacked_file.h"
#include "ooc/work_folder.h"

namespace cuesta::app {
namespace {

Result<BuildSettings> with_defaults(BuildSettings settings) {
  if (settings.memory_bytes == 0) settings.memory_bytes = physical_memory_bytes() / 4 * 3;
  if (settings.output.empty())
    settings.output = name_inside(settings.inputs.front().filename()).replace_extension(".cuesta");
  if (settings.type != BuildType::automatic) return settings;
  const auto is_scene = looks_like_scene(settings);
  if (!is_scene) return fail(is_scene.error());
  if (*is_scene) settings.type = BuildType::scene;
  return settings;
}

bool is_scene(const BuildSettings& s) {
  return s.type == BuildType::scene;
}

bool is_terrain(const BuildSettings& s) {
  return s.type == BuildType::automatic && std::all_of(s.inputs.begin(), s.inputs.end(), is_raster);
}

/// Fails early what would fail after the whole build.
Result<void> check_output(const BuildSettings& s) {
  std::error_code ignored;
  const auto folder = s.output.has_parent_path() ? s.output.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder, ignored))
    return fail(ErrorCode::not_found, folder.string(), "",
                "the output's folder does not exist; make it first");
  if (std::filesystem::is_directory(s.output, ignored))
    return fail(ErrorCode::invalid_input, s.output.string(), "", "is a folder; give a file name with -o");
  if (is_scene(s) && s.inputs.size() > 1)
    return fail(ErrorCode::invalid_input, "", "",
                "a scene is built from one file or folder; put several into a folder");
  if (!is_terrain(s) && !is_scene(s))
    if (const auto raster = std::find_if(s.inputs.begin(), s.inputs.end(), is_raster);
        raster != s.inputs.end())
      return fail(ErrorCode::invalid_input, raster->string(), "",
                  "is a raster of heights, and other inputs are meshes: build them apart");
  for (const auto& input : s.inputs)
    if (std::filesystem::equivalent(input, s.output, ignored))
      return fail(ErrorCode::invalid_input, s.output.string(), "", "input and output are the same file");
  return {};
}

/// The file that an error is about; of several none by itself.
std::string only_input(const BuildSettings& s) {
  return s.inputs.size() == 1 ? s.inputs.front().string() : std::string();
}

Result<void> check_memory(const BuildSettings& s) {
  if (s.memory_bytes >= least_memory_bytes) return {};
  return fail(ErrorCode::invalid_input, "", "",
              fmt::format("a build needs {} of memory, {} were given with --memory",
                          byte_count(least_memory_bytes), byte_count(s.memory_bytes)));
}

/// Beside the output; or in the folder that was chosen, with a name of its own for each output.
std::filesystem::path work_path(const BuildSettings& s) {
  auto name = s.output.filename();
  if (s.temp.empty()) return s.output.parent_path() / (name += ".work");
  Fingerprint print;
  print.add(std::filesystem::absolute(s.output).lexically_normal().string());
  return s.temp / (name += "-" + print.hex().substr(0, 8) + ".work");
}

/// Whether the same command, later, can go on from what is there.
bool is_resumable(ErrorCode code) {
  return code == ErrorCode::cancelled || code == ErrorCode::io || code == ErrorCode::out_of_budget;
}

/// Another program may make something else of the same input.
std::string program_identity() {
  std::error_code failed;
  const auto program = std::filesystem::last_write_time("/proc/self/exe", failed);
  return fmt::format("{} {}", version_number(), failed ? 0 : program.time_since_epoch().count());
}

/// What unfinished work is worth: nothing to another program, nor after a restart of the machine, as it is
/// not synced to the disk.
std::string work_fingerprint(const std::string& fingerprint) {
  std::string boot;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  return fmt::format("{} {} {}", fingerprint, boot, program_identity());
}

std::filesystem::path cells_path(const BuildSettings& s) {
  auto path = s.output;
  return path += ".cells";
}

/// A run that ended between giving the output its name and tidying up left its work folder.
void remove_leftovers(const BuildSettings& s, const std::filesystem::path& work,
                      const std::string& fingerprint) {
  std::error_code ignored;
  if (!std::filesystem::exists(work / "journal.sqlite", ignored)) return;
  auto folder = WorkFolder::open(work, work_fingerprint(fingerprint));
  if (!folder) return;  // another process is at work in it
  folder->remove();
  std::filesystem::remove(s.output.string() + ".part", ignored);
}

void note_inputs(const BuildSettings& s, BuildFacts& facts) {
  for (const auto& path : s.inputs) {
    std::error_code failed;
    const auto bytes = std::filesystem::file_size(path, failed);
    facts.inputs.push_back({path.filename().string(), failed ? 0 : bytes, {}});
  }
}

/// Reads all inputs as one surface.
Result<std::vector<ReadReport>> read_inputs(const BuildSettings& s, const BuildFacts& facts,
                                            const std::filesystem::path& temp, RawSurface& sink,
                                            Progress& progress) {
  std::uint64_t total = 0, before = 0;
  for (const InputFacts& input : facts.inputs) total += input.bytes;
  std::vector<ReadReport> reports;
  for (const auto& path : s.inputs) {
    sink.begin_input();
    const auto reading = [&](std::uint64_t done, std::uint64_t) {
      return progress.update("read", Unit::bytes, std::min(before + done, total), total);
    };
    auto report = read_mesh(path, sink, s.memory_bytes / 2, reading, temp, s.volume);
    if (!report) return fail(report.error());
    before += facts.inputs[reports.size()].bytes;
    reports.push_back(*report);
  }
  return reports;
}

void note_surface(const IngestedSurface& surface, BuildFacts& facts) {
  for (std::size_t i = 0; i < surface.inputs.size(); ++i) facts.inputs[i].read = surface.inputs[i];
  facts.missing = surface.missing;
  facts.clean = surface.report;
}

Result<void> build_pages(const InputSurface& surface, WorkFolder& folder, const BuildSettings& s,
                         BuildFacts& facts, MemoryBudget& memory, const BuildProgress& update) {
  facts.triangles = surface.triangles;
  facts.vertices = surface.vertices;
  facts.attributes = surface.attributes;
  BuildOptions options;
  options.cell_triangles = s.cell_triangles;
  options.metadata = build_metadata(facts, s);
  std::optional<CellCache> cache;
  if (s.incremental) {
    auto opened = CellCache::open(cells_path(s), program_identity());
    if (!opened) return fail(opened.error());
    cache.emplace(std::move(*opened));
    options.cache = &*cache;
  }
  auto built = build_hierarchy(surface, s.output, options, folder, memory, update);
  if (!built) return fail(built.error());
  facts.built = *built;
  if (cache) {
    cache->remove_unused();
    facts.cells_made = cache->made();
    facts.cells_known = cache->found();
  }
  return {};
}

Result<void> build_terrain(WorkFolder& folder, const BuildSettings& s, BuildFacts& facts,
                           MemoryBudget& memory, Progress& progress) {
  const auto update = [&](std::string_view stage, std::uint64_t done, std::uint64_t total) {
    const bool reads = stage == "read";
    return progress.update(reads ? stage : "build", reads ? Unit::postings : Unit::triangles, done, total);
  };
  auto input = open_terrain(s.inputs, s.terrain, folder.path());
  if (!input) return fail(input.error());
  facts.warnings = input->warnings;
  auto for_mosaic = memory.reserve(input->mosaic->memory_bytes(), "blocks of rasters");
  if (!for_mosaic) return fail(for_mosaic.error());
  TerrainOptions options;
  options.step_m = s.step;
  options.make_normals = s.make_normals;
  options.drape = input->drape.get();
  auto surface = TerrainSurface::survey(*input->mosaic, input->facts.frame, options, folder, memory, update);
  if (!surface) return fail(surface.error());
  note_survey(**surface, *input->mosaic, input->facts);
  facts.terrain = std::move(input->facts);
  return build_pages(**surface, folder, s, facts, memory, update);
}

Result<void> build_mesh(WorkFolder& folder, const BuildSettings& s, BuildFacts& facts, MemoryBudget& memory,
                        Progress& progress) {
  const auto update = [&](std::string_view stage, std::uint64_t done, std::uint64_t total) {
    return progress.update(stage.starts_with("round") ? "build" : stage, Unit::triangles, done, total);
  };
  IngestOptions ingesting;
  ingesting.step = s.step;
  ingesting.weld_tolerance = s.weld;
  ingesting.make_normals = s.make_normals;
  ingesting.chunk_triangles = std::max(ingesting.chunk_triangles, s.cell_triangles);
  auto surface = ingest(
      folder, ingesting, memory,
      [&](RawSurface& sink) { return read_inputs(s, facts, folder.path(), sink, progress); }, update);
  if (!surface) {
    Error error = surface.error();
    if (error.file.empty()) error.file = only_input(s);
    return fail(error);
  }
  note_surface(*surface, facts);
  return build_pages(*surface, folder, s, facts, memory, update);
}

}  // namespace

Result<void> run_build(const BuildSettings& given) {
  const auto settings = with_defaults(given);
  if (!settings) return fail(settings.error());
  const BuildSettings& s = *settings;
  if (auto r = check_output(s); !r) return r;
  if (auto r = check_memory(s); !r) return r;
  const double start_ms = clock_ms();
  Progress progress(s.quiet);
  BuildFacts facts;
  note_inputs(s, facts);
  auto fingerprint = build_fingerprint(s, progress);
  if (!fingerprint) return fail(fingerprint.error());
  const bool up_to_date = is_up_to_date(s.output, *fingerprint);
  const auto work = work_path(s);
  if (!s.force && up_to_date) {
    progress.finish();
    remove_leftovers(s, work, *fingerprint);
    fmt::print("{}: up to date; --force builds it anyway\n", s.output.string());
    return {};
  }
  facts.fingerprint = std::move(*fingerprint);
  auto folder = WorkFolder::open(work, work_fingerprint(facts.fingerprint), s.resume && !up_to_date);
  if (!folder) return fail(folder.error());
  if (folder->journal().is_resumed() && !s.quiet)
    fmt::print(stderr, "going on with what an earlier run left in {}\n", work.string());
  MemoryBudget memory(s.memory_bytes);
  const auto built = is_scene(s)     ? build_scene_file(*folder, s, facts, memory, progress)
                     : is_terrain(s) ? build_terrain(*folder, s, facts, memory, progress)
                                     : build_mesh(*folder, s, facts, memory, progress);
  if (!built) {
    if (!is_resumable(built.error().code)) {
      folder->remove();
      std::error_code ignored;
      std::filesystem::remove(s.output.string() + ".part", ignored);
    }
    return built;
  }
  folder->remove();
  progress.finish();
  facts.seconds = (clock_ms() - start_ms) / 1000;
  fmt::print("{}", build_summary(facts, s));
  return {};
}

}  // namespace cuesta::app
