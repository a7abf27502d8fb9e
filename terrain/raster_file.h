#pragma once
/// The file that a raster is read from, unpacked if it was compressed.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "ooc/mapped_file.h"
#include "ooc/result.h"

namespace cuesta {

struct RasterFile {
  std::filesystem::path path;  ///< as the user gave it
  std::string inner_name =
      {};                    ///< "N00E011.hgt": of the member of a zip; without .gz or .zst; else of `path`
  bool is_unpacked = false;  ///< `map` is a temporary file without a name
  MappedFile map = {};

  std::uint64_t size() const { return map.bytes().size(); }
  std::string_view text() const { return {map.bytes().data(), map.bytes().size()}; }
  bool begins_with(std::string_view magic) const { return text().starts_with(magic); }
  /// Copies without bringing pages of the map in. Concurrent. @error io; corrupt beyond the end
  Result<void> read(std::uint64_t offset, std::span<std::byte> bytes) const;
  tl::unexpected<Error> error(ErrorCode code, std::string place, std::string message) const {
    return fail(code, path.string(), std::move(place), std::move(message));
  }
};

/// Opens `path`; unpacks gzip, Zstandard, and a zip with one member, all told by their first bytes.
/// @param temp  as for temp_folder(). @error of MappedFile::open() and unpack_file(); invalid_input: a zip
/// with no member or several; corrupt: a damaged zip.
Result<RasterFile> open_raster_file(const std::filesystem::path& path, const std::filesystem::path& temp);

}  // namespace cuesta
