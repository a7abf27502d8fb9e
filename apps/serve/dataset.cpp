#include "apps/serve/dataset.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "apps/overview/file_facts.h"
#include "apps/serve/target.h"
#include "apps/tiles/terrain_pyramid.h"
#include "hierarchy/cuesta_file.h"
#include "hierarchy/scene_file.h"
#include "ooc/fingerprint.h"

namespace cuesta::serve {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t most_attribution = 4096;

std::string attribution_beside(const FoundFile& found) {
  const std::string name =
      found.in_folder.substr(0, found.in_folder.size() - dataset_suffix.size()) + ".attribution";
  const Descriptor file(::openat(found.folder, name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status {};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  std::array<char, most_attribution> text;
  const ssize_t got = ::read(file.get(), text.data(), text.size());
  const std::string_view words(text.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
  const auto end = words.find_last_not_of(" \r\n\t");
  return std::string(words.substr(0, end == words.npos ? 0 : end + 1));
}

std::string attribution_of(const ordered_json& metadata, const FoundFile& found) {
  const auto at = metadata.is_object() ? metadata.find("attribution") : metadata.end();
  return at != metadata.end() && at->is_string() ? at->get<std::string>() : attribution_beside(found);
}

/// Changes with any byte of the file, as far as its checksums tell.
Result<std::string> content_tag(const Descriptor& file, const FoundFile& found) {
  std::array<std::byte, container_header_bytes> header{};
  if (::pread(file.get(), header.data(), header.size(), 0) != static_cast<ssize_t>(header.size()))
    return fail(ErrorCode::io, found.name, "byte 0", "the header cannot be read");
  return fmt::format("{:016x}-{:x}", checksum(header), found.stamp.bytes);
}

ordered_json common_json(const Dataset& set) {
  const std::string place = escaped_path(set.name);
  return {{"name", set.name},
          {"kind", set.is_scene ? "scene" : "surface"},
          {"data", fmt::format("/data/{}.cuesta", place)},
          {"data_immutable", fmt::format("/data/{}.cuesta?v={}", place, set.version())},
          {"etag", set.file->etag},
          {"file_bytes", set.file->bytes()},
          {"attribution", set.attribution}};
}

std::string thumbnail_of(const Dataset& set) {
  return fmt::format("/thumbnail/{}.png", escaped_path(set.name));
}

void tell_surface(Dataset& set, const Directory& d, const FoundFile& found) {
  const ordered_json metadata = app::metadata_of(d);
  set.triangles = d.triangles;
  set.vertices = d.vertices;
  set.box = app::world_box(d);
  set.is_terrain = metadata.is_object() && metadata.contains("terrain");
  set.is_on_earth = tiles::TerrainPyramid::is_possible(d);
  set.attribution = attribution_of(metadata, found);
  ordered_json json = common_json(set);
  json["thumbnail"] = thumbnail_of(set);
  json["session"] = fmt::format("/session/{}", escaped_path(set.name));
  if (set.has_tiles(TileKind::tiles_3d))
    json["tiles"] = fmt::format("/tiles/{}/tileset.json", escaped_path(set.name));
  if (set.has_tiles(TileKind::terrain))
    json["terrain_tiles"] = fmt::format("/terrain/{}/layer.json", escaped_path(set.name));
  json["terrain"] = set.is_terrain;
  json.update(app::directory_json(d));
  ordered_json brief = json;
  brief.erase("rounds");
  set.brief_json = app::json_text(brief, -1);
  json["metadata"] = metadata;
  set.json = app::json_text(json, -1);
}

void tell_scene(Dataset& set, const SceneFile& scene, const FoundFile& found) {
  const ordered_json metadata = app::metadata_of(scene.directory().metadata);
  set.is_scene = true;
  if (const Box3d box = world_box(scene.directory()); !box.empty()) set.box = box;
  set.attribution = attribution_of(metadata, found);
  for (const ScenePartEntry& p : scene.parts()) set.triangles += p.triangles, set.vertices += p.vertices;
  ordered_json json = common_json(set);
  json["thumbnail"] = thumbnail_of(set);
  json["triangles"] = set.triangles;
  json["vertices"] = set.vertices;
  json["bounds"] = {{"lo", app::vector_json(set.box.lo)}, {"hi", app::vector_json(set.box.hi)}};
  json["parts"] = scene.parts().size();
  json["instances"] = scene.instances().size();
  json["whole"] = scene.is_whole();
  set.brief_json = app::json_text(json, -1);
  json["metadata"] = metadata;
  set.json = app::json_text(json, -1);
}

Result<void> tell(Dataset& set, ContainerKind kind, const std::filesystem::path& path,
                  const FoundFile& found) {
  if (kind == ContainerKind::scene) {
    const auto scene = SceneFile::open(path);
    if (!scene) return fail(scene.error());
    tell_scene(set, *scene, found);
  } else {
    const auto surface = CuestaFile::open(path);
    if (!surface) return fail(surface.error());
    tell_surface(set, surface->directory(), found);
  }
  return {};
}

}  // namespace

Result<Dataset> open_dataset(const FoundFile& found) {
  Descriptor descriptor = found.open();
  if (!descriptor.is_open()) return fail(ErrorCode::not_found, found.name, "", "the file went away");
  const auto named = [&found](Error error) {
    error.file = found.name;
    return fail(std::move(error));
  };
  const std::filesystem::path path = descriptor.path();
  const auto kind = ContainerReader::kind_of(path);
  if (!kind) return named(kind.error());
  const auto tag = content_tag(descriptor, found);
  if (!tag) return fail(tag.error());
  Dataset set;
  set.name = found.name.substr(0, found.name.size() - dataset_suffix.size());
  set.file = std::make_shared<const ServedFile>(
      make_served_file(std::move(descriptor), found.stamp, *tag, "application/vnd.cuesta"));
  if (auto told = tell(set, *kind, path, found); !told) return named(told.error());
  return set;
}

}  // namespace cuesta::serve
