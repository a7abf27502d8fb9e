#pragma once
/// TOMs of a scene's parts as far as a byte budget goes: coarse segments first, read and decoded off the
/// frame's thread. What of a part is resident is always a usable TOM, so a frame draws what is there and
/// never waits. Threads: one caller; loader threads of its own.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "hierarchy/scene_directory.h"
#include "hierarchy/tom.h"
#include "ooc/result.h"

namespace cuesta {

/// Makes the TOM of a part's first `segments` segments out of that of its first `have_segments` (null for
/// none). Called by several threads at once.
using PrefixReader = std::function<Result<Tom>(std::uint32_t part, const Tom* have,
                                               std::uint32_t have_segments, std::uint32_t segments)>;

/// Whether what the reader of these segments reads is at hand. Where it is not it has been asked for
/// elsewhere, and the segments are read when it has come.
using PrefixAtHand =
    std::function<bool(std::uint32_t part, std::uint32_t have_segments, std::uint32_t segments)>;

struct StoreReport {
  std::uint64_t resident_bytes = 0;       ///< ≤ the budget, with what is under way
  std::uint32_t loaded = 0, evicted = 0;  ///< segments, in this update
  std::uint32_t missing = 0;              ///< wanted and not there yet
  std::uint32_t waiting_for_budget = 0;   ///< of the missing: there is no room for them
};

class PartStore {
 public:
  /// @param parts   outlive the store; those that are no TOM are never asked for
  /// @param bytes   for TOMs: arrays as of tom.h
  /// @param threads that read and decode; 0: update() does it, and waits for it
  /// @param at_hand  empty: all is.   @pre no threads where it is not empty
  PartStore(std::span<const ScenePartEntry> parts, PrefixReader reader, std::uint64_t bytes,
            std::uint32_t threads, PrefixAtHand at_hand = {});
  ~PartStore();

  /// In this frame so much of the part would be drawn. The largest of a frame's wishes counts.
  /// @param triangles  of the part   @param priority  ≥ 0; larger is sooner
  void want(std::uint32_t part, double triangles, double priority);
  /// Takes in what has been read, asks for what is wanted and missing: first segments of all wanted parts,
  /// then the next ones by priority. Makes room by dropping what is not wanted, longest first, then what is
  /// wanted at half the priority. Ends the frame of wishes.   @cost O(parts); no I/O, unless there are no
  /// threads
  StoreReport update();
  /// Blocks until all that is under way is done; then update() takes it in. For tests and settled pictures.
  void wait();

  /// What is resident; null: nothing yet, or it cannot be read. Stays valid for who holds it.
  const std::shared_ptr<const Tom>& tom(std::uint32_t part) const { return parts_[part].tom; }
  std::uint64_t resident_bytes() const { return bytes_; }
  /// Of parts that cannot be read: they are drawn coarser, or not at all.
  std::span<const Error> errors() const { return errors_; }

 private:
  struct Part {
    std::shared_ptr<const Tom> tom, base;  // base: of the first segment, kept while there is more
    std::uint32_t segments = 0;            // of tom
    std::uint32_t wanted = 0;  // segments, in the frame that wishes are collected for, then the last one
    double priority = 0;
    std::uint64_t wanted_frame = 0;
    std::uint64_t reserved = 0;  // bytes of what is under way
    bool broken = false;
  };
  class Loader;
  struct Job;
  struct Done;
  void take_in(StoreReport& report);
  void take_in(Done done, StoreReport& report);
  void request(std::uint32_t part);
  bool make_room(std::uint64_t bytes, const Part& needing, StoreReport& report);
  std::uint64_t evict(Part& part);
  bool wanted_now(const Part& p) const { return p.wanted_frame == frame_; }
  std::uint64_t bytes_of(std::uint32_t part, std::uint32_t segments) const;

  std::span<const ScenePartEntry> entries_;
  std::uint64_t limit_, bytes_ = 0, reserved_ = 0, frame_ = 1;
  std::uint32_t under_way_ = 0, width_;
  std::vector<Part> parts_;
  std::vector<std::uint32_t> missing_, victims_;
  std::vector<Error> errors_;
  std::unique_ptr<Loader> loader_;
};

}  // namespace cuesta
