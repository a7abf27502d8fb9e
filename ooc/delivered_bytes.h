#pragma once
/// A file whose bytes come piece by piece from outside, as the answers to range requests do.

#include <map>
#include <optional>
#include <vector>

#include "ooc/byte_source.h"

namespace cuesta {

struct ByteRange {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;

  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

/// Reads what was delivered; what was not fails, and missing() then says what to deliver before it is tried
/// again. Never waits. Threads: one. Memory: what was delivered and not forgotten.
class DeliveredBytes final : public ByteSource {
 public:
  /// @param name  for messages: the address.   @param size  of the whole file.
  DeliveredBytes(const std::string& name, std::uint64_t size) : ByteSource(name, size) {}

  /// @error io: the range has not been delivered.
  Result<void> read_at(std::uint64_t offset, std::span<std::byte> bytes) const override;
  /// What begins where an earlier piece does replaces it.
  void deliver(std::uint64_t offset, std::vector<std::byte> bytes) { pieces_[offset] = std::move(bytes); }
  /// True if one piece holds all of the range.
  bool has(ByteRange range) const { return piece_with(range) != nullptr; }
  /// Forgets the piece that begins there.
  void forget(std::uint64_t offset) { pieces_.erase(offset); }
  /// Forgets all pieces.
  void forget() { pieces_.clear(); }
  /// What the last read lacked; nothing if it succeeded.
  std::optional<ByteRange> missing() const { return missing_; }

 private:
  const std::byte* piece_with(ByteRange range) const;
  std::map<std::uint64_t, std::vector<std::byte>> pieces_;  // by offset
  mutable std::optional<ByteRange> missing_;
};

}  // namespace cuesta
