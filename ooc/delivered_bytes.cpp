#include "ooc/delivered_bytes.h"

#include <cstring>

namespace cuesta {

/// The nearest piece that begins at or before the range is the one that counts: pieces are few and do not
/// overlap.
const std::byte* DeliveredBytes::piece_with(ByteRange range) const {
  auto after = pieces_.upper_bound(range.offset);
  if (after == pieces_.begin()) return nullptr;
  const auto& [begin, bytes] = *--after;
  const std::uint64_t skip = range.offset - begin;
  if (skip > bytes.size() || range.bytes > bytes.size() - skip) return nullptr;
  return bytes.data() + skip;
}

Result<void> DeliveredBytes::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  const ByteRange range{offset, bytes.size()};
  const std::byte* const from = piece_with(range);
  missing_ = from ? std::nullopt : std::optional(range);
  if (!from)
    return fail(ErrorCode::io, path().string(), at_byte(offset),
                std::to_string(bytes.size()) + " bytes have not been delivered");
  if (!bytes.empty()) std::memcpy(bytes.data(), from, bytes.size());
  return {};
}

}  // namespace cuesta
