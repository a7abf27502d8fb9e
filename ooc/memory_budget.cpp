#include "ooc/memory_budget.h"

#include <fmt/format.h>

#include <algorithm>

namespace cuesta {
namespace {

std::uint64_t mebibytes_up(std::uint64_t bytes) {
  return (bytes + (std::uint64_t{1} << 20) - 1) >> 20;
}

}  // namespace

Result<MemoryBudget::Reservation> MemoryBudget::reserve(std::uint64_t bytes, std::string_view what) {
  std::uint64_t used = used_.load();
  do {
    if (bytes > limit_ - std::min(limit_, used))
      return fail(
          ErrorCode::out_of_budget, "", "",
          fmt::format("{} would need {} MiB of memory, {} MiB of {} MiB are free; give more with "
                      "--memory",
                      what, mebibytes_up(bytes), (limit_ - std::min(limit_, used)) >> 20, limit_ >> 20));
  } while (!used_.compare_exchange_weak(used, used + bytes));
  return Reservation(this, bytes);
}

Result<std::pair<MemoryBudget::Reservation, std::size_t>> MemoryBudget::reserve_some(std::uint64_t bytes,
                                                                                     std::size_t most,
                                                                                     std::string_view what) {
  const std::uint64_t free = limit_ - std::min(limit_, used_.load());
  const std::uint64_t fit = bytes > 0 ? free / bytes : most;
  const std::size_t count = static_cast<std::size_t>(std::clamp<std::uint64_t>(fit, 1, most));
  auto reservation = reserve(bytes * count, what);
  if (!reservation) return fail(reservation.error());
  return std::pair{std::move(*reservation), count};
}

}  // namespace cuesta
