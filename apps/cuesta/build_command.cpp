#include "apps/cuesta/build_command.h"

#include <fmt/format.h>

#include <system_error>

#include "apps/cuesta/build_fingerprint.h"
#include "apps/cuesta/build_summary.h"
#include "apps/cuesta/machine.h"
#include "apps/cuesta/progress.h"
#include "apps/cuesta/stop_signal.h"
#include "apps/cuesta/text_forms.h"
#include "ooc/unpacked_file.h"

namespace cuesta::app {
namespace {

/// Peak of clean_mesh and build_hierarchy, whichever is larger, with the mesh itself. Per triangle: the
/// headers' 120 and 150 bytes beyond their input, and an input of 12 bytes plus half a vertex of up to 56
/// bytes.
constexpr std::uint64_t work_bytes_per_triangle = 200;

BuildSettings with_defaults(BuildSettings settings) {
  if (settings.memory_bytes == 0) settings.memory_bytes = physical_memory_bytes() / 4 * 3;
  if (settings.output.empty())
    settings.output = name_inside(settings.inputs.front().filename()).replace_extension(".cuesta");
  return settings;
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
  for (const auto& input : s.inputs)
    if (std::filesystem::equivalent(input, s.output, ignored))
      return fail(ErrorCode::invalid_input, s.output.string(), "", "input and output are the same file");
  return {};
}

/// The file that an error is about; of several none by itself.
std::string only_input(const BuildSettings& s) {
  return s.inputs.size() == 1 ? s.inputs.front().string() : std::string();
}

Result<void> check_memory(const BuildSettings& s, std::uint64_t triangles) {
  const std::uint64_t needed = triangles * work_bytes_per_triangle;
  if (needed <= s.memory_bytes) return {};
  return fail(
      ErrorCode::out_of_budget, only_input(s), "",
      fmt::format("building {} triangles in core needs about {}, the budget is {}; give more with --memory",
                  with_commas(triangles), byte_count(needed), byte_count(s.memory_bytes)));
}

void note_inputs(const BuildSettings& s, BuildFacts& facts) {
  for (const auto& path : s.inputs) {
    std::error_code failed;
    const auto bytes = std::filesystem::file_size(path, failed);
    facts.inputs.push_back({path.filename().string(), failed ? 0 : bytes, {}});
  }
}

void note_reading(const LoadedMeshes& loaded, BuildFacts& facts) {
  for (std::size_t i = 0; i < loaded.files.size(); ++i) facts.inputs[i].read = loaded.files[i];
  facts.missing = loaded.missing;
}

Result<GridMesh> read_and_clean(const BuildSettings& s, BuildFacts& facts, Progress& progress) {
  const auto reading = [&](std::uint64_t done, std::uint64_t total) {
    return progress.update("read", Unit::bytes, done, total);
  };
  auto loaded = load_meshes(s.inputs, s.memory_bytes, reading, s.temp, s.volume);
  if (!loaded) return fail(loaded.error());
  note_reading(*loaded, facts);
  SurfaceMesh mesh = std::move(loaded->mesh);
  if (auto r = check_memory(s, mesh.triangles.size()); !r) return fail(r.error());
  progress.update("clean", Unit::none, 0, 0);
  auto clean = clean_mesh(std::move(mesh), {s.step, s.make_normals}, facts.clean);
  if (!clean) {
    Error error = clean.error();
    if (error.file.empty()) error.file = only_input(s);
    return fail(error);
  }
  if (auto r = check_stop(); !r) return fail(r.error());
  return clean;
}

void note_surface(const GridMesh& mesh, BuildFacts& facts) {
  facts.triangles = mesh.triangles.size();
  facts.vertices = mesh.positions.size();
  facts.has_normals = !mesh.normals.empty();
  facts.has_colours = !mesh.colours.empty();
  facts.has_texcoords = !mesh.texcoords.empty();
}

}  // namespace

Result<void> run_build(const BuildSettings& given) {
  const BuildSettings s = with_defaults(given);
  if (auto r = check_output(s); !r) return r;
  const double start_ms = clock_ms();
  Progress progress(s.quiet);
  BuildFacts facts;
  note_inputs(s, facts);
  auto fingerprint = build_fingerprint(s, progress);
  if (!fingerprint) return fail(fingerprint.error());
  if (!s.force && is_up_to_date(s.output, *fingerprint)) {
    progress.finish();
    fmt::print("{}: up to date; --force builds it anyway\n", s.output.string());
    return {};
  }
  facts.fingerprint = std::move(*fingerprint);
  auto mesh = read_and_clean(s, facts, progress);
  if (!mesh) return fail(mesh.error());
  note_surface(*mesh, facts);

  BuildOptions options;
  options.cell_triangles = s.cell_triangles;
  options.metadata = build_metadata(facts, s);
  progress.update("build", Unit::triangles, 0, facts.triangles);
  auto built = build_hierarchy(std::move(*mesh), s.output, options,
                               [&](std::string_view, std::uint64_t done, std::uint64_t all) {
                                 return progress.update("build", Unit::triangles, done, all);
                               });
  if (!built) return fail(built.error());
  progress.finish();
  facts.built = *built;
  facts.seconds = (clock_ms() - start_ms) / 1000;
  fmt::print("{}", build_summary(facts, s));
  return {};
}

}  // namespace cuesta::app
