#include "terrain/raster_file.h"

#include <fmt/format.h>

#include "ooc/read_job.h"
#include "ooc/unpacked_file.h"
#include "ooc/zip_member.h"

namespace cuesta {
Result<void> RasterFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  if (offset > size() || bytes.size() > size() - offset)
    return error(ErrorCode::corrupt, fmt::format("byte {}", offset),
                 fmt::format("expected {} bytes, the file ends at {}", bytes.size(), size()));
  auto r = map.read(offset, {reinterpret_cast<char*>(bytes.data()), bytes.size()});
  if (r) return {};
  Error wrong = std::move(r).error();
  if (wrong.file.empty()) wrong.file = path.string();
  return fail(std::move(wrong));
}

Result<RasterFile> open_raster_file(const std::filesystem::path& path, const std::filesystem::path& temp) {
  auto map = MappedFile::open(path);
  if (!map) return fail(std::move(map).error());
  RasterFile file{path, path.filename().string(), false, std::move(*map)};
  const Compression compression = compression_of(file.map.bytes());
  if (compression == Compression::none) return file;
  auto unpacked = unpack_file(path, file.map.bytes(), compression, temp, {}, {});
  if (!unpacked) return fail(std::move(unpacked).error());
  std::filesystem::path inside = name_inside(path);
  if (compression == Compression::zip) inside = *zip_member_name(file.map.bytes());
  return RasterFile{path, inside.filename().string(), true, std::move(*unpacked)};
}

}  // namespace cuesta
