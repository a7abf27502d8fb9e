#pragma once
/// Keeps little of a mapped file in memory: lets go of what a reader has passed.

#include <cstdint>

#include "ooc/mapped_file.h"

namespace cuesta {

/// Resident at any time: step_bytes and MappedFile::fault_bytes on both sides, of a reader that calls
/// passed() often enough. `file` must outlive the window. Not thread-safe: a reader is one thread.
class MapWindow {
 public:
  static constexpr std::uint64_t step_bytes = std::uint64_t{4} << 20;

  explicit MapWindow(const MappedFile& file) : file_(file), mark_(file.bytes().data()) {}

  /// The reader goes through the file in order and is now at `at`; going back begins another pass.
  void passed(const char* at) {
    if (static_cast<std::uint64_t>(at - mark_) >= step_bytes) move_to(at);
  }
  /// Lets go of everything.
  void release_all() const;

 private:
  void move_to(const char* at);

  const MappedFile& file_;
  const char* mark_;
};

}  // namespace cuesta
