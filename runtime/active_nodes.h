#pragma once
/// The fans of a page in blocks, each with its slack: how far the camera may move before any of its decisions
/// can change. So the cost of a frame follows what changes, not the size of the cut. Source: Livny et al.,
/// "Dual adaptive paths for multiresolution hierarchies" (FAN), 2006, §3.4 and §4; the slack is ours.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "hierarchy/error_code.h"
#include "ooc/vec.h"

namespace cuesta {

/// What a fan waits for: error of its last applied substitution, and the error up to which the next step may
/// go. With the limit of a view (the largest error that stays under τ at the fan), it must be undone below
/// `undo_below` and may be applied from `apply_from` on.
struct FanBand {
  ErrorCode8 undo_below = 0;         ///< 0: nothing is applied, or nothing that moves a point
  ErrorCode8 apply_from = no_error;  ///< no_error: all is applied

  static constexpr ErrorCode8 no_error = 255;
};

/// 18 bytes per fan and 8 per block. Spheres are kept on a 16-bit grid around the page: what that hides is
/// taken off the slack, so a fan near its switch is told a little early.
class ActiveNodes {
 public:
  static constexpr std::uint32_t block = 64;
  /// Relative change of a limit that is not worth a test of all blocks: their slack allows for it.
  static constexpr double limit_slack = 1.0 / (1 << 22);

  /// Fans alike in error and place share a block.
  /// @param errors  of the last substitution of each fan
  void assign(std::span<const Sphere> spheres, std::span<const ErrorCode8> errors);

  std::uint32_t fan_count() const { return static_cast<std::uint32_t>(node_of_fan_.size()); }
  void set_band(std::uint32_t fan, FanBand band) {
    const std::uint32_t n = node_of_fan_[fan];
    undo_below_[n] = band.undo_below;
    apply_from_[n] = band.apply_from;
    expiry_[n / block] = expiry_least_ = -std::numeric_limits<double>::infinity();
  }

  /// False if no block's slack has run out.
  bool due(double travelled) const { return !(expiry_least_ > travelled); }

  /// Appends the fans whose decision may have to change, for a limit that grows by `limit_per_unit` > 0 with
  /// each grid unit of distance from `eye` to a sphere. Blocks whose slack outlasts `travelled` are not
  /// looked at, unless `all` is set.
  /// @param travelled  length of the eye's path so far, grid units
  /// @param floor      least distance to a sphere, grid units
  /// @post no fan that is left out changes its decision at this view.
  /// @return number of blocks looked at.
  std::uint32_t test(Vec3d eye, double limit_per_unit, double floor, double travelled, bool all,
                     std::vector<std::uint32_t>& fans);
  /// For limits that do not depend on the distance: appends all fans that `limit` moves. Not due again unless
  /// one is.
  std::uint32_t test_uniform(double limit, std::vector<std::uint32_t>& fans);

  /// Appends all fans: they have limits of their own. Not due again unless one of them moves.
  std::uint32_t take_all(std::vector<std::uint32_t>& fans);

  std::uint64_t bytes() const;

 private:
  Vec3d origin_{};                                 // grid units
  float place_unit_ = 1, radius_unit_ = 1;         // grid units per step of x_, y_, z_ and of radius_
  std::vector<std::uint16_t> x_, y_, z_, radius_;  // of nodes, padded to whole blocks
  std::vector<ErrorCode8> undo_below_, apply_from_;
  std::vector<std::uint32_t> fan_of_node_, node_of_fan_;
  std::vector<double> expiry_;  // per block: value of `travelled` from which it must be tested
  double expiry_least_ = -std::numeric_limits<double>::infinity();
};

}  // namespace cuesta
