#include "apps/cuesta/export_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/cuesta/open_cut.h"
#include "apps/cuesta/scene_export.h"
#include "apps/cuesta/tiles_command.h"
#include "apps/overview/file_facts.h"
#include "ooc/mesh_writer.h"
#include "runtime/extract.h"

namespace cuesta::app {
namespace {

View camera_view(const ExportSettings& s) {
  View view = s.view;
  view.eye = s.camera->eye;
  view.target = s.camera->target;
  view.up = s.camera->up.value_or(view.up);
  return view;
}

ErrorScale export_scale(const ExportSettings& s, const Grid& grid) {
  return s.camera ? ErrorScale::perspective(grid, camera_view(s), s.outside_factor)
                  : ErrorScale::uniform(grid);
}

/// The threshold for substitutions. An error asked for includes what snapping to the grid took.
double export_tau(const ExportSettings& s, const Directory& d) {
  if (s.full) return -1;
  if (s.camera) return s.tau_px;
  return s.error ? std::max(0.0, *s.error - snapping_error(d)) : 0;
}

Result<void> check_complete(const ExportSettings& s, const AdaptReport& report) {
  if (report.bound_by != Binding::resident_bytes) return {};
  return fail(
      ErrorCode::out_of_budget, s.file.string(), "",
      fmt::format(
          "this cut does not fit the page cache ({} resident); give more with --cache or ask for fewer "
          "triangles",
          byte_count(report.resident_bytes)));
}

constexpr std::pair<const char*, ExportFormat> extensions[] = {{".ply", ExportFormat::ply},
                                                               {".obj", ExportFormat::obj},
                                                               {".glb", ExportFormat::glb},
                                                               {".3tz", ExportFormat::tiles_3d}};

ExportFormat format_by_name(const std::filesystem::path& output) {
  for (const auto& [extension, format] : extensions)
    if (output.extension() == extension) return format;
  return ExportFormat::by_name;
}

/// Before the work that would be for nothing. Meshes are written in the format that their name says.
Result<void> check_format(const ExportSettings& s) {
  const ExportFormat by_name = format_by_name(s.output);
  if (s.format == ExportFormat::by_name || s.format == by_name) {
    if (by_name != ExportFormat::by_name) return {};
    return fail(ErrorCode::invalid_input, s.output.string(), "",
                "meshes are written as .ply, .obj or .glb, tiles as .3tz or with --format, found \"" +
                    s.output.extension().string() + "\"");
  }
  const bool tiles = s.format == ExportFormat::tiles_3d || s.format == ExportFormat::quantized_mesh;
  if (tiles && by_name == ExportFormat::by_name) return {};
  return fail(ErrorCode::invalid_input, s.output.string(), "",
              "the name's extension is of another format than --format");
}

Result<void> export_tiles(const ExportSettings& s) {
  TilesSettings tiles;
  tiles.file = s.file;
  tiles.output = s.output;
  tiles.options = {s.tile_triangles, s.border_share, s.cache_bytes};
  tiles.terrain = s.format == ExportFormat::quantized_mesh;
  tiles.finest_error_m = s.error.value_or(0);
  tiles.json = s.json;
  tiles.quiet = s.quiet;
  return run_export_tiles(tiles);
}

void tell_json(const ExportSettings& s, const Directory& d, const SurfaceMesh& mesh,
               const AdaptReport& report) {
  nlohmann::ordered_json json;
  json["file"] = s.output.string();
  json["triangles"] = mesh.triangles.size();
  json["vertices"] = mesh.positions.size();
  json["snapping_error"] = snapping_error(d);
  if (s.camera)
    json["error_bound_px"] = report.achieved;
  else
    json["error_bound"] = report.achieved + snapping_error(d);
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void tell(const ExportSettings& s, const Directory& d, const SurfaceMesh& mesh, const AdaptReport& report) {
  fmt::print("{}: {} triangles, {} vertices\n", s.output.string(), with_commas(mesh.triangles.size()),
             with_commas(mesh.positions.size()));
  if (s.camera) {
    fmt::print("guaranteed error: {:.6g} pixels at {}x{}, and {:.6g} units of snapping\n", report.achieved,
               s.view.width_px, s.view.height_px, snapping_error(d));
  } else {
    const Box3d box = world_box(d);
    const double bound = report.achieved + snapping_error(d);
    fmt::print("guaranteed error: {:.6g} units ({:.4g} % of the diagonal), {:.6g} of it snapping\n", bound,
               100 * bound / std::max(length(box.hi - box.lo), 1e-300), snapping_error(d));
  }
}

}  // namespace

ExportFormat format_of(const ExportSettings& s) {
  return s.format == ExportFormat::by_name ? format_by_name(s.output) : s.format;
}

Result<void> run_export(const ExportSettings& s) {
  if (auto r = check_format(s); !r) return r;
  const ExportFormat format = format_of(s);
  if (format == ExportFormat::tiles_3d || format == ExportFormat::quantized_mesh) return export_tiles(s);
  const auto kind = ContainerReader::kind_of(s.file);
  if (!kind) return fail(kind.error());
  if (*kind == ContainerKind::scene) return run_scene_export(s);
  if (!s.node.empty() || !s.part.empty())
    return fail(ErrorCode::invalid_input, s.file.string(), "--node, --part",
                "are for scenes; this is one surface");
  Progress progress(s.quiet);
  auto cut = open_cut(s.file, s.cache_bytes);
  if (!cut) return fail(cut.error());
  const Directory& d = (*cut)->directory();
  Budgets budgets;
  if (s.triangles) budgets.triangles = *s.triangles;
  const auto report = settle_cut(**cut, export_scale(s, d.grid), export_tau(s, d), budgets, progress);
  if (!report) return fail(report.error());
  if (const auto errors = (*cut)->cache().errors(); !errors.empty()) return fail(errors.front());
  if (auto r = check_complete(s, *report); !r) return r;
  progress.update("write", Unit::none, 0, 0);
  auto mesh = extract_mesh((*cut)->draw_list(), {d.has_normals, d.has_colours});
  if (!mesh) return fail(mesh.error());
  if (auto r = write_mesh(s.output, *mesh); !r) return r;
  progress.finish();
  (s.json ? tell_json : tell)(s, d, *mesh, *report);
  return {};
}

}  // namespace cuesta::app
