#pragma once
/// Pictures to and from PNG files.

#include <filesystem>
#include <string>

#include "ooc/result.h"
#include "runtime/draw/picture.h"

namespace cuesta {

/// The bytes of a PNG file of 8-bit RGBA with an sRGB chunk.
/// @pre   picture has at least one pixel.   @error io.
Result<std::string> encode_png(const Picture& picture);

/// Writes 8-bit RGBA with an sRGB chunk, to a temporary name that is then renamed.
/// @pre   picture has at least one pixel.   @error io.
Result<void> write_png(const std::filesystem::path& path, const Picture& picture);

/// Reads any PNG; grey, palette, 16-bit and images without alpha become 8-bit sRGB RGBA. What write_png wrote
/// comes back exactly.
/// @error not_found, io, corrupt (also when cut short anywhere); out_of_budget above 2^28 pixels.
Result<Picture> read_png(const std::filesystem::path& path);

}  // namespace cuesta
