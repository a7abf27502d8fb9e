#include "runtime/cut.h"

#include <algorithm>
#include <cmath>

#ifndef __EMSCRIPTEN__
#include <tbb/parallel_for.h>
#endif

namespace cuesta {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Work between two looks at the clock, a few dozen microseconds.
constexpr std::uint32_t operations_per_look = 32;
constexpr std::uint32_t blocks_per_look = 64;
constexpr std::size_t pages_per_batch = 32;  // that threads test together
/// Share of the time for finding out what to do; the rest is for doing it.
constexpr double plan_share = 0.5;
/// A camera that has not moved for so many calls is at rest.
constexpr std::uint32_t frames_to_rest = 8;
/// Pages up to so many times the distance of the nearest one take the fine path, at up to this speed (of that
/// distance, per frame); at twice the speed it is half as far.
constexpr double fine_reach = 3, fine_speed = 0.02;
/// A page on the fine path leaves it so much farther out than one on the coarse path takes it.
constexpr double path_dead_band = 1.25;
/// Pages are asked for that will be wanted in so many frames, but not at the cost of pages wanted less long
/// ago.
constexpr double prefetch_frames = 20;
constexpr std::uint64_t prefetch_keeps_frames = 60;
/// Beyond this speed, of the distance of the nearest page per frame, a camera jumps: where to, its path does
/// not tell.
constexpr double prefetch_speed = 0.25;

template <class Element, class Run>
void for_each(std::span<Element> elements, [[maybe_unused]] bool in_parallel, const Run& run) {
#ifndef __EMSCRIPTEN__
  if (in_parallel && elements.size() > 1) {
    tbb::parallel_for(std::size_t{0}, elements.size(), [&](std::size_t i) { run(elements[i]); });
    return;
  }
#endif
  for (Element& e : elements) run(e);
}

double sse_of(ErrorCode8 error, double scale) {
  return error == 0 ? 0 : static_cast<double>(decode_error(error)) / scale;
}

/// How many substitutions of a fan have sse ≤ tau. Joined ones share an error, so none is torn apart.
std::uint16_t count_up_to(std::span<const ChildState> children, double scale, double tau) {
  std::uint16_t count = 0;
  while (count < children.size() && sse_of(children[count].error, scale) <= tau) ++count;
  return count;
}

}  // namespace

/// One call of adapt().
struct Cut::Frame {
  const ErrorScale& scale;
  const double tau;  // the user's
  const Budgets& budgets;
  AdaptReport& report;
  double start_ms;
  std::uint64_t upload_start = 0;
  double floor = 0;  // what the byte budget leaves of tau
  double aim = 0;
  bool at_rest = false;
  bool all_planned = false, blocked = false;  // blocked: a refinement found no triangles left
  bool coarsened = false, refined = false;
  bool merges_wait = false;    // for their geomorphs
  std::uint32_t unlooked = 0;  // operations or blocks since the last look at the clock
  double undone_sse = 0;       // of what a budget left undone
};

void AdaptReport::add_work_of(const AdaptReport& earlier) {
  coarse_operations += earlier.coarse_operations;
  fine_operations += earlier.fine_operations;
  pages_loaded += earlier.pages_loaded;
  blocks_tested += earlier.blocks_tested;
  adapt_ms += earlier.adapt_ms;
  load_ms += earlier.load_ms;
}

Result<std::unique_ptr<Cut>> Cut::open(CuestaFile file, std::uint64_t cache_bytes, Clock clock,
                                       const MakePageLoader& make_loader) {
  auto cache = PageCache::open(std::move(file), cache_bytes, make_loader);
  if (!cache) return fail(cache.error());
  return std::unique_ptr<Cut>(new Cut(std::move(*cache), std::move(clock)));
}

bool Cut::out_of_time(const Frame& f, double share) const {
  return clock_() - f.start_ms > f.budgets.adapt_ms * share;
}

void Cut::follow(const ErrorScale& scale, double tau, const Budgets& budgets) {
  const bool still = scale_ && *scale_ == scale && tau_ == tau && budgets_ == budgets;
  still_frames_ = still ? still_frames_ + 1 : 0;
  if (still) {
    velocity_ = {};
    return;
  }
  const bool comparable = scale_ && !scale_->is_uniform() && !scale.is_uniform();
  const Vec3d step = comparable ? scale.eye() - scale_->eye() : Vec3d{};
  if (comparable)
    travelled_ += length(step);
  else  // what was tested for another kind of scale says nothing
    for (const PageId id : cache_->resident_ids()) cache_->resident(id)->tested_limit = -1;
  velocity_ = velocity_ * 0.5 + step * 0.5;
  shrunk_ = budgets.triangles < budgets_.triangles;
  scale_ = scale;
  tau_ = tau;
  budgets_ = budgets;
  settled_ = false;
  rest_tau_.reset();
  recount();
}

void Cut::recount() {
  triangle_demand_.restart();
  counted_ = filling_ = false;
}

/// @return false if the time ended it.
bool Cut::count_triangles(const Frame& f, double floor, bool in_time) {
  return triangle_demand_.count(
      *cache_, f.scale, [&](PageId id) { return factor_of(f.scale, id); }, floor, f.budgets.triangles,
      [&] { return in_time && out_of_time(f, 1); });
}

/// The threshold of this frame: the user's, raised by the regulator, at rest by what exactly fits, and by
/// what the byte budget leaves.
void Cut::choose_tau(Frame& f) {
  if (shrunk_ && cache_->pool().active_triangles() > f.budgets.triangles) {
    recount();
    count_triangles(f, f.tau, false);
    regulator_.set(triangle_demand_.tau());
    rest_tau_ = triangle_demand_.tau();
  }
  shrunk_ = false;
  const bool still = still_frames_ > 0 || f.at_rest;
  const double regulated = still ? regulator_.at_least(f.tau) : regulator_.next(load_, f.tau);
  const double wanted = rest_tau_ ? *rest_tau_ : regulated;
  const double from = still ? f.tau : wanted;
  demand_.find(*cache_, f.scale, from);
  f.floor = demand_.affordable(*cache_, from);
  if (f.floor > from) f.floor = Regulator::step_up(f.floor);
  f.aim = std::max(wanted, f.floor);
  f.report.tau = f.aim;
  if (filling_) f.aim = std::max(triangle_demand_.next_tau(), f.floor);
  if (f.floor > from) f.report.bound_by = Binding::resident_bytes;
}

void Cut::load_pages(Frame& f) {
  const auto wanted = demand_.wanted();
  for (const WantedPage& w : wanted)
    if (w.sse > f.aim && cache_->resident(w.id)) cache_->want(w.id, frame_);
  std::uint32_t asked = 0;
  bool room = true;
  for (const WantedPage& w : wanted) {
    if (!(w.sse > f.aim)) break;
    if (cache_->resident(w.id) || cache_->failed(w.id)) continue;
    if (room && cache_->requestable(w.id) && !cache_->busy()) {
      if (asked == f.budgets.page_loads) {
        f.report.bound_by = Binding::page_loads;
        room = false;
      } else {
        room = cache_->request(w.id, frame_);
        asked += room;
        f.report.pages_loaded += cache_->take_in(frame_, f.budgets.upload_bytes);
      }
    }
    if (cache_->resident(w.id) || cache_->failed(w.id)) continue;
    ++f.report.pages_missing;
    f.undone_sse = std::max(f.undone_sse, w.sse);
  }
}

/// Factors of visual error. A page takes no larger one than the pages that lean on it, of those that are
/// wanted: what leans on a page that is not is applied anyway.
void Cut::weigh_pages(const Frame& f) {
  if (!visual_.on() || f.scale.is_uniform()) {
    visual_factor_.clear();
    return;
  }
  visual_factor_.assign(directory().pages.size(), visual_.facing_factor);
  const auto wanted = demand_.wanted();
  for (std::size_t i = wanted.size(); i-- > 0;) {
    const PageId id = wanted[i].id;
    const ResidentPage* page = cache_->resident(id);
    if (!page) continue;
    const PageEntry& e = directory().pages[id];
    double& factor = visual_factor_[id];
    factor = std::min(factor, visual_.page_factor(page->normals(), e.bound, f.scale.eye()));
    for (const PageId c : e.coarser) visual_factor_[c] = std::min(visual_factor_[c], factor);
  }
}

double Cut::factor_of(const ErrorScale& scale, PageId id) const {
  const double factor = scale.page_factor(directory().pages[id].bound);
  return visual_factor_.empty() ? factor : factor * visual_factor_[id];
}

void Cut::prefetch(Frame& f) {
  if (f.scale.is_uniform() || still_frames_ > 0 || f.report.pages_missing > 0 || cache_->busy() ||
      f.budgets.page_loads == 0 || frame_ <= prefetch_keeps_frames)
    return;
  const double speed = length(velocity_);
  if (speed == 0 || speed > nearest_ * prefetch_speed) return;
  for (const WantedPage& w : predicted_.find(*cache_, f.scale.moved(velocity_ * prefetch_frames), f.aim)) {
    if (cache_->busy()) return;
    if (cache_->requestable(w.id) && !cache_->request(w.id, frame_ - prefetch_keeps_frames, true)) return;
  }
}

/// About how far the fans of a page are, also where the eye is in its bound.
double Cut::typical_distance(const Frame& f, const Sphere& bound) const {
  const double radius = bound.radius;
  return std::max(length(vec_cast<double>(bound.centre) - f.scale.eye()) - radius / 2, radius / 2);
}

/// Of the pages on the cut that nothing resident leans on, how far the nearest is.
void Cut::note_nearest(const Frame& f) {
  nearest_ = infinity;
  if (f.scale.is_uniform()) return;
  for (const WantedPage& w : demand_.wanted()) {
    const ResidentPage* page = cache_->resident(w.id);
    if (page && page->finer_residents == 0)
      nearest_ = std::min(nearest_, typical_distance(f, directory().pages[w.id].bound));
  }
}

FanPath Cut::path_for(const Frame& f, const Sphere& bound, FanPath now) const {
  if (policy_ == PathPolicy::always_coarse) return FanPath::coarse;
  if (policy_ == PathPolicy::always_fine || f.at_rest || !(nearest_ < infinity)) return FanPath::fine;
  const double speed = length(velocity_) / nearest_;
  const double reach = nearest_ * fine_reach * std::min(1.0, fine_speed / std::max(speed, 1e-30));
  const double distance = typical_distance(f, bound);
  return distance <= reach * (now == FanPath::fine ? path_dead_band : 1) ? FanPath::fine : FanPath::coarse;
}

/// Finds what is to be moved, page by page in one direction. Where the time ends it, what leans on the
/// planned part in that direction is complete, and so is what may be done: coarsenings when finer pages came
/// first, else refinements.
void Cut::plan(Frame& f) {
  coarsen_.clear();
  refine_.clear();
  follow_merges(f);
  f.unlooked = 0;
  const auto ids = cache_->resident_ids();
  const std::size_t batch = parallel_ ? pages_per_batch : 1;
  for (std::size_t i = 0; i < ids.size();) {
    if (f.unlooked >= blocks_per_look) {
      f.unlooked = 0;
      if (out_of_time(f, plan_share)) return;
    }
    test_count_ = 0;
    for (; i < ids.size() && test_count_ < batch; ++i)
      make_test(f, finer_first_ ? ids[i] : ids[ids.size() - 1 - i]);
    run_tests(f);
    plan_tests(f);
  }
  f.all_planned = true;
}

/// Nothing where nothing can have changed in the page.
void Cut::make_test(const Frame& f, PageId id) {
  ResidentPage& page = *cache_->resident(id);
  if (page.fully_coarse() && page.last_wanted != frame_) return;  // all of it is under the threshold
  const Sphere& bound = directory().pages[id].bound;
  const double factor = factor_of(f.scale, id);
  const double limit = f.aim * f.scale.unit() * factor;
  const bool same_limit =
      std::abs(limit - page.tested_limit) <= ActiveNodes::limit_slack * std::abs(page.tested_limit);
  const bool all = page.set_path(path_for(f, bound, page.path())) || !same_limit;
  if (all) page.tested_limit = limit;
  if (!all && !page.active_nodes().due(travelled_)) return;
  if (tests_.size() == test_count_) tests_.emplace_back();
  PageTest& test = tests_[test_count_++];
  test.page = &page;
  test.factor = factor;
  test.limit = limit;
  test.all = all;
  test.candidates.clear();
}

void Cut::run_tests(const Frame& f) {
  const auto run = [&](PageTest& t) {
    ActiveNodes& nodes = t.page->active_nodes();
    const auto same = f.scale.same_within(directory().pages[t.page->id()].bound);
    if (!same) {  // each fan has a limit of its own
      t.blocks = nodes.take_all(t.candidates);
      return;
    }
    const bool near_and_far = !f.scale.is_uniform() && t.limit > 0 && t.limit < infinity;
    t.blocks = near_and_far
                   ? nodes.test(f.scale.eye(), t.limit, ErrorScale::nearest, travelled_, t.all, t.candidates)
                   : nodes.test_uniform(*same < infinity ? t.limit : infinity, t.candidates);
  };
  for_each(std::span(tests_).first(test_count_), parallel_, run);
}

void Cut::plan_tests(Frame& f) {
  for (const PageTest& t : std::span(tests_).first(test_count_)) {
    f.unlooked += t.blocks;
    f.report.blocks_tested += t.blocks;
    for (const std::uint32_t fan : t.candidates)
      plan_fan(f, *t.page, fan, f.scale.scale(t.page->sphere(fan), t.factor));
  }
}

void Cut::plan_fan(Frame& f, ResidentPage& page, std::uint32_t fan, double scale) {
  if (geomorphs_.merging(page.id(), fan)) return;
  const FanState& state = page.fans()[fan];
  const auto children = page.children(state);
  std::uint16_t goal = count_up_to(children, scale, f.aim);
  if (page.path() == FanPath::coarse && goal != state.child_count) {
    if (goal >= state.applied) return;
    goal = 0;
  }
  if (goal > state.applied)
    coarsen_.add({sse_of(children[goal - 1u].error, scale), page.id(), fan, goal});
  else if (goal < state.applied)
    refine_.add({sse_of(children[state.applied - 1u].error, scale), page.id(), fan, goal});
}

/// Merges whose geomorphs are over are to be applied, those that the view no longer wants are let go.
void Cut::follow_merges(Frame& f) {
  geomorphs_.update(clock_());
  const auto merges = geomorphs_.merges();
  for (std::size_t i = merges.size(); i-- > 0;) {  // the last one takes the place of one that goes
    const Geomorphs::Merge& m = geomorphs_.merges()[i];
    const ResidentPage& page = *cache_->resident(m.page);
    const auto children = page.children(page.fans()[m.fan]);
    const double scale = f.scale.scale(page.sphere(m.fan), factor_of(f.scale, m.page));
    const std::uint16_t wanted = count_up_to(children, scale, f.aim);
    if (wanted < m.goal) {
      geomorphs_.call_off(static_cast<std::uint32_t>(i));
      continue;
    }
    if (wanted > m.goal) geomorphs_.postpone(page, m.fan, m.goal, wanted);  // the fan's next ones
    f.merges_wait = true;
    if (m.due) coarsen_.add({sse_of(children[m.goal - 1u].error, scale), m.page, m.fan, m.goal});
  }
}

/// True if a coarsening is left for later: until its geomorph is over, or until the one that it leans on is.
bool Cut::waits(Frame& f, const Operation& op) {
  if (!geomorphs_.on() && geomorphs_.idle()) return false;
  if (geomorphs_.merging(op.page, op.fan)) return false;  // it is due
  const ResidentPage& page = *cache_->resident(op.page);
  if (geomorphs_.must_wait(page, op.fan, op.goal)) {
    geomorphs_.postpone(page, op.fan, page.fans()[op.fan].applied, op.goal);
    f.merges_wait = true;
    return true;
  }
  if (!geomorphs_.on() || page.path() == FanPath::coarse || !geomorphs_.has_room()) return false;
  geomorphs_.begin_merge(page, op.fan, op.goal);
  f.merges_wait = true;
  return true;
}

/// @return false if the upload budget has no room for it.
bool Cut::move(Frame& f, const Operation& op, std::uint16_t goal) {
  ResidentPage& page = *cache_->resident(op.page);
  GeometryPool& pool = cache_->pool();
  const std::uint64_t used = pool.upload_bytes() - f.upload_start;
  const std::uint64_t worst = std::uint64_t{page.entries_between(op.fan, goal)} * GeometryPool::dirty_bytes;
  if (used > 0 && f.budgets.upload_bytes - std::min(used, f.budgets.upload_bytes) < worst) {
    f.report.bound_by = Binding::upload_bytes;
    return false;
  }
  const FanState before = page.fans()[op.fan];
  const bool whole =
      before.child_count > 1 &&
      (before.applied == 0 ? goal == before.child_count : goal == 0 && before.applied == before.child_count);
  page.move_fan(op.fan, goal);
  if (goal > before.applied)
    geomorphs_.vanish(page, op.fan, before.applied, goal);
  else if (geomorphs_.on() && page.path() == FanPath::fine && geomorphs_.has_room())
    geomorphs_.grow(page, op.fan, goal, before.applied);
  if (whole)
    ++f.report.coarse_operations;
  else
    f.report.fine_operations += goal > before.applied ? goal - before.applied : before.applied - goal;
  if (pool.tagging())
    page.tag_changes(op.fan, before.applied,
                     static_cast<std::uint8_t>(whole ? TriangleTag::coarse : TriangleTag::fine));
  return true;
}

bool Cut::coarsen(Frame& f) {
  f.unlooked = 0;
  while (const Operation* op = coarsen_.next()) {
    if (++f.unlooked == operations_per_look) {
      f.unlooked = 0;
      if (out_of_time(f, 1)) {
        f.report.bound_by = Binding::adapt_time;
        return false;
      }
    }
    if (waits(f, *op)) continue;
    if (!move(f, *op, op->goal)) return false;
  }
  return true;
}

/// What does not fit the triangle budget ends it: all that follows may lean on it.
bool Cut::refine(Frame& f) {
  const GeometryPool& pool = cache_->pool();
  f.unlooked = 0;
  while (const Operation* op = refine_.next()) {
    if (++f.unlooked == operations_per_look) {
      f.unlooked = 0;
      if (out_of_time(f, 1)) {
        f.report.bound_by = Binding::adapt_time;
        f.undone_sse = std::max(f.undone_sse, op->sse);
        return false;
      }
    }
    const ResidentPage& page = *cache_->resident(op->page);
    const auto fits = [&](std::uint16_t goal) {
      return pool.active_triangles() + page.undo_gain(op->fan, goal) <= f.budgets.triangles;
    };
    bool stopped = false;
    if (fits(op->goal)) {
      stopped = !move(f, *op, op->goal);
    } else {
      f.blocked = true;
      while (!stopped && page.fans()[op->fan].applied > op->goal && fits(page.one_undone(op->fan)))
        stopped = !move(f, *op, page.one_undone(op->fan));
    }
    if (stopped || f.blocked) {
      f.undone_sse = std::max(f.undone_sse, op->sse);
      if (f.blocked) f.report.bound_by = Binding::triangles;
      return !stopped;  // the rest waits for triangles, not for the next frame
    }
  }
  return true;
}

/// Where nothing is left to do at this threshold: is it the least that the triangle budget allows, and is
/// there room for a part of the next step?
void Cut::rest(Frame& f) {
  const bool done =
      f.all_planned && f.coarsened && f.refined && f.report.pages_missing == 0 && !f.merges_wait;
  const bool moved = f.report.coarse_operations + f.report.fine_operations + f.report.pages_loaded > 0;
  if (!done || moved || !f.at_rest) return;
  const bool free = !f.blocked && f.aim == f.floor;
  if (!free && !counted_) {
    counted_ = count_triangles(f, f.floor, true);
    if (!counted_) {
      f.report.bound_by = Binding::adapt_time;
      return;
    }
    rest_tau_ = triangle_demand_.tau();
    regulator_.set(*rest_tau_);
  }
  if (!free && !filling_) {
    filling_ = *rest_tau_ == f.aim;
    return;
  }
  if (filling_) f.report.bound_by = Binding::triangles;
  settled_ = cache_->on_their_way() == 0;
}

AdaptReport Cut::adapt(const ErrorScale& scale, double tau, const Budgets& budgets) {
  const double start = clock_();
  ++frame_;
  follow(scale, tau, budgets);
  GeometryPool& pool = cache_->pool();
  AdaptReport report;
  Frame f{scale, tau, budgets, report, start};
  f.upload_start = pool.upload_bytes();
  report.pages_loaded = cache_->take_in(frame_, budgets.upload_bytes);
  if (settled_ && report.pages_loaded == 0 && geomorphs_.idle()) {
    report = report_;
    report.coarse_operations = report.fine_operations = report.blocks_tested = 0;
    report.upload_bytes = 0;
    report.load_ms = 0;
    report.adapt_ms = clock_() - start;
    return report;
  }
  f.at_rest = still_frames_ >= frames_to_rest || scale.is_uniform();
  choose_tau(f);
  load_pages(f);
  if (cache_->loads_inline()) {
    report.load_ms = clock_() - start;
    f.start_ms += report.load_ms;
  }
  if (report.pages_loaded > 0 && !filling_) recount();
  weigh_pages(f);
  note_nearest(f);
  plan(f);
  if (f.all_planned || finer_first_) f.coarsened = coarsen(f) && f.all_planned;
  const bool wait = filling_ && report.pages_missing > 0;  // what comes may be worse than what is there
  if ((f.all_planned || !finer_first_) && !wait) f.refined = refine(f) && f.all_planned;
  if (!f.all_planned) {
    report.bound_by = Binding::adapt_time;
    finer_first_ = !finer_first_;
  }
  rest(f);
  prefetch(f);
  if (report.bound_by == Binding::nothing && f.aim > f.floor) report.bound_by = Binding::triangles;
  report.settled = settled_;
  report.triangles = pool.active_triangles();
  report.achieved = f.all_planned ? std::max(f.aim, f.undone_sse) : infinity;
  report.resident_bytes = cache_->resident_bytes();
  report.morphing = static_cast<std::uint32_t>(geomorphs_.vertices());
  report.upload_bytes = pool.upload_bytes() - f.upload_start + report.morphing * sizeof(DrawVertex);
  report.adapt_ms = clock_() - f.start_ms;
  const auto share = [](double used, double budget) { return used / budget; };
  load_ =
      std::max({share(static_cast<double>(report.triangles), static_cast<double>(budgets.triangles)),
                share(report.adapt_ms, budgets.adapt_ms),
                share(static_cast<double>(report.upload_bytes), static_cast<double>(budgets.upload_bytes))});
  report_ = report;
  return report;
}

AdaptReport Cut::settle(const ErrorScale& scale, double tau, const Budgets& budgets, int max_calls) {
  AdaptReport sum;
  follow(scale, tau, budgets);
  still_frames_ = frames_to_rest;
  const double blends_ms = geomorphs_.duration_ms();
  geomorphs_.set_duration_ms(0);
  for (int call = 0; call < max_calls; ++call) {
    AdaptReport last = adapt(scale, tau, budgets);
    if (last.pages_missing > 0 && last.bound_by != Binding::adapt_time) cache_->wait();
    last.add_work_of(sum);
    sum = last;
    if (sum.settled) break;
  }
  geomorphs_.set_duration_ms(blends_ms);
  sum.achieved = achieved(scale);
  return sum;
}

double Cut::achieved(const ErrorScale& scale) const {
  double worst = 0;
  for (const PageId id : cache_->resident_ids()) {
    const ResidentPage& page = *cache_->resident(id);
    const double factor = factor_of(scale, id);
    for (std::size_t f = 0; f < page.fans().size(); ++f) {
      const FanState& fan = page.fans()[f];
      if (fan.applied > 0)
        worst = std::max(worst, scale.sse(decode_error(page.children(fan)[fan.applied - 1u].error),
                                          page.sphere(f), factor));
    }
  }
  for (PageId id = 0; id < directory().pages.size(); ++id) {
    const PageEntry& e = directory().pages[id];
    if (!cache_->resident(id))
      worst = std::max(worst, scale.sse(decode_error(e.largest_error), e.bound, scale.page_factor(e.bound)));
  }
  return worst;
}

DrawList Cut::draw_list(const std::optional<ErrorScale>& seen_from) {
  runs_.clear();
  drawn_.clear();
  for (const PageId id : cache_->resident_ids()) {
    if (seen_from && seen_from->invisible(directory().pages[id].bound)) continue;
    runs_.push_back(cache_->resident(id)->run());
    drawn_.push_back(id);
  }
  DrawList list = cache_->pool().draw_list(directory().grid, runs_, drawn_);
  list.morphed = geomorphs_.morphed();
  changed_vertices_.assign(list.changed_vertices.begin(), list.changed_vertices.end());
  const auto restored = geomorphs_.take_restored();
  changed_vertices_.insert(changed_vertices_.end(), restored.begin(), restored.end());
  list.changed_vertices = changed_vertices_;
  return list;
}

}  // namespace cuesta
