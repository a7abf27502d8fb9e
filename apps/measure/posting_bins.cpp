#include "apps/measure/posting_bins.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/measure/vertical_error.h"

namespace cuesta::measure {
namespace {

constexpr double postings_per_bin = 2;
constexpr double earth_radius_m = 6.35e6;  // not more than the ellipsoid's least
constexpr double second_eccentricity_sq = 0.00674;
constexpr double largest_stretch = 3;  // of angles, at the corners of a cube's face
constexpr double least_cosine = 0.2;   // to a face's axis, for a corner to have a place on its plane
constexpr double rounding = 1e-6;      // of a bin: far above the rounding of what is clipped

/// How far the up lines over a triangle may leave the plane of those of its corners, in radians. On a sphere
/// they do not. On the ellipsoid the normal at a point is off the point's own direction by e'² of it times
/// the height, so what counts is the heights' difference over the triangle: the sagitta, and as much of the
/// height as up turns.
double bulge_rad(double longest_edge_m) {
  const double sagitta_m = longest_edge_m * longest_edge_m / (8 * earth_radius_m);
  const double turned_m = most_height_m * longest_edge_m / earth_radius_m;
  return 2 * second_eccentricity_sq * (sagitta_m + turned_m) / earth_radius_m;
}

double longest_edge_m(const UprightTriangle& t) {
  return std::max({length(t.at[1] - t.at[0]), length(t.at[2] - t.at[1]), length(t.at[0] - t.at[2])});
}

/// Grid line below x, for numbers far beyond the grid too.
std::uint32_t place(double x, double lo, double bin, std::uint32_t count) {
  const double at = std::floor((x - lo) / bin);
  return at <= 0 ? 0 : at >= count ? count : static_cast<std::uint32_t>(at);
}

}  // namespace

PostingBins::PostingBins(std::span<const Vec3d> positions, std::span<const Vec3d> ups,
                         std::span<const std::uint32_t> ids)
    : positions_(positions), ups_(ups) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < (on_plane() ? 1u : 6u); ++f)
    faces_.push_back({.axis = on_plane() ? 2 : static_cast<int>(f / 2),
                      .sign = f % 2 == 0 ? 1.0 : -1.0,
                      .lo = {inf, inf},
                      .hi = {-inf, -inf}});
  std::vector<std::uint64_t> postings(faces_.size());
  for (const std::uint32_t id : ids) {
    const std::size_t f = face_of(id);
    const Point p = point_of(id, faces_[f]);
    ++postings[f];
    for (std::size_t k = 0; k < 2; ++k) {
      faces_[f].lo[k] = std::min(faces_[f].lo[k], p[k]);
      faces_[f].hi[k] = std::max(faces_[f].hi[k], p[k]);
    }
  }
  std::uint32_t bins = 0;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    lay_out(faces_[f], postings[f], bins);
    bins += faces_[f].columns * faces_[f].rows;
  }
  std::vector<std::uint32_t> bin(ids.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, ids.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) bin[i] = bin_of(ids[i]);
  });
  begin_.assign(std::size_t{bins} + 1, 0);
  for (const std::uint32_t b : bin) ++begin_[b + 1];
  for (std::size_t b = 0; b < bins; ++b) begin_[b + 1] += begin_[b];
  order_.resize(ids.size());
  for (std::size_t i = ids.size(); i-- > 0;) order_[--begin_[bin[i] + 1]] = ids[i];
  // Each begin_[b + 1] is now where bin b begins.
  begin_.erase(begin_.begin());
  begin_.push_back(static_cast<std::uint32_t>(ids.size()));
}

std::size_t PostingBins::face_of(std::uint32_t id) const {
  if (on_plane()) return 0;
  const Vec3d up = ups_[id];
  int axis = 0;
  for (const int other : {1, 2})
    if (std::abs(up[other]) > std::abs(up[axis])) axis = other;
  return static_cast<std::size_t>(2 * axis + (up[axis] < 0));
}

PostingBins::Point PostingBins::point_of(std::uint32_t id, const Face& face) const {
  if (on_plane()) return {positions_[id].x, positions_[id].y};
  const Vec3d up = ups_[id];
  const double d = up[face.axis] * face.sign;
  return {up[(face.axis + 1) % 3] / d, up[(face.axis + 2) % 3] / d};
}

void PostingBins::lay_out(Face& face, std::uint64_t postings, std::uint32_t first_bin) {
  face.first = first_bin;
  if (postings == 0) return;
  const double bins = std::max(1.0, static_cast<double>(postings) / postings_per_bin);
  const double width = face.hi[0] - face.lo[0], height = face.hi[1] - face.lo[1];
  face.bin = std::max(std::sqrt(width * height / bins), std::max(width, height) / bins);
  if (!(face.bin > 0)) face.bin = 1;
  face.columns = static_cast<std::uint32_t>(width / face.bin) + 1;
  face.rows = static_cast<std::uint32_t>(height / face.bin) + 1;
}

std::uint32_t PostingBins::bin_of(std::uint32_t id) const {
  const Face& face = faces_[face_of(id)];
  const Point p = point_of(id, face);
  const std::uint32_t column = std::min(place(p[0], face.lo[0], face.bin, face.columns), face.columns - 1);
  const std::uint32_t row = std::min(place(p[1], face.lo[1], face.bin, face.rows), face.rows - 1);
  return face.first + row * face.columns + column;
}

PostingBins::Shadow PostingBins::shadow_of(const UprightTriangle& t, const Face& face, double slack_m) const {
  Shadow shadow;
  shadow.pad = rounding * face.bin + slack_m;
  for (std::size_t k = 0; k < 3; ++k) shadow.corner[k] = {t.at[k].x, t.at[k].y};
  if (!on_plane()) {
    shadow.pad =
        rounding * face.bin + largest_stretch * (bulge_rad(longest_edge_m(t)) + slack_m / earth_radius_m);
    double most = -1, least = 1;  // cosines to the face's axis
    for (std::size_t k = 0; k < 3; ++k) {
      const double d = t.up[k][face.axis] * face.sign;
      most = std::max(most, d);
      least = std::min(least, d);
      shadow.corner[k] = {t.up[k][(face.axis + 1) % 3] / d, t.up[k][(face.axis + 2) % 3] / d};
    }
    if (most <= 0 || face.rows == 0) return shadow;
    shadow.everywhere = least < least_cosine;
  }
  const auto [lo, hi] = std::minmax({shadow.corner[0][1], shadow.corner[1][1], shadow.corner[2][1]});
  const auto [left, right] = std::minmax({shadow.corner[0][0], shadow.corner[1][0], shadow.corner[2][0]});
  if (shadow.everywhere) {
    shadow.end_row = face.rows;
  } else if (lo - shadow.pad <= face.hi[1] && hi + shadow.pad >= face.lo[1] &&
             left - shadow.pad <= face.hi[0] && right + shadow.pad >= face.lo[0]) {
    shadow.first_row = std::min(place(lo - shadow.pad, face.lo[1], face.bin, face.rows), face.rows - 1);
    shadow.end_row = std::min(place(hi + shadow.pad, face.lo[1], face.bin, face.rows), face.rows - 1) + 1;
  }
  return shadow;
}

/// The bins of a row that the shadow's part in that row reaches, padded.
PostingBins::Run PostingBins::run(const Face& face, const Shadow& shadow, std::uint32_t row) const {
  double left = face.lo[0], right = face.hi[0];
  if (!shadow.everywhere) {
    // The last row also has what lies on its upper edge and beyond: rows are cut off there.
    const double low = face.lo[1] + row * face.bin - shadow.pad;
    const double high = row + 1 == face.rows ? std::max(face.hi[1], low + face.bin) + 2 * shadow.pad
                                             : face.lo[1] + (row + 1) * face.bin + shadow.pad;
    left = std::numeric_limits<double>::infinity();
    right = -left;
    const auto add = [&](double x) {
      left = std::min(left, x - shadow.pad);
      right = std::max(right, x + shadow.pad);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const Point a = shadow.corner[k], b = shadow.corner[(k + 1) % 3];
      if (a[1] >= low && a[1] <= high) add(a[0]);
      for (const double y : {low, high})
        if ((a[1] < y) != (b[1] < y)) add(a[0] + (b[0] - a[0]) * ((y - a[1]) / (b[1] - a[1])));
    }
    if (left > face.hi[0] || right < face.lo[0]) return {0, 0};
  }
  const std::uint32_t base = face.first + row * face.columns;
  return {begin_[base + std::min(place(left, face.lo[0], face.bin, face.columns), face.columns - 1)],
          begin_[base + std::min(place(right, face.lo[0], face.bin, face.columns), face.columns - 1) + 1]};
}

}  // namespace cuesta::measure
