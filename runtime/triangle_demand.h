#pragma once
/// The least threshold at which the triangles of a view fit a budget. Exact, so a cut that has come to rest
/// does not tell how it came there; counted a few pages at a time, so that no frame waits for it.

#include <cstdint>
#include <functional>
#include <vector>

#include "runtime/error_scale.h"
#include "runtime/page_cache.h"

namespace cuesta {

class TriangleDemand {
 public:
  void restart() { next_ = 0, running_ = false; }
  /// Goes on counting until it is done or `out_of_time`.
  /// @param factor  of a page, by its id
  /// @return true when done; the resident pages must not change from the first call to the last, a restart()
  /// aside.
  bool count(const PageCache& cache, const ErrorScale& scale, const std::function<double(PageId)>& factor,
             double floor, std::uint64_t triangle_budget, const std::function<bool()>& out_of_time);
  /// Of the count that is done: substitutions with sse up to this applied, the others undone, fits the
  /// budget. At least `floor`; infinite where nothing fits. Above `floor` one of 128 steps of an octave.
  double tau() const { return tau_; }
  /// The next step below tau(), which would not fit as a whole; tau() where there is none.
  double next_tau() const { return next_tau_; }

 private:
  void add_page(const ResidentPage& page, const ErrorScale& scale, double factor, double floor);
  void finish(double floor, std::uint64_t triangle_budget);

  bool running_ = false;
  std::size_t next_ = 0;
  std::uint64_t coarsest_ = 0;
  std::vector<std::uint64_t> gain_;
  double tau_ = 0, next_tau_ = 0;
};

}  // namespace cuesta
