#include "runtime/cut.h"

#include <algorithm>
#include <array>
#include <bit>
#include <tuple>

namespace cuesta {
namespace {

/// Operations between two looks at the clock.
constexpr std::uint32_t operations_per_look = 32;

/// Bins of sse with 32 to the octave: the upper bits of a positive float. The last one holds infinity alone.
constexpr std::size_t sse_bins = (0x7F800000u >> 18) + 1;
std::size_t bin_of(double sse) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(sse)) >> 18;
}
double bin_floor(std::size_t bin) {
  return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bin) << 18));
}
constexpr double infinity = std::numeric_limits<double>::infinity();

double sse_of(ErrorCode8 error, double scale) {
  return error == 0 ? 0 : static_cast<double>(decode_error(error)) / scale;
}

/// How many substitutions of a fan have sse ≤ tau. Joined ones share an error, so none is torn apart.
std::uint16_t count_up_to(std::span<const ChildState> children, double scale, double tau) {
  const auto end = std::partition_point(children.begin(), children.end(),
                                        [&](const ChildState& c) { return sse_of(c.error, scale) <= tau; });
  return static_cast<std::uint16_t>(end - children.begin());
}

}  // namespace

void AdaptReport::add_work_of(const AdaptReport& earlier) {
  coarse_operations += earlier.coarse_operations;
  fine_operations += earlier.fine_operations;
  pages_loaded += earlier.pages_loaded;
  adapt_ms += earlier.adapt_ms;
  load_ms += earlier.load_ms;
}

Result<std::unique_ptr<Cut>> Cut::open(CuestaFile file, std::uint64_t cache_bytes, Clock clock) {
  auto cache = PageCache::open(std::move(file), cache_bytes);
  if (!cache) return fail(cache.error());
  return std::unique_ptr<Cut>(new Cut(std::move(*cache), std::move(clock)));
}

/// Loads what the view wants, the worst first; pages that become loadable by it are considered in the same
/// call.
void Cut::load_pages(const ErrorScale& scale, double tau, const Budgets& budgets, AdaptReport& report) {
  const Directory& d = directory();
  std::vector<std::pair<double, PageId>> wanted;
  for (bool again = true; again;) {
    again = false;
    wanted.clear();
    for (PageId id = 0; id < d.pages.size(); ++id) {
      const PageEntry& e = d.pages[id];
      const double sse = sse_of(e.largest_error, scale.scale(e.bound));
      if (!(sse > tau)) continue;
      if (cache_->resident(id))
        cache_->want(id, frame_);
      else if (cache_->loadable(id))
        wanted.emplace_back(-sse, id);
    }
    std::sort(wanted.begin(), wanted.end());
    for (const auto& [minus_sse, id] : wanted) {
      if (report.pages_loaded >= budgets.page_loads) {
        report.bound_by = Binding::page_loads;
        return;
      }
      const auto loaded = cache_->load(id, frame_);
      if (!loaded) continue;
      if (!*loaded) {
        report.bound_by = Binding::resident_bytes;
        return;
      }
      ++report.pages_loaded;
      again = true;
    }
  }
}

Cut::Band Cut::affordable_band(const ErrorScale& scale, double tau, std::uint64_t triangle_budget) const {
  if (triangle_budget == std::numeric_limits<std::uint64_t>::max()) return {tau, tau};
  std::vector<std::uint64_t> gain(sse_bins, 0);
  std::uint64_t coarsest = cache_->pool().active_triangles();
  for (PageId id : cache_->resident_ids()) {
    const ResidentPage& page = *cache_->resident(id);
    for (std::size_t f = 0; f < page.fans().size(); ++f) {
      const FanState& fan = page.fans()[f];
      const double s = scale.scale(page.sphere(f));
      const auto children = page.children(fan);
      for (std::size_t i = 0; i < children.size(); ++i) {
        if (i >= fan.applied) coarsest -= children[i].removed;
        const double sse = sse_of(children[i].error, s);
        if (sse > tau) gain[bin_of(sse)] += children[i].removed;
      }
    }
  }
  if (coarsest > triangle_budget) return {infinity, infinity};
  std::uint64_t total = coarsest;
  for (std::size_t bin = sse_bins; bin-- > 0;) {
    if (total + gain[bin] <= triangle_budget) {
      total += gain[bin];
      continue;
    }
    if (bin + 1 == sse_bins) return {static_cast<double>(std::numeric_limits<float>::max()), infinity};
    return {std::max(tau, bin_floor(bin)), bin_floor(bin + 1)};
  }
  return {tau, tau};
}

void Cut::plan(const ErrorScale& scale, Band band) {
  coarsen_.clear();
  refine_.clear();
  band_.clear();
  demanded_ = 0;
  for (PageId id : cache_->resident_ids()) {
    const ResidentPage& page = *cache_->resident(id);
    for (std::uint32_t f = 0; f < page.fans().size(); ++f) {
      const FanState& fan = page.fans()[f];
      const auto children = page.children(fan);
      const double s = scale.scale(page.sphere(f));
      const std::uint16_t least = count_up_to(children, s, band.apply_up_to);
      const std::uint16_t most =
          band.apply_up_to < band.undo_above ? count_up_to(children, s, band.undo_above) : least;
      if (fan.applied < least) {
        coarsen_.push_back({sse_of(children[least - 1u].error, s), id, f, least});
      } else if (fan.applied > least) {
        refine_.push_back({sse_of(children[fan.applied - 1u].error, s), id, f, least});
        for (std::uint16_t i = most; i < fan.applied; ++i) demanded_ += children[i].removed;
      }
      if (std::max(fan.applied, least) < most)
        band_.push_back({sse_of(children[most - 1u].error, s), id, f, most});
    }
  }
}

/// The order in which substitutions may be applied: ties go finer pages and earlier fans first.
void Cut::sort_rising(std::vector<Operation>& operations) {
  std::sort(operations.begin(), operations.end(), [](const Operation& a, const Operation& b) {
    return std::tie(a.sse, a.page, a.fan) < std::tie(b.sse, b.page, b.fan);
  });
}

/// Gives back what fills the band when the demanded part needs the room. @return true if it did: the plan is
/// stale then.
bool Cut::make_room(std::uint64_t triangle_budget) {
  if (band_.empty() || cache_->pool().active_triangles() + demanded_ <= triangle_budget) return false;
  sort_rising(band_);
  for (const Operation& op : band_) {
    if (cache_->pool().active_triangles() + demanded_ <= triangle_budget) return true;
    ResidentPage& page = *cache_->resident(op.page);
    while (page.fans()[op.fan].applied < op.goal) page.apply_next(op.fan);
  }
  return true;
}

bool Cut::coarsen(const Budgets& budgets, double start_ms, AdaptReport& report) {
  sort_rising(coarsen_);
  std::uint32_t done = 0;
  for (const Operation& op : coarsen_) {
    if (++done % operations_per_look == 0 && clock_() - start_ms > budgets.adapt_ms) return false;
    ResidentPage& page = *cache_->resident(op.page);
    const FanState& fan = page.fans()[op.fan];
    const bool whole = fan.applied == 0 && op.goal == fan.child_count;
    for (; fan.applied < op.goal; report.fine_operations += !whole) page.apply_next(op.fan);
    report.coarse_operations += whole;
  }
  return true;
}

bool Cut::refine(const Budgets& budgets, double start_ms, AdaptReport& report) {
  std::sort(refine_.begin(), refine_.end(), [](const Operation& a, const Operation& b) {
    return std::tie(a.sse, a.page, a.fan) > std::tie(b.sse, b.page, b.fan);
  });
  const GeometryPool& pool = cache_->pool();
  std::uint32_t done = 0;
  for (const Operation& op : refine_) {
    if (++done % operations_per_look == 0 && clock_() - start_ms > budgets.adapt_ms) {
      report.bound_by = Binding::adapt_time;
      return false;
    }
    ResidentPage& page = *cache_->resident(op.page);
    const FanState& fan = page.fans()[op.fan];
    const bool whole = op.goal == 0 && fan.applied == fan.child_count;
    while (fan.applied > op.goal) {
      if (pool.active_triangles() + page.undo_gain(op.fan) > budgets.triangles) {
        report.bound_by = Binding::triangles;
        return true;  // the rest waits for room, not for time
      }
      page.undo_last(op.fan);
      report.fine_operations += !whole;
    }
    report.coarse_operations += whole;
  }
  return true;
}

double Cut::achieved(const ErrorScale& scale) const {
  double worst = 0;
  for (PageId id : cache_->resident_ids()) {
    const ResidentPage& page = *cache_->resident(id);
    for (std::size_t f = 0; f < page.fans().size(); ++f) {
      const FanState& fan = page.fans()[f];
      if (fan.applied > 0)
        worst = std::max(worst,
                         scale.sse(decode_error(page.children(fan)[fan.applied - 1u].error), page.sphere(f)));
    }
  }
  for (PageId id = 0; id < directory().pages.size(); ++id) {
    const PageEntry& e = directory().pages[id];
    if (!cache_->resident(id)) worst = std::max(worst, scale.sse(decode_error(e.largest_error), e.bound));
  }
  return worst;
}

AdaptReport Cut::adapt(const ErrorScale& scale, double tau, const Budgets& budgets) {
  AdaptReport report;
  ++frame_;
  const double load_start = clock_();
  const Band wanted = affordable_band(scale, tau, budgets.triangles);
  load_pages(scale, wanted.apply_up_to, budgets, report);
  const double start = clock_();
  report.load_ms = start - load_start;
  // Pages that came in may ask for triangles too.
  const Band band = report.pages_loaded > 0 ? affordable_band(scale, tau, budgets.triangles) : wanted;
  plan(scale, band);
  const bool coarsened = coarsen(budgets, start, report);
  // Above what coarsen() did: not before it is complete. What it applies may have to be undone first of all
  // (I4).
  if (coarsened && make_room(budgets.triangles)) plan(scale, band);
  if (!coarsened) report.bound_by = Binding::adapt_time;
  const bool refined = coarsened && refine(budgets, start, report);
  if (band.apply_up_to > tau && report.bound_by == Binding::nothing) report.bound_by = Binding::triangles;
  report.tau = band.apply_up_to;
  report.adapt_ms = clock_() - start;
  report.achieved = achieved(scale);
  report.triangles = cache_->pool().active_triangles();
  report.resident_bytes = cache_->resident_bytes();
  const bool changed = report.pages_loaded + report.coarse_operations + report.fine_operations > 0;
  report.settled = coarsened && refined && !changed && report.bound_by != Binding::page_loads;
  return report;
}

AdaptReport Cut::settle(const ErrorScale& scale, double tau, const Budgets& budgets, int max_calls) {
  AdaptReport sum;
  for (int call = 0; call < max_calls; ++call) {
    AdaptReport last = adapt(scale, tau, budgets);
    last.add_work_of(sum);
    sum = last;
    if (sum.settled) break;
  }
  return sum;
}

}  // namespace cuesta
