#include "apps/cuesta/open_cut.h"

#include <algorithm>

#include "apps/cuesta/machine.h"
#include "apps/cuesta/stop_signal.h"

namespace cuesta::app {
namespace {

constexpr std::uint32_t pages_per_call = 32;  // so that the progress line moves, and a stop is noticed
constexpr int most_calls = 100000;            // more than any file needs; a cut that does not settle ends too

}  // namespace

Result<std::unique_ptr<Cut>> open_cut(const std::filesystem::path& path, std::uint64_t cache_bytes,
                                      std::uint32_t load_threads, Clock clock) {
  auto file = CuestaFile::open(path);
  if (!file) return fail(file.error());
  return Cut::open(std::move(*file), cache_bytes > 0 ? cache_bytes : physical_memory_bytes() / 2,
                   std::move(clock), load_threads);
}

Result<AdaptReport> settle_cut(Cut& cut, const ErrorScale& scale, double tau, Budgets budgets,
                               Progress& progress) {
  budgets.page_loads = std::min(budgets.page_loads, pages_per_call);
  AdaptReport sum;
  for (int call = 0; call < most_calls && !sum.settled; ++call) {
    if (!progress.update("adapt", Unit::pages, cut.cache().resident_ids().size(), 0)) break;
    AdaptReport last = cut.adapt(scale, tau, budgets);
    if (last.pages_missing > 0 && !cut.cache().loads_inline()) cut.cache().wait();
    last.add_work_of(sum);
    sum = last;
  }
  sum.achieved = cut.achieved(scale);
  if (auto r = check_stop(); !r) return fail(r.error());
  return sum;
}

const char* name(Binding binding) {
  switch (binding) {
    case Binding::nothing:
      return "nothing";
    case Binding::adapt_time:
      return "adapt time";
    case Binding::triangles:
      return "triangles";
    case Binding::page_loads:
      return "page loads";
    case Binding::resident_bytes:
      return "resident bytes";
    case Binding::upload_bytes:
      return "upload bytes";
  }
  return "nothing";
}

}  // namespace cuesta::app
