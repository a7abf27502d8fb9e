#include "hierarchy/scene_writer.h"

#include "hierarchy/cuesta_file.h"
#include "ooc/check.h"
#include "ooc/container_file.h"

namespace cuesta {
namespace {

/// Pages of a surface but the base page, from coarse to fine, to where they are in its directory.
Result<void> write_pages(const std::filesystem::path& path, const EmbeddedSurface& surface,
                         ContainerWriter& writer) {
  const auto file = CuestaFile::open(path);
  if (!file) return fail(file.error());
  const auto container = ContainerReader::open(path, ContainerKind::surface);
  if (!container) return fail(container.error());
  const auto& pages = file->directory().pages;
  for (std::size_t i = pages.size() - 1; i-- > 0;) {
    const auto bytes = container->read(pages[i].block);
    if (!bytes) return fail(bytes.error());
    if (auto r = writer.append(*bytes); !r) return fail(r.error());
  }
  CUESTA_CHECK(pages.size() == 1 || writer.bytes_written() == surface.pages_offset + surface.pages_bytes);
  return {};
}

}  // namespace

Result<SceneWritten> write_scene(const std::filesystem::path& path, const SceneDirectory& directory,
                                 const SceneParts& parts) {
  auto writer = ContainerWriter::create(path, ContainerKind::scene);
  if (!writer) return fail(writer.error());
  const auto head = writer->append(encode_scene_directory(directory));
  if (!head) return fail(head.error());
  SceneDirectory placed = directory, stored = directory;
  lay_out(placed, writer->bytes_written());
  const auto from = blocks_in_order(stored), to = blocks_in_order(placed);
  const std::uint64_t coarsest = coarsest_blocks(directory);
  SceneWritten written;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto bytes = parts.read(*from[i]);
    if (!bytes) return fail(bytes.error());
    const auto block = writer->append(*bytes);
    if (!block) return fail(block.error());
    CUESTA_CHECK(*block == *to[i], i);
    if (i + 1 == coarsest) written.coarsest_bytes = writer->bytes_written();
  }
  std::uint64_t surface = 0;
  for (const ScenePartEntry& part : placed.parts)
    if (part.surface)
      if (auto r = write_pages(parts.surface_path(surface++), *part.surface, *writer); !r)
        return fail(r.error());
  if (auto r = writer->finish(*head); !r) return fail(r.error());
  written.file_bytes = writer->bytes_written();
  return written;
}

}  // namespace cuesta
