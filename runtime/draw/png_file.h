#pragma once
/// Pictures to and from PNG files.

#include <filesystem>

#include "ooc/result.h"
#include "runtime/draw/renderer.h"

namespace cuesta {

/// Written to a temporary name, then renamed. @error io.
Result<void> write_png(const std::filesystem::path& path, const Picture& picture);
/// @error not_found, corrupt; out_of_budget above 2^28 pixels.
Result<Picture> read_png(const std::filesystem::path& path);

}  // namespace cuesta
