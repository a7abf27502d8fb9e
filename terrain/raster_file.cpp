#include "terrain/raster_file.h"

#include <fmt/format.h>
#include <zip.h>

#include <array>
#include <memory>
#include <optional>

#include "ooc/read_job.h"
#include "ooc/temp_file.h"
#include "ooc/unpacked_file.h"

namespace cuesta {
namespace {

struct CloseZip {
  void operator()(zip_t* zip) const { zip_discard(zip); }
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using Zip = std::unique_ptr<zip_t, CloseZip>;
using ZipFile = std::unique_ptr<zip_file_t, CloseZip>;

/// What an unpacker of Apple's adds, and folders.
bool is_ballast(std::string_view name) {
  return name.ends_with('/') || name.starts_with("__MACOSX/") || name.starts_with('.') ||
         name.find("/.") != name.npos;
}

Result<Zip> open_zip(const std::filesystem::path& path) {
  int code = 0;
  Zip zip(zip_open(path.c_str(), ZIP_RDONLY, &code));
  if (zip) return zip;
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  return fail(ErrorCode::corrupt, path.string(), "", "not a zip that can be read: " + text);
}

/// The only member that is data. @return its number and name
Result<std::pair<zip_uint64_t, std::string>> only_member(zip_t* zip, const std::filesystem::path& path) {
  std::optional<std::pair<zip_uint64_t, std::string>> found;
  const zip_int64_t count = zip_get_num_entries(zip, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* raw = zip_get_name(zip, static_cast<zip_uint64_t>(i), 0);
    const std::string name = raw ? raw : "";
    if (name.empty() || is_ballast(name)) continue;
    if (found)
      return fail(ErrorCode::invalid_input, path.string(), "",
                  fmt::format("a zip of several files ({} and {}, …); unpack it and name the raster",
                              quote_word(found->second), quote_word(name)));
    found.emplace(static_cast<zip_uint64_t>(i), name);
  }
  if (!found) return fail(ErrorCode::invalid_input, path.string(), "", "a zip without a file in it");
  return *found;
}

Result<MappedFile> unpack_member(zip_t* zip, zip_uint64_t number, const std::filesystem::path& path,
                                 std::uint64_t packed_bytes, const std::filesystem::path& temp) {
  auto file = TempFile::create(temp);
  if (!file) return fail(file.error());
  const ZipFile member(zip_fopen_index(zip, number, 0));
  if (!member)
    return fail(ErrorCode::corrupt, path.string(), "", std::string("cannot unpack: ") + zip_strerror(zip));
  std::vector<char> block(std::size_t{1} << 16);
  for (;;) {
    const zip_int64_t got = zip_fread(member.get(), block.data(), block.size());
    if (got < 0)
      return fail(ErrorCode::corrupt, path.string(),
                  fmt::format("byte {} of the unpacked file", file->bytes_written()),
                  std::string("cannot unpack: ") + zip_file_strerror(member.get()));
    if (got == 0) break;
    CUESTA_TRY(file->write({block.data(), static_cast<std::size_t>(got)}));
    if (auto r = check_ratio(packed_bytes, file->bytes_written(), {}); !r) {
      Error error = std::move(r).error();
      error.file = path.string();
      return fail(std::move(error));
    }
  }
  return file->map();
}

Result<RasterFile> unzip(RasterFile packed, const std::filesystem::path& temp) {
  auto zip = open_zip(packed.path);
  if (!zip) return fail(std::move(zip).error());
  const auto member = only_member(zip->get(), packed.path);
  if (!member) return fail(member.error());
  auto map = unpack_member(zip->get(), member->first, packed.path, packed.size(), temp);
  if (!map) return fail(std::move(map).error());
  const std::string inner = std::filesystem::path(member->second).filename().string();
  return RasterFile{std::move(packed.path), inner, true, std::move(*map)};
}

}  // namespace

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
  if (file.begins_with("PK\x03\x04") || file.begins_with("PK\x05\x06")) return unzip(std::move(file), temp);
  const Compression compression = compression_of(file.map.bytes());
  if (compression == Compression::none) return file;
  auto unpacked = unpack_file(path, file.map.bytes(), compression, temp, {}, {});
  if (!unpacked) return fail(std::move(unpacked).error());
  return RasterFile{path, name_inside(path).filename().string(), true, std::move(*unpacked)};
}

}  // namespace cuesta
