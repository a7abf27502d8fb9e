#pragma once
/// Tells whether things are the same as last time: XXH3-128 over texts and the bytes of files. Not
/// cryptographic.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "ooc/result.h"

namespace cuesta {

/// Bytes of the file hashed so far; returning false cancels.
using FingerprintProgress = std::function<bool(std::uint64_t bytes_done)>;

/// XXH3, 64 bits: tells of bytes that damage has changed.
std::uint64_t checksum(std::span<const std::byte> bytes);

/// A sequence of items; each is followed by its length, so that ("ab", "c") and ("a", "bc") differ.
class Fingerprint {
 public:
  Fingerprint();
  ~Fingerprint();
  Fingerprint(const Fingerprint&) = delete;
  Fingerprint& operator=(const Fingerprint&) = delete;

  void add(std::string_view text);
  /// The file's bytes, not its name or times. Whoever changes it between this and its use gets a wrong
  /// answer.
  /// @error not_found, io; cancelled. @cost the file is read once, 2^18 bytes at a time: no map, no budget.
  Result<void> add_file(const std::filesystem::path& path, const FingerprintProgress& progress = {});
  /// 32 digits of what was added so far, the same on every machine.
  std::string hex() const;

 private:
  struct State;
  void add_bytes(std::span<const char> bytes);
  void end_item(std::uint64_t bytes);
  std::unique_ptr<State> state_;
};

}  // namespace cuesta
