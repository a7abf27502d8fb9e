#pragma once
/// gzip, Zstandard and xz streams (RFC 1952, RFC 8878, xz-file-format 1.1) and zip archives of one file,
/// unpacked block by block: checksums, members, limits against bombs.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "ooc/result.h"

namespace cuesta {

enum class Compression : std::uint8_t { none, gzip, zstd, xz, zip };

/// By the first bytes alone; a Zstandard stream may begin with a skippable frame (pzstd writes one).
Compression compression_of(std::span<const char> bytes);
/// "gzip", "zstd", "xz", "zip"; "none".
std::string_view name(Compression compression);

/// A stream is refused once its output is larger than both bounds. gzip itself reaches 1032:1, on zeros only;
/// meshes reach 20:1 or so.
struct UnpackLimits {
  std::uint64_t memory_bytes =
      std::uint64_t{160}
      << 20;  ///< for the decoder: a Zstandard window is at most 128 MiB, one of xz -9 is 64
  std::uint64_t always_allowed_bytes = std::uint64_t{1} << 30;
  std::uint64_t most_ratio = 1000;
};

/// Receives the output in order, at most 2^18 bytes at a time.
/// @param bytes_in  how much of the input has been used up. An error ends the work with that error.
using UnpackSink = std::function<Result<void>(std::span<const char> block, std::uint64_t bytes_in)>;

/// Unpacks the whole of `bytes`: gzip with any number of members, Zstandard with any number of frames,
/// xz with any number of streams, a zip's only member (zip_member.h); checksums verified where there are any.
/// Zeros after a gzip stream are padding.
/// @pre compression is not none.
/// @error corrupt with the byte of the input: damaged, or it ends too early; out_of_budget: a bomb, or a
/// window that does not fit `memory_bytes`; what the sink returned. The error's file is empty.
/// @cost memory: 2^18 bytes and the decoder's window (gzip 64 KiB).
Result<void> unpack(std::span<const char> bytes, Compression compression, const UnpackLimits& limits,
                    const UnpackSink& sink);

/// What the stream says it unpacks to, where its head says so (Zstandard; one frame of perhaps several). May
/// lie.
std::optional<std::uint64_t> declared_size(std::span<const char> bytes, Compression compression);

/// @error out_of_budget when `bytes_out` from `bytes_in` is what `limits` call a bomb.
Result<void> check_ratio(std::uint64_t bytes_in, std::uint64_t bytes_out, const UnpackLimits& limits);

}  // namespace cuesta
