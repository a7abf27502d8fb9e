#pragma once
/// A zip archive of one file, as people pack a single mesh or raster.

#include <functional>
#include <span>
#include <string>

#include "ooc/result.h"

namespace cuesta {

/// By the first bytes: an archive, also an empty one.
bool is_zip(std::span<const char> bytes);

/// Name of the only member that is no folder and none of the files that file managers add.
/// @error corrupt: damaged; invalid_input: none, or several. The error's file is empty.
Result<std::string> zip_member_name(std::span<const char> bytes);

/// Unpacks that member, at most 2^16 bytes at a time.
/// @param sink  also gets how much of `bytes` has been used up, about
/// @error as zip_member_name(); corrupt: the data or their checksum; what the sink returned
Result<void> unpack_zip(
    std::span<const char> bytes,
    const std::function<Result<void>(std::span<const char> block, std::uint64_t bytes_in)>& sink);

}  // namespace cuesta
