#include "hierarchy/scene_file.h"

#include <string>

#include "ooc/check.h"

namespace cuesta {
namespace {

tl::unexpected<Error> at_part(Error error, std::uint32_t part, const std::string& more) {
  const std::string place = "part " + std::to_string(part) + more;
  error.place = error.place.empty() ? place : place + ", " + error.place;
  return fail(std::move(error));
}

/// From offsets as the part's directory has them to those in the file. False if a page lies elsewhere.
bool place_pages(const EmbeddedSurface& surface, Directory& directory) {
  for (PageEntry& page : directory.pages) {
    if (&page == &directory.pages.back()) {
      if (page.block.offset != 0 || page.block.bytes != surface.base.bytes) return false;
      page.block = surface.base;
      continue;
    }
    const BlockRef& block = page.block;
    if (block.offset > surface.pages_bytes || block.bytes > surface.pages_bytes - block.offset) return false;
    page.block.offset += surface.pages_offset;
  }
  return true;
}

}  // namespace

SceneFile::SceneFile(std::shared_ptr<const ContainerReader> container, SceneDirectory directory)
    : container_(std::move(container)),
      directory_(std::move(directory)),
      instances_(instances_of(directory_.scene)) {}

Result<SceneFile> SceneFile::open(const std::filesystem::path& path) {
  return open(ContainerReader::open(path, ContainerKind::scene));
}

Result<SceneFile> SceneFile::open(std::shared_ptr<const ByteSource> source) {
  return open(ContainerReader::open(std::move(source), ContainerKind::scene));
}

Result<SceneFile> SceneFile::open(Result<ContainerReader> container) {
  if (!container) return fail(container.error());
  const BlockRef& block = container->directory();
  const auto bytes = container->read(block);
  if (!bytes) return fail(bytes.error());
  auto directory = decode_scene_directory(*bytes, block.offset + block.bytes);
  if (!directory) {
    directory.error().file = container->path().string();
    return fail(directory.error());
  }
  if (lay_out(*directory, block.offset + block.bytes) != container->whole_bytes())
    return fail(ErrorCode::corrupt, container->path().string(), "directory",
                "its blocks do not add up to the file");
  return SceneFile(std::make_shared<const ContainerReader>(std::move(*container)), std::move(*directory));
}

std::uint32_t SceneFile::available_segments(std::uint32_t part) const {
  CUESTA_CHECK(part < directory_.parts.size(), part);
  const ScenePartEntry& entry = directory_.parts[part];
  const auto is_there = [this](const BlockRef& b) { return b.offset + b.bytes <= file_bytes(); };
  if (entry.surface) return is_there(entry.surface->base);
  std::uint32_t count = 0;
  while (count < entry.segments.size() && is_there(entry.segments[count].block)) ++count;
  return count;
}

Result<std::vector<std::byte>> SceneFile::read_segment(std::uint32_t part, std::uint32_t segment) const {
  CUESTA_CHECK(part < directory_.parts.size(), part);
  const auto& segments = directory_.parts[part].segments;
  CUESTA_CHECK(segment < segments.size(), part, segment);
  auto bytes = container_->read(segments[segment].block);
  if (!bytes) return at_part(std::move(bytes).error(), part, ", segment " + std::to_string(segment));
  return bytes;
}

Result<CuestaFile> SceneFile::open_surface(std::uint32_t part) const {
  CUESTA_CHECK(part < directory_.parts.size(), part);
  const ScenePartEntry& entry = directory_.parts[part];
  CUESTA_CHECK(entry.surface.has_value(), part);
  const auto bytes = container_->read(entry.surface->directory);
  if (!bytes) return at_part(bytes.error(), part, "");
  auto directory = decode_directory(*bytes);
  if (!directory) {
    directory.error().file = path().string();
    return at_part(std::move(directory).error(), part, "");
  }
  const bool agrees = directory->vertices == entry.vertices && directory->triangles == entry.triangles;
  if (!agrees || !place_pages(*entry.surface, *directory))
    return fail(ErrorCode::corrupt, path().string(), "part " + std::to_string(part),
                "its directory contradicts that of the scene");
  return CuestaFile(container_, std::move(*directory), "part " + std::to_string(part));
}

}  // namespace cuesta
