#pragma once
/// A compressed file as if it were not: unpacked to a file without a name, and that one mapped.

#include <filesystem>
#include <functional>
#include <span>

#include "ooc/compressed_stream.h"
#include "ooc/mapped_file.h"

namespace cuesta {

/// Bytes of the input used up; returning false cancels.
using UnpackProgress = std::function<bool(std::uint64_t bytes_in)>;

/// "scan.ply" of "scan.ply.gz"; `path` itself if it does not end in .gz, .zst, .xz or .zip (any case).
std::filesystem::path name_inside(const std::filesystem::path& path);

/// @param path  for messages. @param bytes the compressed file. @param folder as for temp_folder().
/// @error as unpack() with `path` as the file; of TempFile; cancelled.
/// @cost disk: what comes out, at most limits.most_ratio times what goes in or limits.always_allowed_bytes.
Result<MappedFile> unpack_file(const std::filesystem::path& path, std::span<const char> bytes,
                               Compression compression, const std::filesystem::path& folder,
                               const UnpackLimits& limits, const UnpackProgress& progress);

}  // namespace cuesta
