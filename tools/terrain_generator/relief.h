#pragma once
/// The coarse shape of generated terrain: a square of heights, of a raster or made up, read a few rows at a
/// time and interpolated smoothly.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ooc/result.h"
#include "terrain/height_raster.h"

namespace cuesta::tools {

struct Relief {
  std::uint64_t side = 0;  ///< postings, at least 2
  /// Rows [first, first + heights_m.size() / side), north first; called by one thread at a time.
  std::function<Result<void>(std::uint64_t first, std::span<double> heights_m)> read;
};

/// Postings of a raster whose rows are counted from the north, whatever the file's order.
struct Square {
  std::uint64_t column = 0, row = 0, side = 0;
};

/// A square of a raster, by default the largest in its middle; postings without data are at 0 m.
/// @error invalid_input: a side below 2, or a square that is not in the raster.
Result<Relief> relief_of(std::shared_ptr<const HeightRaster> raster,  // shared: relief.read keeps it open
                         std::optional<Square> square = {});

/// Mountains up to about 2500 m, with valleys, a third of the side wide.
Relief made_up_relief(std::uint64_t side, std::uint64_t seed);

/// Rows [first, end) of a relief in memory, from which rows between them are interpolated: bicubic
/// (Catmull–Rom), through the postings, flat beyond the borders.
class ReliefRows {
 public:
  /// For any positions in [from_row, to_row], 0 ≤ from_row ≤ to_row ≤ side - 1.   @error of relief.read
  static Result<ReliefRows> read(const Relief& relief, double from_row, double to_row);

  /// heights_m[i] and slopes[i], the length of the gradient in metres per posting of the relief, at column i
  /// · step.
  /// @pre row is in the rows that were read, (heights_m.size() - 1) · step ≤ side - 1.   Threads: concurrent.
  void interpolate(double row, double step, std::span<double> heights_m, std::span<double> slopes) const;

 private:
  std::uint64_t side_ = 0, first_ = 0, end_ = 0;
  std::vector<double> heights_m_;
};

}  // namespace cuesta::tools
