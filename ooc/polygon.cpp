#include "ooc/polygon.h"

#include <cmath>

#include "ooc/check.h"

namespace cuesta {
namespace {

/// Twice the area vector (Newell), about the first corner so that far origins lose nothing.
Vec3d area_vector(std::span<const Vec3d> corners) {
  Vec3d sum;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum = sum + cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  }
  return sum;
}

template <class C>
double turn(const C& a, const C& b, const C& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

}  // namespace

std::span<const std::array<std::uint32_t, 3>> PolygonTriangulator::triangulate(
    std::span<const Vec3d> corners) {
  CUESTA_CHECK(corners.size() >= 3 && corners.size() < std::size_t{1} << 31, corners.size());
  triangles_.clear();
  triangles_.reserve(corners.size());
  const std::uint32_t n = static_cast<std::uint32_t>(corners.size());
  if (n == 3) {
    triangles_.push_back({0, 1, 2});
  } else if (project(corners)) {
    clip_ears();
  } else {
    for (std::uint32_t i = 2; i < n; ++i) triangles_.push_back({0, i - 1, i});
  }
  return triangles_;
}

bool PolygonTriangulator::project(std::span<const Vec3d> corners) {
  const Vec3d normal = area_vector(corners);
  const double size = length(normal);
  if (!(size > 0) || !std::isfinite(size)) return false;
  const Vec3d n = normal / size;
  const Vec3d helper = std::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = normalized(cross(helper, n));
  const Vec3d v = cross(n, u);
  const std::uint32_t count = static_cast<std::uint32_t>(corners.size());
  ring_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d d = corners[i] - corners[0];
    ring_[i] = {dot(d, u), dot(d, v), i + 1 == count ? 0 : i + 1, i == 0 ? count - 1 : i - 1, false};
  }
  reflex_.clear();
  reflex_.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    update_reflex(i);
    if (ring_[i].reflex) reflex_.push_back(i);
  }
  return true;
}

void PolygonTriangulator::update_reflex(std::uint32_t i) {
  Corner& c = ring_[i];
  c.reflex = !(turn(ring_[c.previous], c, ring_[c.next]) > 0);
}

/// Only reflex corners can lie in an ear. Corners on its border block it too, unless they are at one of its
/// tips (keyhole polygons visit a point twice).
bool PolygonTriangulator::is_ear(std::uint32_t i) {
  const Corner& b = ring_[i];
  if (b.reflex) return false;
  const Corner& a = ring_[b.previous];
  const Corner& c = ring_[b.next];
  for (std::size_t k = 0; k < reflex_.size();) {
    const std::uint32_t j = reflex_[k];
    const Corner& p = ring_[j];
    if (!p.reflex) {  // clipping only ever makes corners convex: it is not needed again
      reflex_[k] = reflex_.back();
      reflex_.pop_back();
      continue;
    }
    ++k;
    if (j == b.previous || j == b.next) continue;
    if (tests_left_ == 0) return false;
    --tests_left_;
    const bool at_tip =
        (p.x == a.x && p.y == a.y) || (p.x == b.x && p.y == b.y) || (p.x == c.x && p.y == c.y);
    if (!at_tip && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
  }
  return true;
}

void PolygonTriangulator::clip_ears() {
  std::uint32_t left = static_cast<std::uint32_t>(ring_.size());
  tests_left_ = std::uint64_t{1024} * left;
  std::uint32_t i = 0;
  std::uint32_t tried = 0;
  while (left > 3) {
    if (tried == left || tests_left_ == 0) return fan_rest(i, left);
    if (!is_ear(i)) {
      i = ring_[i].next;
      ++tried;
      continue;
    }
    const std::uint32_t before = ring_[i].previous;
    const std::uint32_t after = ring_[i].next;
    triangles_.push_back({before, i, after});
    ring_[before].next = after;
    ring_[after].previous = before;
    if (ring_[before].reflex) update_reflex(before);
    if (ring_[after].reflex) update_reflex(after);
    --left;
    tried = 0;
    i = ring_[after].next;  // not the neighbour: alternating keeps triangles fat
    if (left == 3) i = after;
  }
  fan_rest(i, left);
}

void PolygonTriangulator::fan_rest(std::uint32_t first, std::uint32_t left) {
  std::uint32_t second = ring_[first].next;
  for (std::uint32_t k = 2; k < left; ++k) {
    const std::uint32_t third = ring_[second].next;
    triangles_.push_back({first, second, third});
    second = third;
  }
}

}  // namespace cuesta
