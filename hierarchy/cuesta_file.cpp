#include "hierarchy/cuesta_file.h"

#include <string>

#include "hierarchy/page_codec.h"
#include "ooc/check.h"

namespace cuesta {
namespace {

bool matches(const Page& page, const PageEntry& e, bool base) {
  return page.round == e.round && page.base == base && page.vertex_count == e.vertices &&
         page.triangles.size() == e.triangles && page.owned.positions.size() == e.owned_vertices;
}

}  // namespace

Result<CuestaFile> CuestaFile::open(const std::filesystem::path& path) {
  return open(ContainerReader::open(path, ContainerKind::surface));
}

Result<CuestaFile> CuestaFile::open(std::shared_ptr<const ByteSource> source) {
  return open(ContainerReader::open(std::move(source), ContainerKind::surface));
}

Result<CuestaFile> CuestaFile::open(Result<ContainerReader> container) {
  if (!container) return fail(container.error());
  const auto bytes = container->read(container->directory());
  if (!bytes) return fail(bytes.error());
  auto directory = decode_directory(*bytes);
  if (!directory) {
    directory.error().file = container->path().string();
    return fail(directory.error());
  }
  return CuestaFile(std::make_shared<const ContainerReader>(std::move(*container)), std::move(*directory),
                    "");
}

CuestaFile::CuestaFile(std::shared_ptr<const ContainerReader> container, Directory directory,
                       std::string place)
    : container_(std::move(container)), directory_(std::move(directory)), place_(std::move(place)) {}

Result<Page> CuestaFile::read_page(PageId id, std::span<const Vec3i> survivors) const {
  CUESTA_CHECK(id < directory_.pages.size(), id);
  const PageEntry& entry = directory_.pages[id];
  const auto at_page = [&](Error error) {
    error.file = path().string();
    error.place = (place_.empty() ? "" : place_ + ", ") + "page " + std::to_string(id) +
                  (error.place.empty() ? "" : ", " + error.place);
    return fail(std::move(error));
  };
  const auto bytes = container_->read(entry.block);
  if (!bytes) return at_page(bytes.error());
  auto page = decode_page(*bytes, survivors);
  if (!page) return at_page(page.error());
  if (!matches(*page, entry, id == directory_.base()))
    return at_page({ErrorCode::corrupt, "", "", "the page contradicts its directory entry"});
  return page;
}

Result<std::shared_ptr<const Page>> CuestaFile::shared_page(PageId id,
                                                            std::span<const Vec3i> survivors) const {
  const auto read = [&]() -> Result<std::shared_ptr<const Page>> {
    auto page = read_page(id, survivors);
    if (!page) return fail(page.error());
    return std::make_shared<const Page>(std::move(*page));
  };
  return shelf_ ? shelf_->take(id, read) : read();
}

}  // namespace cuesta
