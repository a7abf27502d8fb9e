#pragma once
/// The second half of building a TOM: substitutions are measured after they have been chosen and applied, in
/// their order, while another thread chooses the next ones. Nothing that is chosen above a few thousand
/// triangles depends on what is measured.

#include <tbb/task_group.h>
#include <array>
#include <cstdint>
#include <vector>

#include "hierarchy/error_code.h"
#include "hierarchy/surface_samples.h"

namespace cuesta {

/// The error of a TOM from some removal on.
struct RemovalError {
  std::uint32_t removed;  ///< vertices that are gone before the error rises to this code
  ErrorCode8 code;
};

/// Used by one thread, inside one tbb::this_task_arena::isolate(): else a wait may take up foreign work.
class DeviationStage {
 public:
  explicit DeviationStage(SurfaceSamples& samples) : samples_(samples) {}
  ~DeviationStage() { tasks_.wait(); }
  DeviationStage(const DeviationStage&) = delete;
  DeviationStage& operator=(const DeviationStage&) = delete;

  /// Notes a replacement, to be measured later. @param removed  vertices that are gone before
  void add(const Replacement& r, std::uint32_t removed);
  /// The deviation of one that may be added next, after all that was added has been measured: grid units.
  float measure(const Replacement& r);
  /// Adds the one that was measured last.
  void add_measured(const Replacement& r, std::uint32_t removed);

  /// The largest deviation of all that was added, and how it rose. Wait for what is under way.
  float error();
  std::vector<RemovalError> take_errors();

 private:
  /// Replacements end to end.
  struct Log {
    struct Entry {
      std::size_t patch_end, targets_end, leaving_end;
      float least_error;
      std::uint32_t removed;
    };
    std::vector<Entry> entries;
    std::vector<TriangleId> patch, targets;
    std::vector<PointId> leaving;
    std::vector<std::array<PointId, 3>> corners;

    void add(const Replacement& r, std::uint32_t removed);
    void clear();
  };
  /// Some 100 kB, and milliseconds of work.
  static constexpr std::size_t most_entries = 1024;

  void catch_up();
  void measure_all(Log& log);
  void move(const Replacement& r, float deviation, std::uint32_t removed);

  SurfaceSamples& samples_;
  Log coming_, under_way_;
  tbb::task_group tasks_;  // at most one: measures what is under way
  float measured_ = 0, error_ = 0;
  std::vector<RemovalError> errors_;
};

}  // namespace cuesta
