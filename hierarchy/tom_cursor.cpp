#include "hierarchy/tom_cursor.h"

#include <algorithm>
#include <cmath>

#include "ooc/check.h"

namespace cuesta {

/// Rungs are full() / 2^(k / rungs_per_octave).
void TomCursor::move_to_rung_above(Resolution n) {
  const double full = tom_.full();
  const double k = std::floor(rungs_per_octave * std::log2(full / n));
  const auto rung_at = [&](double i) {
    return static_cast<Resolution>(std::ceil(full / std::exp2(i / rungs_per_octave)));
  };
  const Resolution rung = std::clamp(rung_at(k), n, tom_.full());
  const std::uint32_t triangles = triangle_count(tom_, rung);
  corners_.resize(triangles);
  if (rung < rung_) {
    ancestors_.fill(tom_.substitute, rung, rung_);
    ancestors_.look_up(corners_, corners_.data());
  } else {
    extract_triangles(tom_, rung, corners_);
  }
  rung_ = rung;
  lowest_ = std::min(rung_at(k + 1) + 1, n);
}

void TomCursor::prepare(Resolution n) {
  CUESTA_CHECK(n >= tom_.base_vertices && n <= tom_.full(), n);
  if (n == at_) return;
  if (n < lowest_ || n > rung_) move_to_rung_above(n);
  ancestors_.fill(tom_.substitute, n, rung_);
  const auto lives = [ancestor = ancestors_.lookup()](const Triangle& t) {
    return !is_degenerate(ancestor(t));
  };
  const auto end = std::partition_point(corners_.begin(), corners_.end(), lives);
  count_ = static_cast<std::uint32_t>(end - corners_.begin());
  at_ = n;
}

std::uint32_t TomCursor::extract(Resolution n, std::span<Triangle> out) {
  prepare(n);
  CUESTA_CHECK(out.size() >= count_, out.size(), count_);
  Triangle* to = out.data();
  visit(n, [&to](const Triangle& t) { *to++ = t; });
  return count_;
}

}  // namespace cuesta
