#include "apps/cuesta/info_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/cuesta/scene_info.h"
#include "apps/cuesta/text_forms.h"
#include "apps/overview/file_facts.h"
#include "hierarchy/cuesta_file.h"
#include "hierarchy/page_codec.h"

namespace cuesta::app {
namespace {

using nlohmann::ordered_json;

/// What a file's bytes are spent on. Reads all of it.
struct Spent {
  PageStreamBytes streams{};
  std::uint64_t directory = 0;
  std::uint64_t rest = 0;  ///< header, the pages' counts, alignment
};

Result<Spent> spent_in(const CuestaFile& file) {
  const auto container = ContainerReader::open(file.path(), ContainerKind::surface);
  if (!container) return fail(container.error());
  Spent spent;
  spent.directory = container->directory().bytes;
  spent.rest = file.file_bytes() - spent.directory;
  for (PageId id = 0; id < file.directory().pages.size(); ++id) {
    const auto bytes = container->read(file.directory().pages[id].block);
    if (!bytes) return fail(bytes.error());
    auto streams = bytes_per_stream(*bytes);
    if (!streams) {
      streams.error().file = file.path().string();
      streams.error().place = "page " + std::to_string(id);
      return fail(streams.error());
    }
    for (std::size_t s = 0; s < page_stream_count; ++s) {
      spent.streams[s] += (*streams)[s];
      spent.rest -= (*streams)[s];
    }
  }
  return spent;
}

/// Name and bytes of everything that has any.
std::vector<std::pair<std::string, std::uint64_t>> rows_of(const Spent& spent) {
  std::vector<std::pair<std::string, std::uint64_t>> rows;
  for (std::size_t s = 0; s < page_stream_count; ++s)
    rows.emplace_back(name(static_cast<PageStream>(s)), spent.streams[s]);
  rows.emplace_back("directory", spent.directory);
  rows.emplace_back("headers, gaps", spent.rest);
  std::erase_if(rows, [](const auto& row) { return row.second == 0; });
  return rows;
}

double per_triangle(std::uint64_t bytes, const Directory& d) {
  return d.triangles == 0 ? 0 : static_cast<double>(bytes) / static_cast<double>(d.triangles);
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
          {"centre", vector_json(centre)},
          {"radius", static_cast<double>(e.bound.radius) * grid.step},
          {"coarser", e.coarser}};
}

std::string facts_text(const CuestaFile& file, const Spent& spent, bool pages) {
  const Directory& d = file.directory();
  ordered_json json;
  json["file"] = file.path().string();
  json["file_bytes"] = file.file_bytes();
  json.update(directory_json(d));
  for (const auto& [what, bytes] : rows_of(spent))
    json["bytes"][what] = {{"bytes", bytes}, {"per_triangle", per_triangle(bytes, d)}};
  if (pages) json["pages"] = ordered_json::array();
  for (PageId id = 0; pages && id < d.pages.size(); ++id)
    json["pages"].push_back(json_of(d.pages[id], id, d.grid));
  json["metadata"] = metadata_of(d);
  return json_text(json, 2) + "\n";
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

void print_spent(const CuestaFile& file, const Spent& spent) {
  const Directory& d = file.directory();
  fmt::print("\n{:<18}{:>14}{:>14}\n", "spent on", "bytes", "per triangle");
  for (const auto& [what, bytes] : rows_of(spent))
    fmt::print("{:<18}{:>14}{:>14.3f}\n", what, with_commas(bytes), per_triangle(bytes, d));
  fmt::print("{:<18}{:>14}{:>14.3f}\n", "total", with_commas(file.file_bytes()),
             per_triangle(file.file_bytes(), d));
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

void print_text(const CuestaFile& file, const Spent& spent, bool pages) {
  const Directory& d = file.directory();
  const Box3d box = world_box(d);
  fmt::print("{}: {}\n", file.path().string(), byte_count(file.file_bytes()));
  fmt::print("  surface     {} triangles, {} vertices\n", with_commas(d.triangles), with_commas(d.vertices));
  fmt::print("  attributes  {}\n", attribute_words(d));
  fmt::print("  bounds      {:.6g} {:.6g} {:.6g} to {:.6g} {:.6g} {:.6g}\n", box.lo.x, box.lo.y, box.lo.z,
             box.hi.x, box.hi.y, box.hi.z);
  fmt::print("  grid step   {:.6g}: vertices are within {:.3g} of where they were\n", d.grid.step,
             snapping_error(d));
  fmt::print("  errors      0, or at least {:.3g}\n", least_error(d));
  print_rounds(d);
  print_spent(file, spent);
  if (pages) print_pages(d);
  fmt::print("\nmetadata: {}\n", json_text(metadata_of(d), 2));
}

}  // namespace

Result<void> run_info(const InfoSettings& settings) {
  const auto kind = ContainerReader::kind_of(settings.file);
  if (!kind) return fail(kind.error());
  if (*kind == ContainerKind::scene) return run_scene_info(settings);
  const auto file = CuestaFile::open(settings.file);
  if (!file) return fail(file.error());
  const auto spent = spent_in(*file);
  if (!spent) return fail(spent.error());
  if (settings.json)
    fmt::print("{}", facts_text(*file, *spent, settings.pages));
  else
    print_text(*file, *spent, settings.pages);
  return {};
}

}  // namespace cuesta::app
