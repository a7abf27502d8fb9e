#include "hierarchy/tom_cursor.h"

#include <algorithm>
#include <cmath>

#include "ooc/check.h"

namespace cuesta {
namespace {

/// @param to  as many elements as `from`; may be the same
void look_up(std::span<const Triangle> from, const std::uint32_t* table, Triangle* to) {
  for (std::size_t i = 0; i < from.size(); ++i)
    to[i] = {table[from[i][0]], table[from[i][1]], table[from[i][2]]};
}

}  // namespace

/// The lowest rung ≥ n: rungs are full() / 2^(k / rungs_per_octave).
Resolution TomCursor::rung_above(Resolution n) const {
  const double full = tom_.full();
  const double k = std::floor(rungs_per_octave * std::log2(full / std::max<double>(n, 1)));
  const auto rung = static_cast<Resolution>(std::ceil(full / std::exp2(k / rungs_per_octave)));
  return std::clamp(rung, n, tom_.full());
}

void TomCursor::move_to(Resolution rung) {
  const std::uint32_t triangles = triangle_count(tom_, rung);
  if (rung < rung_) {
    fill_table(rung);
    corners_.resize(triangles);
    look_up(corners_, table_.data(), corners_.data());
  } else {
    corners_.resize(triangles);
    for (std::uint32_t t = 0; t < triangles; ++t) corners_[t] = active_corners(tom_, tom_.triangles[t], rung);
  }
  rung_ = rung;
  table_for_ = 0;
}

/// Substitutes precede: one pass upwards. What was active before and is now stays as it is.
void TomCursor::fill_table(Resolution n) {
  table_.resize(rung_);
  for (Resolution v = std::min(table_for_, n); v < n; ++v) table_[v] = v;
  for (Resolution v = n; v < rung_; ++v) table_[v] = table_[tom_.substitute[v]];
  table_for_ = n;
}

std::uint32_t TomCursor::count(Resolution n) {
  if (counted_ != n) {
    count_ = triangle_count(tom_, n);
    counted_ = n;
  }
  return count_;
}

TomCursor::View TomCursor::prepare(Resolution n) {
  CUESTA_CHECK(n >= tom_.base_vertices && n <= tom_.full(), n);
  const std::uint32_t triangles = count(n);
  if (const Resolution rung = rung_above(n); rung != rung_) move_to(rung);
  if (n != rung_ && table_for_ != n) fill_table(n);
  return {std::span(corners_).first(triangles), n == rung_ ? nullptr : table_.data()};
}

std::uint32_t TomCursor::extract(Resolution n, std::span<Triangle> out) {
  const View view = prepare(n);
  CUESTA_CHECK(out.size() >= view.corners.size(), out.size(), view.corners.size());
  if (view.table == nullptr)
    std::copy(view.corners.begin(), view.corners.end(), out.begin());
  else
    look_up(view.corners, view.table, out.data());
  return static_cast<std::uint32_t>(view.corners.size());
}

}  // namespace cuesta
