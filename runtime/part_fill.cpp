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

void PartFill::add(std::uint32_t part, double pixels, double bounds) {
  Part& p = parts_[part];
  if (!(p.bounds > 0)) seen_.push_back(part);
  p.pixels += static_cast<float>(pixels), p.bounds += static_cast<float>(bounds);
}

void PartFill::learn() {
  double pixels = 0, bounds = 0;
  for (const std::uint32_t part : seen_) {
    Part& p = parts_[part];
    if (!(p.bounds > 0)) continue;
    pixels += double(p.pixels), bounds += double(p.bounds);
    blend(p.share, double(p.pixels) / double(p.bounds));
    p.pixels = p.bounds = 0;
  }
  seen_.clear();
  if (bounds > 0) blend(share_of_all_, pixels / bounds);
}

}  // namespace cuesta
