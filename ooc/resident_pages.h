#pragma once
/// Pages of a file that a library has mapped, given back to the system as they are used up.

#include <filesystem>

namespace cuesta {

/// Takes the pages of every read-only map of `path` in this process out of its resident memory. They come
/// back from the page cache, or the disk, when they are touched. Does nothing where /proc is not there.
void forget_resident_pages(const std::filesystem::path& path);

}  // namespace cuesta
