#include "runtime/part_fill.h"

namespace cuesta {
namespace {

template <class T>
void blend(T& known, double now) {
  known = static_cast<T>(known < 0 ? now : (double(known) + now) / 2);
}

}  // namespace

double PartFill::share(std::uint32_t part) const {
  if (parts_[part].share >= 0) return double(parts_[part].share);
  return share_of_all_ >= 0 ? share_of_all_ : 1;
}

void PartFill::add(std::uint32_t part, double fragments, double bounds_px) {
  Part& p = parts_[part];
  if (!(p.bounds_px > 0)) seen_.push_back(part);
  p.fragments += static_cast<float>(fragments), p.bounds_px += static_cast<float>(bounds_px);
}

void PartFill::learn() {
  double fragments = 0, bounds_px = 0;
  for (const std::uint32_t part : seen_) {
    Part& p = parts_[part];
    if (!(p.bounds_px > 0)) continue;
    fragments += double(p.fragments), bounds_px += double(p.bounds_px);
    blend(p.share, double(p.fragments) / double(p.bounds_px));
    p.fragments = p.bounds_px = 0;
  }
  seen_.clear();
  if (bounds_px > 0) blend(share_of_all_, fragments / bounds_px);
}

}  // namespace cuesta
