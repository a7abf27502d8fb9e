#pragma once
/// Indices of TOMs at rungs of resolution, extracted once and shared by all instances and frames that ask for
/// the same.

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "hierarchy/tom.h"

namespace cuesta {

/// A part's triangles at one resolution. Immutable.
struct IndexBlock {
  std::uint64_t id = 0;  ///< never used again; for copies on a GPU
  Resolution resolution = 0;
  std::vector<Triangle> triangles;
};

/// Resolutions come in rungs, eight to a doubling of triangles, so that what moves a little is drawn with
/// what is there.
inline constexpr int rungs_per_octave = 8;
/// Triangles of the finest rung with at most so many of `all`: all · 2^(-k/8).   @pre triangles > 0
double rung_triangles(double triangles, double all);

/// Threads: one.
class IndexCache {
 public:
  /// @param bytes  of blocks that the current frame does not use, at most; 12 per triangle
  explicit IndexCache(std::uint64_t bytes) : limit_(bytes) {}

  /// A new frame: what was extracted in it, and what is kept, counts from here.
  void begin_frame() { ++frame_, extracted_ = denied_ = 0; }

  /// The triangles of resolution n; while extracting them would make more than `most_extracted` in this
  /// frame, those of the finest coarser block that is there. Where there is none, the coarsest, extracted all
  /// the same.
  /// @param tom  what of the part is resident: vertices keep their numbers when it grows   @pre n is one of
  /// its resolutions
  /// @cost O(triangles extracted)
  std::shared_ptr<const IndexBlock> get(std::uint32_t part, const Tom& tom, Resolution n,
                                        std::uint64_t most_extracted);
  /// Forgets blocks that have not been used for longest, down to the limit.
  void end_frame();

  // In this frame:
  std::uint64_t extracted_triangles() const { return extracted_; }
  std::uint64_t denied_triangles() const { return denied_; }  ///< that would have been too many
  std::uint64_t bytes() const { return bytes_; }

 private:
  struct Entry {
    std::shared_ptr<const IndexBlock> block;
    std::uint64_t used = 0;  // frame
  };
  Entry& extract(std::vector<Entry>& entries, const Tom& tom, Resolution n, std::uint64_t triangles);

  std::uint64_t limit_, bytes_ = 0, frame_ = 0, extracted_ = 0, denied_ = 0, next_id_ = 1;
  std::unordered_map<std::uint32_t, std::vector<Entry>> parts_;
  std::vector<std::uint64_t> stale_;  // frames in which what is not in use was used last
};

}  // namespace cuesta
