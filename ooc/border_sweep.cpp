#include "ooc/border_sweep.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace cuesta {
namespace {

constexpr double order_length = 746.0;  ///< at least the length of (577, 408, 239)

std::int64_t square_distance(Vec3i a, Vec3i b) {
  const std::int64_t x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return x * x + y * y + z * z;
}

/// To the side of its cell that a coordinate is nearer to.
std::int32_t nearer_side(std::int32_t p, std::int32_t cell) {
  return p % cell < cell / 2 ? -1 : 1;
}

}  // namespace

std::int64_t BorderSweep::reach_of(double tolerance) {
  return static_cast<std::int64_t>(std::ceil(tolerance * (order_length * (1 + 1e-9)))) + 1;
}

BorderSweep::BorderSweep(double tolerance)
    : reach_(reach_of(tolerance)),
      // A distance that is the tolerance but for rounding is within it.
      most_square_(static_cast<std::int64_t>(tolerance * tolerance * (1 + 1e-9))),
      cell_(static_cast<std::int32_t>(std::ceil(tolerance)) * 2 + 2) {}

void BorderSweep::add(Vec3i p) {
  settle(&p);
  if (!nearest(p)) {
    centres_.push_back(p);
    cells_[cell_of(p)].push_back(p);
  }
  waiting_.push_back(p);
}

bool BorderSweep::take(std::pair<Vec3i, Vec3i>& point_and_centre) {
  if (settled_.empty()) return false;
  point_and_centre = settled_.front();
  settled_.pop_front();
  return true;
}

const Vec3i* BorderSweep::nearest(Vec3i p) const {
  const Vec3i home = cell_of(p);
  const Vec3i side{nearer_side(p.x, cell_), nearer_side(p.y, cell_), nearer_side(p.z, cell_)};
  const Vec3i* best = nullptr;
  std::tuple<std::int64_t, std::int64_t, Vec3i> best_rank;
  for (int i = 0; i < 8; ++i) {
    const Vec3i cell{home.x + (i & 1 ? side.x : 0), home.y + (i & 2 ? side.y : 0),
                     home.z + (i & 4 ? side.z : 0)};
    const auto found = cells_.find(cell);
    if (found == cells_.end()) continue;
    for (const Vec3i& c : found->second) {
      const std::int64_t square = square_distance(p, c);
      if (square > most_square_) continue;
      const std::tuple rank{square, order(c), c};
      if (best && !(rank < best_rank)) continue;
      best = &c;
      best_rank = rank;
    }
  }
  return best;
}

void BorderSweep::settle(const Vec3i* next) {
  while (!waiting_.empty() && (!next || order(waiting_.front()) + reach_ < order(*next))) {
    const Vec3i p = waiting_.front();
    settled_.emplace_back(p, *nearest(p));
    waiting_.pop_front();
  }
  if (!next) return;
  const std::int64_t oldest = order(waiting_.empty() ? *next : waiting_.front()) - reach_;
  for (; !centres_.empty() && order(centres_.front()) < oldest; centres_.pop_front())
    forget(centres_.front());
}

void BorderSweep::forget(Vec3i centre) {
  const auto cell = cells_.find(cell_of(centre));
  std::erase(cell->second, centre);
  if (cell->second.empty()) cells_.erase(cell);
}

}  // namespace cuesta
