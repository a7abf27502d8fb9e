#include "apps/cuesta/build_summary.h"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "apps/cuesta/machine.h"
#include "apps/cuesta/scene_build.h"
#include "apps/cuesta/text_forms.h"

namespace cuesta::app {

Counts read_counts(const ReadReport& r) {
  return {{"vertices", r.vertices},
          {"triangles", r.triangles},
          {"polygons_triangulated", r.polygons_triangulated},
          {"faces_out_of_range", r.faces_out_of_range},
          {"faces_too_small", r.faces_too_small},
          {"other_files", r.other_files}};
}

Counts clean_counts(const CleanReport& c) {
  return {{"nonfinite_vertices", c.nonfinite_vertices},
          {"faces_nonfinite", c.faces_nonfinite},
          {"vertices_welded", c.vertices_welded},
          {"faces_degenerate", c.faces_degenerate},
          {"faces_duplicate", c.faces_duplicate},
          {"edges_nonmanifold", c.edges_nonmanifold},
          {"vertices_split", c.vertices_split},
          {"vertices_unused", c.vertices_unused},
          {"wedge_groups", c.wedge_groups}};
}

nlohmann::ordered_json counts_json(const Counts& counts) {
  nlohmann::ordered_json object = nlohmann::ordered_json::object();
  for (const auto& [name, count] : counts) object[name] = count;
  return object;
}

namespace {

/// Of builds that weld borders only: files of others know nothing of them.
Counts weld_counts(const CleanReport& c) {
  return {{"border_points", c.border_points}, {"border_points_welded", c.border_points_welded}};
}

Counts told_counts(const ReadReport& r, const CleanReport& c) {
  return {{"polygons triangulated", r.polygons_triangulated},
          {"faces dropped: index out of range", r.faces_out_of_range},
          {"faces dropped: fewer than three corners", r.faces_too_small},
          {"vertices dropped: not finite", c.nonfinite_vertices},
          {"faces dropped: not finite", c.faces_nonfinite},
          {"vertices welded", c.vertices_welded},
          {"faces dropped: degenerate", c.faces_degenerate},
          {"faces dropped: duplicate", c.faces_duplicate},
          {"non-manifold edges cut", c.edges_nonmanifold},
          {"vertices copied to separate sheets", c.vertices_split},
          {"vertices dropped: unused", c.vertices_unused},
          {"positions on attribute seams", c.wedge_groups}};
}

Counts missing_counts(const MissingAttributes& m) {
  return {{"normals", m.normals}, {"colours", m.colours}, {"texcoords", m.texcoords}};
}

Counts told_missing(const MissingAttributes& m, bool make_normals) {
  return {{make_normals ? "vertices of inputs without normals: computed"
                        : "vertices of inputs without normals: none",
           m.normals},
          {"vertices of inputs without colours: white", m.colours},
          {"vertices of inputs without texture coordinates: (0, 0)", m.texcoords}};
}

/// All inputs as one: the name of the only one, or how many there are.
InputFacts totals(const BuildFacts& f) {
  InputFacts all;
  all.name = f.inputs.size() == 1 ? f.inputs.front().name : with_commas(f.inputs.size()) + " files";
  for (const InputFacts& input : f.inputs) {
    all.bytes += input.bytes;
    all.read.vertices += input.read.vertices;
    all.read.triangles += input.read.triangles;
    all.read.polygons_triangulated += input.read.polygons_triangulated;
    all.read.faces_out_of_range += input.read.faces_out_of_range;
    all.read.faces_too_small += input.read.faces_too_small;
    all.read.other_files += input.read.other_files;
  }
  return all;
}

/// What was asked for only: files of builds without volumes know nothing of them.
nlohmann::ordered_json volume_of(const VolumeOptions& volume) {
  nlohmann::ordered_json object = nlohmann::ordered_json::object();
  if (!volume.grid.empty()) object["grid"] = volume.grid;
  if (volume.iso) object["iso"] = *volume.iso;
  if (volume.adaptivity > 0) object["adaptivity"] = volume.adaptivity;
  return object;
}

/// The same of terrains.
nlohmann::ordered_json terrain_of(const TerrainSettings& t) {
  constexpr std::array<const char*, 4> frames{"auto", "ecef", "enu", "projected"};
  nlohmann::ordered_json object = nlohmann::ordered_json::object();
  if (!t.crs.empty()) object["crs"] = t.crs;
  if (!t.geoid.empty()) object["geoid"] = t.geoid;
  if (t.heights != VerticalDatum::unknown) object["heights"] = name(t.heights);
  if (t.frame != FrameChoice::automatic) object["frame"] = frames[static_cast<std::size_t>(t.frame)];
  if (t.origin) object["origin"] = {t.origin->lat_deg, t.origin->lon_deg};
  if (t.priority != MosaicPriority::finest_first) object["priority"] = "order";
  if (t.sea_level_m) object["sea_level_m"] = *t.sea_level_m;
  if (t.no_data) object["no_data"] = *t.no_data;
  if (t.fill_postings > 0) object["fill_postings"] = t.fill_postings;
  if (t.zoom) object["zoom"] = *t.zoom;
  if (!t.variable.empty()) object["variable"] = t.variable;
  if (!t.drape.empty()) object["drape"] = t.drape.filename().string();
  if (const auto& b = t.drape_bounds)
    object["drape_bounds"] = {b->west_deg, b->south_deg, b->east_deg, b->north_deg};
  return object;
}

nlohmann::ordered_json options_of(const BuildSettings& settings) {
  nlohmann::ordered_json options{{"cell_triangles", settings.cell_triangles},
                                 {"make_normals", settings.make_normals},
                                 {"step", settings.step}};
  if (settings.type == BuildType::scene) {
    options["type"] = "scene";
    options["largest_tom"] = settings.largest_tom;
  }
  if (settings.weld > 0) options["weld"] = settings.weld;
  const auto terrain = terrain_of(settings.terrain);
  if (!terrain.empty()) options["terrain"] = terrain;
  const auto volume = volume_of(settings.volume);
  if (!volume.empty()) options["volume"] = volume;
  return options;
}

std::string attributes(const BuildFacts& f) {
  std::string text;
  const auto add = [&](bool there, const char* word) {
    if (there) text += (text.empty() ? "" : ", ") + std::string(word);
  };
  add(f.attributes.normals, "normals");
  add(f.attributes.colours, "colours");
  add(f.attributes.texcoords, "texture coordinates");
  return text.empty() ? "none" : text;
}

std::string row(std::string_view name, std::string_view value) {
  return fmt::format("  {:<12}{}\n", name, value);
}

/// What was read, and where it is.
std::string terrain_rows(const TerrainFacts& t, const InputFacts& all) {
  std::string text = row(
      "input", fmt::format("{}: {} postings, {}", all.name, with_commas(t.postings), byte_count(all.bytes)));
  const Counts counts{{"postings without data: holes", t.no_data},
                      {"postings without data: interpolated", t.filled},
                      {"postings at or raised to the sea level", t.raised}};
  for (const auto& [words, count] : counts)
    if (count > 0) text += row("", fmt::format("{} {}", with_commas(count), words));
  text +=
      row("heights", fmt::format("{:.1f} to {:.1f} m, {}{}", t.least_m, t.most_m,
                                 t.heights == VerticalDatum::unknown ? "of unknown datum" : name(t.heights),
                                 t.geoid.empty() ? "" : ", geoid " + t.geoid));
  if (t.heights != VerticalDatum::ellipsoidal && t.frame.kind() != FrameKind::projected)
    text += row("", "taken as ellipsoidal: up to 107 m off; --geoid egm96 makes them so");
  if (t.bounds)
    text += row("bounds", fmt::format("{:.4f} to {:.4f} N, {:.4f} to {:.4f} E; postings {:.1f} m apart",
                                      t.bounds->south_deg, t.bounds->north_deg, t.bounds->west_deg,
                                      t.bounds->east_deg, t.spacing_m));
  return text + row("frame", t.frame.description());
}

std::string surface_rows(const BuildFacts& f, double triangles) {
  std::string text =
      row("surface", fmt::format("{} triangles, {} vertices; attributes: {}", with_commas(f.triangles),
                                 with_commas(f.vertices), attributes(f)));
  text += row("hierarchy", fmt::format("{} rounds, {} pages, {} fans, {} substitutions", f.built.rounds,
                                       with_commas(f.built.pages), with_commas(f.built.fans),
                                       with_commas(f.built.substitutions)));
  if (f.cells_made + f.cells_known > 0)
    text += row("", fmt::format("{} of {} cells were known from the build before", with_commas(f.cells_known),
                                with_commas(f.cells_made + f.cells_known)));
  text += row("file", fmt::format("{}, {:.2f} bytes per triangle", byte_count(f.built.file_bytes),
                                  static_cast<double>(f.built.file_bytes) / triangles));
  return text;
}

}  // namespace

std::string options_json(const BuildSettings& settings) {
  return options_of(settings).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string build_metadata(const BuildFacts& facts, const BuildSettings& settings) {
  nlohmann::ordered_json json;
  json["program"] = "cuesta " + version_number();
  json["inputs"] = nlohmann::ordered_json::array();
  for (const InputFacts& input : facts.inputs) {
    json["inputs"].push_back({{"name", input.name}, {"bytes", input.bytes}});
    if (facts.terrain) continue;  // what is in each is in "terrain"
    json["inputs"].back()["vertices"] = input.read.vertices;
    json["inputs"].back()["triangles"] = input.read.triangles;
  }
  if (facts.terrain) {
    json["terrain"] = nlohmann::ordered_json::parse(terrain_json(*facts.terrain));
    json["warnings"] = facts.warnings;
  } else {
    json["read"] = counts_json(read_counts(totals(facts).read));
    json["missing"] = counts_json(missing_counts(facts.missing));
    json["clean"] = counts_json(clean_counts(facts.clean));
    if (settings.weld > 0) json["clean"].update(counts_json(weld_counts(facts.clean)));
  }
  json["options"] = options_of(settings);
  if (totals(facts).read.other_files == 0) json["fingerprint"] = facts.fingerprint;
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string build_summary(const BuildFacts& f, const BuildSettings& settings) {
  const double triangles = static_cast<double>(std::max<std::uint64_t>(1, f.triangles));
  std::string text = settings.output.string() + "\n";
  const InputFacts all = totals(f);
  if (f.terrain) text += terrain_rows(*f.terrain, all);
  for (const std::string& warning : f.warnings) text += row("", warning);
  if (!f.terrain)
    text += row("input",
                fmt::format("{}: {} triangles, {} vertices, {}", all.name, with_commas(all.read.triangles),
                            with_commas(all.read.vertices), byte_count(all.bytes)));
  for (const auto& [words, count] : told_missing(f.missing, settings.make_normals))
    if (count > 0) text += row("", fmt::format("{} {}", with_commas(count), words));
  if (settings.weld > 0)
    text += row(
        "", fmt::format("{} of {} border points welded within {}", with_commas(f.clean.border_points_welded),
                        with_commas(f.clean.border_points), settings.weld));
  for (const auto& [words, count] : told_counts(all.read, f.clean))
    if (count > 0) text += row("", fmt::format("{} {}", with_commas(count), words));
  text += f.scene ? scene_rows(*f.scene) : surface_rows(f, triangles);
  text += row("time",
              fmt::format("{}, {} triangles/s", duration(f.seconds),
                          with_commas(static_cast<std::uint64_t>(triangles / std::max(1e-6, f.seconds)))));
  return text + row("peak memory", byte_count(peak_resident_bytes()));
}

}  // namespace cuesta::app
