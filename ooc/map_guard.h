#pragma once
/// Pages of a mapped file that cannot be read, because the file was cut or its disk fails, come as zeros and
/// are told, in place of the SIGBUS that ends a process.

#include <atomic>
#include <cstddef>
#include <memory>

namespace cuesta {

/// Guards one map. From the first page that cannot be read, the map is zeros to its end: the reader goes on,
/// over data that are not the file's, and must ask has_faulted() before it believes any of them.
///
/// The first guard of a process installs a handler of SIGBUS, for good. What is not a fault in a guarded map
/// goes to the handler that was there, or ends the process as ever; a handler that is installed later takes
/// this one's place.
class MapGuard {
 public:
  MapGuard() = default;
  /// @param begin  of a private, read-only map of a file, at a page. It must stay mapped as long as the
  /// guard.
  MapGuard(const void* begin, std::size_t bytes);
  bool has_faulted() const;

  struct Range;  ///< of the list that the handler looks through

 private:
  struct Remove {
    void operator()(Range* range) const;
  };
  std::unique_ptr<Range, Remove> range_;
};

/// While one lives, faults in maps that nobody guards are zeros too, page by page: for libraries that map a
/// file by themselves. Of the whole process, so for readers that run alone.
class ForeignMapGuard {
 public:
  ForeignMapGuard();
  ~ForeignMapGuard();
  ForeignMapGuard(const ForeignMapGuard&) = delete;
  ForeignMapGuard& operator=(const ForeignMapGuard&) = delete;
  /// Whether there was a fault since it began.
  bool has_faulted() const;

 private:
  unsigned faults_before_ = 0;
};

}  // namespace cuesta
