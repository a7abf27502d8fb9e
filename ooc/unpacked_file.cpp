#include "ooc/unpacked_file.h"

#include <cctype>
#include <string>

#include "ooc/temp_file.h"

namespace cuesta {
namespace {

Result<TempFile> unpack_to_temp(std::span<const char> bytes, Compression compression,
                                const std::filesystem::path& folder, const UnpackLimits& limits,
                                const UnpackProgress& progress) {
  const std::uint64_t declared = declared_size(bytes, compression).value_or(0);
  if (auto r = check_ratio(bytes.size(), declared, limits); !r) return fail(r.error());
  auto file = TempFile::create(folder);
  if (!file) return file;
  if (auto r = file->expect(declared); !r) return fail(r.error());
  const auto done = unpack(bytes, compression, limits,
                           [&](std::span<const char> block, std::uint64_t bytes_in) -> Result<void> {
                             if (progress && !progress(bytes_in))
                               return fail(ErrorCode::cancelled, "", "", "unpacking was cancelled");
                             return file->write(block);
                           });
  if (!done) return fail(done.error());
  return file;
}

}  // namespace

std::filesystem::path name_inside(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const bool is_packed =
      extension == ".gz" || extension == ".zst" || extension == ".xz" || extension == ".zip";
  return is_packed ? path.stem() : path;
}

Result<MappedFile> unpack_file(const std::filesystem::path& path, std::span<const char> bytes,
                               Compression compression, const std::filesystem::path& folder,
                               const UnpackLimits& limits, const UnpackProgress& progress) {
  auto file = unpack_to_temp(bytes, compression, folder, limits, progress);
  if (!file) {
    Error error = std::move(file).error();
    if (error.file.empty()) error.file = path.string();
    return fail(std::move(error));
  }
  return file->map();
}

}  // namespace cuesta
