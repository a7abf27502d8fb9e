#include "apps/cuesta/info_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/cuesta/open_cut.h"
#include "apps/cuesta/text_forms.h"

namespace cuesta::app {
namespace {

using nlohmann::ordered_json;

struct Round {
  std::uint32_t pages = 0;
  std::uint64_t triangles = 0, owned_triangles = 0, bytes = 0;
  double least_error = 0, largest_error = 0;  // world units
};

std::vector<Round> rounds_of(const Directory& d) {
  std::vector<Round> rounds;
  for (const PageEntry& e : d.pages) {
    if (e.round >= rounds.size()) rounds.resize(std::size_t{e.round} + 1);
    Round& r = rounds[e.round];
    const double least = static_cast<double>(decode_error(e.least_error)) * d.grid.step;
    r.least_error = r.pages == 0 ? least : std::min(r.least_error, least);
    r.largest_error =
        std::max(r.largest_error, static_cast<double>(decode_error(e.largest_error)) * d.grid.step);
    ++r.pages;
    r.triangles += e.triangles;
    r.owned_triangles += e.owned_triangles;
    r.bytes += e.block.bytes;
  }
  return rounds;
}

ordered_json json_of(Vec3d v) {
  return ordered_json::array({v.x, v.y, v.z});
}

ordered_json json_of(const PageEntry& e, PageId id, const Grid& grid) {
  const Vec3d centre = grid.origin + vec_cast<double>(e.bound.centre) * grid.step;
  return {{"page", id},
          {"round", e.round},
          {"offset", e.block.offset},
          {"bytes", e.block.bytes},
          {"checksum", fmt::format("{:016x}", e.block.checksum)},
          {"vertices", e.vertices},
          {"triangles", e.triangles},
          {"owned_vertices", e.owned_vertices},
          {"owned_triangles", e.owned_triangles},
          {"least_error", static_cast<double>(decode_error(e.least_error)) * grid.step},
          {"largest_error", static_cast<double>(decode_error(e.largest_error)) * grid.step},
          {"centre", json_of(centre)},
          {"radius", static_cast<double>(e.bound.radius) * grid.step},
          {"coarser", e.coarser}};
}

ordered_json json_of(const Round& r, std::size_t number) {
  return {{"round", number},
          {"pages", r.pages},
          {"triangles", r.triangles},
          {"owned_triangles", r.owned_triangles},
          {"bytes", r.bytes},
          {"least_error", r.least_error},
          {"largest_error", r.largest_error}};
}

/// The metadata as JSON; as a string where a hand-made file holds something else.
ordered_json metadata_of(const Directory& d) {
  ordered_json json = ordered_json::parse(d.metadata, nullptr, false);
  return json.is_discarded() ? ordered_json(d.metadata) : json;
}

std::string dump(const ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, ordered_json::error_handler_t::replace);
}

std::string json_text(const CuestaFile& file, bool pages) {
  const Directory& d = file.directory();
  const Box3d box = world_box(d);
  ordered_json json;
  json["file"] = file.path().string();
  json["file_bytes"] = file.file_bytes();
  json["triangles"] = d.triangles;
  json["vertices"] = d.vertices;
  json["bounds"] = {{"lo", json_of(box.lo)}, {"hi", json_of(box.hi)}};
  json["grid"] = {{"origin", json_of(d.grid.origin)}, {"step", d.grid.step}};
  json["snapping_error"] = snapping_error(d);
  json["attributes"] = {
      {"normals", d.has_normals}, {"colours", d.has_colours}, {"texcoords", d.has_texcoords}};
  json["page_count"] = d.pages.size();
  json["rounds"] = ordered_json::array();
  const auto rounds = rounds_of(d);
  for (std::size_t r = 0; r < rounds.size(); ++r) json["rounds"].push_back(json_of(rounds[r], r));
  if (pages) json["pages"] = ordered_json::array();
  for (PageId id = 0; pages && id < d.pages.size(); ++id)
    json["pages"].push_back(json_of(d.pages[id], id, d.grid));
  json["metadata"] = metadata_of(d);
  return dump(json, 2) + "\n";
}

void print_rounds(const Directory& d) {
  fmt::print("\n{:>6}{:>8}{:>14}{:>14}{:>12}{:>14}{:>14}\n", "round", "pages", "triangles", "removed",
             "bytes", "least error", "largest error");
  const auto rounds = rounds_of(d);
  for (std::size_t r = 0; r < rounds.size(); ++r)
    fmt::print("{:>6}{:>8}{:>14}{:>14}{:>12}{:>14.4g}{:>14.4g}\n", r, rounds[r].pages,
               with_commas(rounds[r].triangles), with_commas(rounds[r].owned_triangles),
               byte_count(rounds[r].bytes), rounds[r].least_error, rounds[r].largest_error);
}

void print_pages(const Directory& d) {
  fmt::print("\n{:>6}{:>6}{:>13}{:>10}{:>10}{:>10}{:>13}{:>13}  coarser pages\n", "page", "round", "offset",
             "bytes", "vertices", "triangles", "largest err", "radius");
  for (PageId id = 0; id < d.pages.size(); ++id) {
    const PageEntry& e = d.pages[id];
    fmt::print("{:>6}{:>6}{:>13}{:>10}{:>10}{:>10}{:>13.4g}{:>13.4g}  {}\n", id, e.round, e.block.offset,
               e.block.bytes, e.vertices, e.triangles,
               static_cast<double>(decode_error(e.largest_error)) * d.grid.step,
               static_cast<double>(e.bound.radius) * d.grid.step, fmt::join(e.coarser, " "));
  }
}

std::string attribute_words(const Directory& d) {
  std::string words = "positions";
  if (d.has_normals) words += ", normals";
  if (d.has_colours) words += ", colours";
  return d.has_texcoords ? words + ", texture coordinates" : words;
}

void print_text(const CuestaFile& file, bool pages) {
  const Directory& d = file.directory();
  const Box3d box = world_box(d);
  fmt::print("{}: {}\n", file.path().string(), byte_count(file.file_bytes()));
  fmt::print("  surface     {} triangles, {} vertices\n", with_commas(d.triangles), with_commas(d.vertices));
  fmt::print("  attributes  {}\n", attribute_words(d));
  fmt::print("  bounds      {:.6g} {:.6g} {:.6g} to {:.6g} {:.6g} {:.6g}\n", box.lo.x, box.lo.y, box.lo.z,
             box.hi.x, box.hi.y, box.hi.z);
  fmt::print("  grid step   {:.6g}: vertices are within {:.3g} of where they were\n", d.grid.step,
             snapping_error(d));
  print_rounds(d);
  if (pages) print_pages(d);
  fmt::print("\nmetadata: {}\n", dump(metadata_of(d), 2));
}

}  // namespace

Result<void> run_info(const InfoSettings& settings) {
  const auto file = CuestaFile::open(settings.file);
  if (!file) return fail(file.error());
  if (settings.json)
    fmt::print("{}", json_text(*file, settings.pages));
  else
    print_text(*file, settings.pages);
  return {};
}

}  // namespace cuesta::app
