/// gzip and Zstandard streams of hostile bytes, with a small window and a small limit.

#include <cstdlib>

#include "ooc/compressed_stream.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const char> bytes(reinterpret_cast<const char*>(data), size);
  const auto compression = cuesta::compression_of(bytes);
  if (compression == cuesta::Compression::none) return 0;
  cuesta::UnpackLimits limits{std::uint64_t{1} << 20, std::uint64_t{1} << 22, 100};
  std::uint64_t total = 0;
  const auto done =
      cuesta::unpack(bytes, compression, limits, [&](std::span<const char> block, std::uint64_t in) {
        total += block.size();
        if (in > size) std::abort();
        return cuesta::Result<void>{};
      });
  if (!done && done.error().message.empty()) std::abort();
  if (total > limits.always_allowed_bytes + (1 << 18) && total / 100 > size + (1 << 18)) std::abort();
  return 0;
}
