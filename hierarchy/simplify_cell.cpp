#include "hierarchy/simplify_cell.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#include "hierarchy/cell_survivors.h"
#include "hierarchy/component_absorber.h"
#include "hierarchy/fan_cover.h"
#include "hierarchy/quadric_cost.h"
#include "hierarchy/substitution_kernel.h"
#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr float never = std::numeric_limits<float>::infinity();
constexpr PointId unknown = none - 1;

/// Components of this many points are taken whole as soon as the error allows it, and larger ones when
/// nothing else is left.
constexpr std::uint32_t small_component = 6;
constexpr std::uint32_t stuck_component = 64;

/// Below this many triangles for each handle or hole, topology is let go.
constexpr std::uint32_t triangles_per_loop = 12;

/// Near the end a fan is large against the surface and one neighbour too many shows: below this many
/// triangles fans take no more than the threshold allows, and the threshold rises more slowly.
constexpr std::uint32_t coarse_triangles = 4096;
constexpr double coarse_quantile = 0.03;

/// Fields of heights go by levels of error, every second code: a level is done when a pass takes less than
/// this share of the triangles with it. Against a rising cost that leaves 15 to 35 % fewer triangles at the
/// same error, in 1.3 times the time (docs/design-notes.md).
constexpr std::size_t least_share_of_level = 30;
constexpr int codes_of_level = 2;
/// What a level looks at: substitutions whose mean squared distance from the planes is up to this multiple of
/// the squared error. 16 instead of 4: up to a tenth fewer triangles in three times the time.
constexpr float cost_of_level = 4;

/// The state of a run of passes over one cell.
class FanMerger {
 public:
  FanMerger(const CellMesh& cell, const SimplifyOptions& options)
      : kernel_(cell),
        samples_(cell.samples, kernel_),
        planes_(kernel_),
        absorber_(kernel_, samples_),
        options_(options),
        by_levels_(kernel_.is_field_of_heights()),
        level_(by_levels_ ? ErrorCode8{0} : highest_level),
        cost_(kernel_.point_count(), never),
        retry_(kernel_.point_count(), 0.0f),
        cheapest_(kernel_.point_count(), unknown),
        taken_(kernel_.point_count(), 0u),
        dirty_(kernel_.point_count(), 0) {
    histogram_.fill(0);
    for (PointId p = 0; p < kernel_.point_count(); ++p) mark(p);
    centres_ = changed_centres_;
  }

  SimplifyResult run() {
    manifold_ = kernel_.is_manifold();
    float threshold = 0;
    while (kernel_.live_triangles() > options_.target_triangles) {
      loosen_if_knotted();
      refresh_costs();
      threshold =
          by_levels_ ? cost_of_level * squared(decode_error(level_)) : std::max(threshold, cost_quantile());
      ++result_.passes;
      const std::size_t moved = pass(threshold);
      if (level_ < highest_level && moved * least_share_of_level < kernel_.live_triangles()) {
        raise_level();
        continue;
      }
      if (moved + absorb_components(small_component, largest_error_) > 0) continue;
      // Nothing moved: what is below the threshold is not legal. Look higher until there is nothing higher.
      if (threshold >= highest_cost()) {
        if (absorb_components(stuck_component, never) > 0) continue;
        break;
      }
      threshold = std::max(threshold * 2, std::numeric_limits<float>::min());
      std::fill(retry_.begin(), retry_.end(), 0.0f);
    }
    if (!loose_ && manifold_)
      result_.script.strict_fans = static_cast<std::uint32_t>(result_.script.fans.size());
    order_children();
    result_.errors_are_estimates = samples_.has_chosen();
    result_.survivors = survivors_of(kernel_, samples_);
    return std::move(result_);
  }

 private:
  static constexpr ErrorCode8 highest_level = 255;
  static constexpr float squared(float x) { return x * x; }

  void raise_level() {
    level_ = level_ == 0 ? least_error_code
                         : static_cast<ErrorCode8>(std::min<int>(highest_level, level_ + codes_of_level));
  }

  void refresh_costs() {
    for (PointId v : changed_centres_) {
      dirty_[v] = 0;
      if (kernel_.removed(v)) continue;
      if (cheapest_[v] == unknown) find_cheapest(v);
      retry_[v] = 0;
    }
    changed_centres_.clear();
    if (8 * gone_ > centres_.size()) forget_gone();
  }

  void forget_gone() {
    std::erase_if(centres_, [this](PointId p) { return kernel_.removed(p); });
    gone_ = 0;
  }

  void note_gone(PointId p) {
    set_cost(p, never);
    ++gone_;
  }

  /// Costs are not negative: their bits are in order. Sign, exponent and two bits of mantissa.
  static std::size_t bin(float cost) { return std::bit_cast<std::uint32_t>(cost) >> 21; }

  void set_cost(PointId v, float cost) {
    if (cost_[v] < never) {
      --histogram_[bin(cost_[v])];
      --finite_;
    }
    cost_[v] = cost;
    if (cost < never) {
      ++histogram_[bin(cost)];
      ++finite_;
    }
  }

  void mark(PointId v) {
    if (!std::exchange(dirty_[v], std::uint8_t{1})) changed_centres_.push_back(v);
  }

  bool may_move(PointId u, PointId v) const { return kernel_.can_move(u) && kernel_.may_join(u, v); }

  /// The cheapest neighbour that could move here, and its cost.
  void find_cheapest(PointId v) {
    float cheapest = never;
    cheapest_[v] = none;
    for (PointId u : kernel_.neighbours(v)) {
      if (!may_move(u, v)) continue;
      const float c = planes_(u, v);
      if (!(c < cheapest)) continue;
      cheapest = c;
      cheapest_[v] = u;
    }
    set_cost(v, cheapest);
  }

  void offer(PointId u, PointId v) {
    if (!may_move(u, v)) return;
    const float c = planes_(u, v);
    if (!(c < cost_[v])) return;
    set_cost(v, c);
    cheapest_[v] = u;
  }

  /// The fan around v is complete: it has a new neighbourhood, and its neighbours have lost those it took and
  /// see another v. Nobody else's cost has changed.
  void note_neighbourhood(PointId v) {
    for (PointId q : kernel_.neighbours(v)) {
      taken_[q] = pass_stamp_;
      mark(q);
      const PointId u = cheapest_[q];
      if (u == unknown) continue;
      if (loose_ || u == v || (u != none && kernel_.removed(u)))
        cheapest_[q] = unknown;
      else
        offer(v, q);
    }
    taken_[v] = pass_stamp_;
    mark(v);
    cheapest_[v] = unknown;
  }

  /// What may join v and w, which have left the border, has changed.
  void forget_cheapest_around(PointId v, PointId w) {
    for (PointId p : {v, w}) {
      cheapest_[p] = unknown;
      for (PointId q : kernel_.neighbours(p)) cheapest_[q] = unknown;
    }
  }

  float cost_quantile() {
    if (finite_ == 0) return 0;
    auto nth = static_cast<std::size_t>(static_cast<double>(finite_ - 1) * quantile());
    std::size_t b = 0;
    for (; nth >= histogram_[b]; ++b) nth -= histogram_[b];
    scratch_.clear();
    for (PointId v : centres_)
      if (bin(cost_[v]) == b) scratch_.push_back(cost_[v]);
    const auto at = scratch_.begin() + static_cast<std::ptrdiff_t>(nth);
    std::nth_element(scratch_.begin(), at, scratch_.end());
    return *at;
  }

  float highest_cost() const {
    float highest = 0;
    for (const float c : cost_)
      if (c < never) highest = std::max(highest, c);
    return highest;
  }

  /// One pass: disjoint fans under the threshold. Returns the number of substitutions.
  std::size_t pass(float threshold) {
    ++pass_stamp_;
    order_.clear();
    for (PointId v : centres_)
      if (cost_[v] <= threshold && retry_[v] <= threshold)
        order_.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(cost_[v])} << 32 | v);
    std::sort(order_.begin(), order_.end());  // by cost, then by number
    std::size_t done = 0;
    const std::size_t first_fan = result_.script.fans.size();
    for (const std::uint64_t entry : order_) {
      const auto v = static_cast<PointId>(entry);
      if (kernel_.live_triangles() <= options_.target_triangles) break;
      if (!free_neighbourhood(v)) continue;
      const std::size_t merged = merge_fan(v, threshold);
      done += merged;
      if (merged > 0) note_neighbourhood(v);
    }
    // The fans of a pass do not touch each other: their order is free, and this one packs best. (With loose
    // topology they can, through what they guard.)
    if (loose_) return done;
    std::sort(result_.script.fans.begin() + static_cast<std::ptrdiff_t>(first_fan), result_.script.fans.end(),
              [](const Fan& a, const Fan& b) { return a.centre < b.centre; });
    return done;
  }

  /// Children in the order of their fans.
  void order_children() {
    std::vector<Child> ordered;
    ordered.reserve(result_.script.children.size());
    for (Fan& fan : result_.script.fans) {
      const auto first = result_.script.children.begin() + fan.first_child;
      fan.first_child = static_cast<std::uint32_t>(ordered.size());
      ordered.insert(ordered.end(), first, first + fan.child_count);
    }
    result_.script.children = std::move(ordered);
  }

  bool free_neighbourhood(PointId v) {
    if (kernel_.removed(v) || taken_[v] == pass_stamp_) return false;
    for (PointId q : kernel_.neighbours(v))
      if (taken_[q] == pass_stamp_) return false;
    return true;
  }

  bool coarse() const { return kernel_.live_triangles() < coarse_triangles; }
  float reach() const { return coarse() || by_levels_ ? 1.0f : options_.fan_reach; }
  double quantile() const {
    return coarse() ? std::min(coarse_quantile, options_.pass_quantile) : options_.pass_quantile;
  }

  /// Sets retry_ to the threshold from which on another try may be worth it, should nothing be merged.
  std::size_t merge_fan(PointId v, float threshold) {
    candidates_.clear();
    retry_[v] = threshold * 1.5f;
    float needed = never;
    for (PointId u : kernel_.neighbours(v))
      if (kernel_.can_move(u) && kernel_.may_join(u, v)) {
        const float c = planes_(u, v);
        if (c <= threshold * reach())
          candidates_.emplace_back(c, u);
        else
          needed = std::min(needed, c);
      }
    std::sort(candidates_.begin(), candidates_.end());
    const std::uint32_t first = static_cast<std::uint32_t>(result_.script.children.size());
    changed_.clear();
    ErrorCode8 error = 0;
    std::size_t merged = 0;
    const float most = decode_error(level_);
    for (const auto& [c, u] : candidates_) {
      // Half of the limit leaves room for the wedges of the last one.
      if (result_.script.children.size() - first >= max_fan_children / 2) break;
      if (by_levels_) {
        const float born = kernel_.birth_error_around(u);
        if (born > most) {
          needed = std::min(needed, cost_of_level * squared(born));
          continue;
        }
      }
      if (!kernel_.legal(u, v)) continue;
      const Replacement replacement = kernel_.replacement(u, v);
      const float deviation = samples_.measure(replacement);
      if (deviation > most) {
        needed = std::min(needed, cost_of_level * squared(deviation));
        continue;
      }
      error = std::max(error, encode_error_up(std::max(deviation, kernel_.birth_error())));
      kernel_.apply(u, v, error, result_.script.children, changed_);
      samples_.move(replacement);
      planes_.applied(u, v);
      note_gone(u);
      if (kernel_.closed_hole_corner() != none) forget_cheapest_around(v, kernel_.closed_hole_corner());
      ++merged;
      if (kernel_.live_triangles() <= options_.target_triangles) break;
    }
    if (merged > 0)
      close_fan(v, first, error);
    else if (by_levels_)
      retry_[v] = needed;
    return merged;
  }

  /// What is left is mostly handles and holes: the link condition would keep it all.
  void loosen_if_knotted() {
    if (loose_ || kernel_.live_triangles() >= std::uint64_t{triangles_per_loop} * kernel_.loops()) return;
    kernel_.loosen_topology();
    loose_ = true;
    if (manifold_) result_.script.strict_fans = static_cast<std::uint32_t>(result_.script.fans.size());
    for (PointId v = 0; v < kernel_.point_count(); ++v) mark(v);
    std::fill(cheapest_.begin(), cheapest_.end(), unknown);
  }

  /// Takes components within `reach` whole; each is a fan of its own. Returns how many.
  std::size_t absorb_components(std::uint32_t most_points, float reach) {
    if (!absorber_.has_work()) return 0;
    forget_gone();
    std::size_t taken = 0;
    for (const auto& candidate : absorber_.candidates(centres_, most_points, reach)) {
      if (kernel_.live_triangles() <= options_.target_triangles) break;
      if (!absorber_.valid(candidate)) continue;
      const auto members = absorber_.members(candidate);
      const Replacement replacement = kernel_.absorption(members, candidate.target);
      const float deviation = samples_.measure(replacement);
      const ErrorCode8 error = encode_error_up(std::max(deviation, kernel_.birth_error()));
      const auto first = static_cast<std::uint32_t>(result_.script.children.size());
      changed_.clear();
      kernel_.absorb(members, candidate.target, error, result_.script.children, changed_);
      samples_.move(replacement);
      for (PointId p : members) note_gone(p);
      close_fan(candidate.target, first, error);
      ++taken;
    }
    return taken;
  }

  void close_fan(PointId v, std::uint32_t first, ErrorCode8 error) {
    largest_error_ = std::max(largest_error_, decode_error(error));
    result_.script.fans.push_back({kernel_.first_vertex(v),
                                   first,
                                   static_cast<std::uint32_t>(result_.script.children.size()) - first,
                                   {}});
    kernel_.rebirth(changed_, decode_error(error));
  }

  SubstitutionKernel kernel_;
  SurfaceSamples samples_;
  QuadricCost planes_;
  ComponentAbsorber absorber_;
  SimplifyOptions options_;
  bool by_levels_;    // of error, not by cost
  ErrorCode8 level_;  // no substitution has a larger error
  float largest_error_ = 0;
  bool loose_ = false;
  bool manifold_ = true;     // false where a finer page has let topology go already
  std::vector<float> cost_;  // per point; `never` for those that have gone
  std::vector<float> retry_, scratch_;
  std::vector<PointId> cheapest_;  // per centre: whose cost cost_ is, none, or unknown: cost_ is of no use
  std::vector<std::uint32_t> taken_;
  std::uint32_t pass_stamp_ = 0;
  std::vector<std::uint8_t> dirty_;
  std::vector<PointId> changed_centres_;       // those with dirty_ set
  std::vector<PointId> centres_;               // ascending; some of them may have gone
  std::size_t gone_ = 0;                       // how many
  std::vector<std::uint64_t> order_;           // of a pass: bits of the cost, centre
  std::array<std::uint32_t, 1024> histogram_;  // of the costs below `never`
  std::size_t finite_ = 0;                     // their number
  std::vector<std::pair<float, PointId>> candidates_;
  std::vector<TriangleId> changed_;
  SimplifyResult result_;
};

}  // namespace

SimplifyResult simplify_cell(CellMesh cell, const SimplifyOptions& options) {
  SimplifyResult result = [&] {
    FanMerger merger(cell, options);
    cell.samples = {};  // the merger has its own
    return merger.run();
  }();
  std::vector<std::uint32_t> changed;
  CUESTA_CHECK(
      cover_fans({cell.positions, cell.wedge_group, cell.triangles, cell.births}, result.script, changed));
  const auto sphere_of = [&](std::uint32_t t) {
    if (changed[t] == no_fan) return cell.births[t].sphere;
    const Fan& fan = result.script.fans[changed[t]];
    return decode_sphere(fan.sphere, cell.positions[fan.centre]);
  };
  for (std::size_t i = 0; i < result.survivors.triangles.size(); ++i)
    result.survivors.births[i].sphere = sphere_of(result.survivors.triangles[i]);
  return result;
}

}  // namespace cuesta
