#pragma once
/// The cut: a legal set of applied substitutions, kept between frames and moved towards what a view asks for,
/// within hard budgets. DESIGN §3, invariants I1, I3 and I4; FAN §3.4 and §4.

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "hierarchy/cuesta_file.h"
#include "runtime/draw_list.h"
#include "runtime/error_scale.h"
#include "runtime/geomorph.h"
#include "runtime/operation_order.h"
#include "runtime/page_cache.h"
#include "runtime/page_demand.h"
#include "runtime/regulator.h"
#include "runtime/triangle_demand.h"
#include "runtime/visual_error.h"

namespace cuesta {

/// Hard limits of one adapt(). What is left undone goes on in the next.
struct Budgets {
  /// Time of adapt(), loads on the caller's own thread not counted. Looked at every few dozen operations.
  double adapt_ms = std::numeric_limits<double>::infinity();
  std::uint64_t triangles = std::numeric_limits<std::uint64_t>::max();
  std::uint32_t page_loads = std::numeric_limits<std::uint32_t>::max();  ///< pages asked for in this call
  /// Vertices and indices that the next draw_list() will have changed; a single substitution is done even if
  /// it alone is above.
  std::uint64_t upload_bytes = std::numeric_limits<std::uint64_t>::max();

  friend bool operator==(const Budgets&, const Budgets&) = default;
};

enum class Binding : std::uint8_t {
  nothing,
  adapt_time,
  triangles,
  page_loads,
  resident_bytes,
  upload_bytes
};

/// Which paths fans take. By itself near, slow ones take the fine path and others the coarse one; a camera at
/// rest ends on the fine path everywhere, so its cut does not tell how it came there.
enum class PathPolicy : std::uint8_t { by_motion, always_fine, always_coarse };

struct AdaptReport {
  std::uint64_t triangles = 0;          ///< of the cut after the call
  std::uint32_t coarse_operations = 0;  ///< fans merged or split as a whole
  std::uint32_t fine_operations = 0;    ///< single substitutions applied or undone
  std::uint32_t pages_loaded = 0;       ///< that became resident
  std::uint32_t pages_missing = 0;      ///< wanted, but not there yet
  std::uint32_t morphing = 0;           ///< vertices in the middle of a geomorph
  std::uint32_t blocks_tested = 0;      ///< of ActiveNodes::block fans
  double tau = 0;                       ///< threshold aimed at: the user's, or larger where a budget binds
  double achieved = 0;  ///< bound of the sse of applied substitutions, infinite while that is not known:
                        ///< pixels, world units for uniform cuts
  double adapt_ms = 0;
  double load_ms = 0;  ///< of loads on the caller's thread, beyond adapt_ms
  std::uint64_t resident_bytes = 0;
  std::uint64_t upload_bytes = 0;
  Binding bound_by = Binding::nothing;
  bool settled = false;  ///< another call with the same arguments would change nothing

  /// Adds the operations, pages and times of the calls before.
  void add_work_of(const AdaptReport& earlier);
};

/// Milliseconds since some fixed moment; given by the caller, for the runtime has no clock of its own.
using Clock = std::function<double()>;

class Cut {
 public:
  /// Opens with the coarsest cut, the base page resident.
  /// @param load_threads  that read and decode pages; 0: adapt() does it, and waits for it.   @error as
  /// PageCache::open.
  static Result<std::unique_ptr<Cut>> open(CuestaFile file, std::uint64_t cache_bytes, Clock clock,
                                           std::uint32_t load_threads = 0) {
    return open(std::move(file), cache_bytes, std::move(clock), page_loader(load_threads));
  }
  /// @param make_loader  as PageCache::open.
  static Result<std::unique_ptr<Cut>> open(CuestaFile file, std::uint64_t cache_bytes, Clock clock,
                                           const MakePageLoader& make_loader);

  /// Refines and coarsens until every substitution with sse > `tau` is undone and every other applied, or a
  /// budget binds. Coarsens by rising sse, refines by falling sse, so wherever it stops the cut is legal.
  /// Where the view does not change from call to call, the cut comes to rest at the one that the same
  /// arguments give from everywhere: with the least threshold that the triangle and byte budgets allow, and
  /// of the next step of thresholds the worst, as far as the triangles go.
  /// @param tau  pixels (uniform: world units); substitutions with sse ≤ tau are applied. Negative: nothing
  /// is applied, the full resolution.
  /// @post the cut is legal, also when pages are missing; triangles ≤ budget, unless the coarsest cut has
  /// more, or the cut came in above it and adapt_ms ended first.
  /// @error never; pages that cannot be read are in cache().errors(), and are drawn coarser.
  /// A triangle budget below what is drawn is answered with a count of all fans, beyond adapt_ms, once.
  /// @cost O(resident pages + blocks without slack + changes); O(1) at rest. No allocation after warm-up but
  /// for pages.
  AdaptReport adapt(const ErrorScale& scale, double tau, const Budgets& budgets);

  /// adapt() until it is settled or `max_calls` is reached, waiting for pages; the last report, with sums of
  /// operations and times, and the exact `achieved`.
  AdaptReport settle(const ErrorScale& scale, double tau, const Budgets& budgets, int max_calls = 1000);

  /// Largest sse of an applied substitution and of what is not resident.   @cost O(fans of resident pages +
  /// pages).
  double achieved(const ErrorScale& scale) const;

  void set_path_policy(PathPolicy policy) { policy_ = policy, settled_ = false; }
  /// What faces the eye may be coarser; off by default. Pages are loaded as without it.
  void set_visual_error(const VisualError& visual) { visual_ = visual, scale_.reset(); }
  /// Length of the blends on the fine path; 0, the default: none. settle() ends all that are under way.
  void set_geomorph_ms(double ms) { geomorphs_.set_duration_ms(ms); }
  /// Blocks of many pages are tested by all threads of the caller's oneTBB arena; off by default. The cut is
  /// the same.
  void set_parallel(bool on) { parallel_ = on; }
  /// Draw lists say how each triangle came to be drawn.
  void set_tagging(bool on) { cache_->pool().set_tagging(on); }

  PageCache& cache() { return *cache_; }
  const PageCache& cache() const { return *cache_; }
  const Directory& directory() const { return cache_->directory(); }
  /// All that is drawn, or without the pages that cannot be seen.
  DrawList draw_list() { return draw_list(std::nullopt); }
  DrawList draw_list(const std::optional<ErrorScale>& seen_from);

 private:
  Cut(std::unique_ptr<PageCache> cache, Clock clock)
      : cache_(std::move(cache)), clock_(std::move(clock)), geomorphs_(cache_->pool()) {}
  struct Frame;
  /// Blocks of one page to be looked at, and the fans that may have to move.
  struct PageTest {
    ResidentPage* page;
    double factor, limit;
    bool all;
    std::uint32_t blocks;
    std::vector<std::uint32_t> candidates;
  };
  void follow(const ErrorScale& scale, double tau, const Budgets& budgets);
  void recount();
  void choose_tau(Frame& f);
  void load_pages(Frame& f);
  void weigh_pages(const Frame& f);
  bool count_triangles(const Frame& f, double floor, bool in_time);
  double factor_of(const ErrorScale& scale, PageId id) const;
  void prefetch(Frame& f);
  double typical_distance(const Frame& f, const Sphere& bound) const;
  FanPath path_for(const Frame& f, const Sphere& bound, FanPath now) const;
  void note_nearest(const Frame& f);
  void plan(Frame& f);
  void make_test(const Frame& f, PageId id);
  void run_tests(const Frame& f);
  void plan_tests(Frame& f);
  void plan_fan(Frame& f, ResidentPage& page, std::uint32_t fan, double scale);
  void follow_merges(Frame& f);
  bool waits(Frame& f, const Operation& op);
  bool move(Frame& f, const Operation& op, std::uint16_t goal);
  bool coarsen(Frame& f);
  bool refine(Frame& f);
  void rest(Frame& f);
  bool out_of_time(const Frame& f, double share) const;

  std::unique_ptr<PageCache> cache_;
  Clock clock_;
  std::uint64_t frame_ = 0;
  // What the last call was given, and how the eye came here.
  std::optional<ErrorScale> scale_;
  double tau_ = 0;
  Budgets budgets_;
  std::uint32_t still_frames_ = 0;  // calls with the same arguments as the one before
  double travelled_ = 0;            // grid units
  Vec3d velocity_{};                // grid units per frame, smoothed
  double nearest_ = 0;              // distance of the nearest page on the cut, grid units
  PathPolicy policy_ = PathPolicy::by_motion;

  VisualError visual_;
  std::vector<double> visual_factor_;  // per page; empty where it is off
  Geomorphs geomorphs_;
  PageDemand demand_, predicted_;
  Regulator regulator_;
  TriangleDemand triangle_demand_;
  std::optional<double> rest_tau_;  // what the triangle budget allows here, once it is known
  bool counted_ = false;            // by triangle_demand_, with the pages that are resident
  bool filling_ = false;  // at rest at rest_tau_; the worst of what is next take what is left of the budget
  double load_ = 0;       // share of the tightest budget that the last frame used
  bool settled_ = false, finer_first_ = false;
  bool shrunk_ = false;  // the triangle budget has just become smaller
  AdaptReport report_;
  OperationOrder coarsen_{OperationOrder::Direction::rising}, refine_{OperationOrder::Direction::falling};
  bool parallel_ = false;
  std::size_t test_count_ = 0;
  std::vector<PageTest> tests_;  // the first test_count_ are in use; the others keep their memory
  std::vector<GeometryPool::RunId> runs_;
  std::vector<PageId> drawn_;
  std::vector<Range> changed_vertices_;
};

}  // namespace cuesta
