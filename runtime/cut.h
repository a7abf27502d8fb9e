#pragma once
/// The cut: a legal set of applied substitutions, kept between frames and moved towards what a view asks for,
/// within hard budgets. DESIGN §3, invariants I1, I3 and I4.

#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "hierarchy/cuesta_file.h"
#include "runtime/draw_list.h"
#include "runtime/error_scale.h"
#include "runtime/page_cache.h"

namespace cuesta {

/// Hard limits of one adapt(). What is left undone goes on in the next.
struct Budgets {
  double adapt_ms =
      std::numeric_limits<double>::infinity();  ///< time for changing the cut, page loads not counted
  std::uint64_t triangles = std::numeric_limits<std::uint64_t>::max();
  std::uint32_t page_loads = std::numeric_limits<std::uint32_t>::max();  ///< pages read in this call
};

enum class Binding : std::uint8_t { nothing, adapt_time, triangles, page_loads, resident_bytes };

struct AdaptReport {
  std::uint64_t triangles = 0;          ///< of the cut after the call
  std::uint32_t coarse_operations = 0;  ///< fans merged or split as a whole
  std::uint32_t fine_operations = 0;    ///< single substitutions applied or undone
  std::uint32_t pages_loaded = 0;
  double tau = 0;       ///< threshold aimed at: the user's, or larger where the triangle budget binds
  double achieved = 0;  ///< largest sse of an applied substitution: pixels, world units for uniform cuts
  double adapt_ms = 0;  ///< page loads not counted
  double load_ms = 0;
  std::uint64_t resident_bytes = 0;
  Binding bound_by = Binding::nothing;
  bool settled = false;  ///< another call with the same arguments would change nothing

  /// Adds the operations, pages and times of the calls before.
  void add_work_of(const AdaptReport& earlier);
};

/// Milliseconds since some fixed moment; given by the caller, for the runtime has no clock of its own.
using Clock = std::function<double()>;

class Cut {
 public:
  /// Opens with the coarsest cut, the base page resident. @error as PageCache::open.
  static Result<std::unique_ptr<Cut>> open(CuestaFile file, std::uint64_t cache_bytes, Clock clock);

  /// Refines and coarsens until every substitution with sse > `tau` is undone and every other applied, or a
  /// budget binds. Coarsens by rising sse, refines by falling sse, so wherever it stops the cut is legal.
  /// With a triangle budget that binds, the cut with the least tau that fits is aimed at.
  /// @param tau  pixels (uniform: world units); substitutions with sse ≤ tau are applied. Negative: nothing
  /// is applied,
  ///             the full resolution.
  /// @post the cut is legal, also when pages are missing; triangles ≤ budget, unless the coarsest cut has
  /// more, or the
  ///       cut came in above it and adapt_ms ended first.
  /// @error never; pages that cannot be read are in cache().errors(), and are drawn coarser.
  /// @cost O(fans of resident pages) + O(changes · log).
  AdaptReport adapt(const ErrorScale& scale, double tau, const Budgets& budgets);

  /// adapt() until it is settled or `max_calls` is reached; the last report, with sums of operations and
  /// times.
  AdaptReport settle(const ErrorScale& scale, double tau, const Budgets& budgets, int max_calls = 1000);

  PageCache& cache() { return *cache_; }
  const Directory& directory() const { return cache_->directory(); }
  DrawList draw_list() { return cache_->pool().draw_list(directory().grid); }

 private:
  /// A fan to be moved to `goal` applied substitutions. Legal in the order of `sse`, the largest of those it
  /// moves.
  struct Operation {
    double sse;
    PageId page;
    std::uint32_t fan;
    std::uint16_t goal;
  };
  /// Thresholds of one frame. Without a binding triangle budget both are tau; with one, substitutions between
  /// them fill what is left of it, and stay as they are while they fit.
  struct Band {
    double apply_up_to;
    double undo_above;
  };

  Cut(std::unique_ptr<PageCache> cache, Clock clock) : cache_(std::move(cache)), clock_(std::move(clock)) {}
  void load_pages(const ErrorScale& scale, double tau, const Budgets& budgets, AdaptReport& report);
  Band affordable_band(const ErrorScale& scale, double tau, std::uint64_t triangle_budget) const;
  void plan(const ErrorScale& scale, Band band);
  static void sort_rising(std::vector<Operation>& operations);
  bool make_room(std::uint64_t triangle_budget);
  bool coarsen(const Budgets& budgets, double start_ms, AdaptReport& report);
  bool refine(const Budgets& budgets, double start_ms, AdaptReport& report);
  double achieved(const ErrorScale& scale) const;

  std::unique_ptr<PageCache> cache_;
  Clock clock_;
  std::uint64_t frame_ = 0;
  std::vector<Operation> coarsen_, refine_, band_;
  std::uint64_t demanded_ = 0;  ///< triangles that the undo_above part of refine_ adds
};

}  // namespace cuesta
