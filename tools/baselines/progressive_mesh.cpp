#include "tools/baselines/progressive_mesh.h"

#include <algorithm>
#include <numeric>

#include "hierarchy/strip_reduction.h"
#include "ooc/check.h"
#include "ooc/edge_twins.h"

namespace cuesta::baselines {
namespace {

constexpr std::uint32_t next(std::uint32_t corner) {
  return corner == 2 ? 0 : corner + 1;
}
constexpr std::uint32_t previous(std::uint32_t corner) {
  return corner == 0 ? 2 : corner - 1;
}

/// Of the corners that is v; 3 if none is.
std::uint32_t corner_of(const Triangle& t, std::uint32_t v) {
  return t[0] == v ? 0 : t[1] == v ? 1 : t[2] == v ? 2 : 3;
}

struct Birth {
  std::uint32_t resolution;  // the lowest one at which the triangle is there
  Triangle corners;          // of the full mesh, turned to be (v, u, l) or (u, v, r) when u is split from v
};

Birth birth_of(const Triangle& full, std::span<const std::uint32_t> substitute, std::uint32_t base) {
  for (Triangle t = full;;) {
    const auto at = static_cast<std::uint32_t>(std::max_element(t.begin(), t.end()) - t.begin());
    if (t[at] < base) return {base, full};
    const std::uint32_t u = t[at], v = substitute[u];
    const std::uint32_t first = t[previous(at)] == v ? previous(at) : at;
    if (t[first] == v || t[next(at)] == v)
      return {u + 1, {full[first], full[next(first)], full[previous(first)]}};
    t[at] = v;
  }
}

std::vector<Triangle> by_birth(std::span<const Triangle> triangles, std::span<const std::uint32_t> substitute,
                               std::uint32_t base) {
  std::vector<Birth> births;
  for (const Triangle& t : triangles)
    if (!is_degenerate(t)) births.push_back(birth_of(t, substitute, base));
  std::stable_sort(births.begin(), births.end(),
                   [](const Birth& a, const Birth& b) { return a.resolution < b.resolution; });
  std::vector<Triangle> sorted;
  for (const Birth& b : births) sorted.push_back(b.corners);
  return sorted;
}

std::vector<Triangle> neighbours_of(std::span<const Triangle> triangles, std::uint32_t vertex_count) {
  std::vector<std::uint32_t> group(vertex_count);
  std::iota(group.begin(), group.end(), 0u);
  std::uint64_t edges_cut = 0;
  const auto twins = edge_twins(triangles, group, std::vector<std::uint8_t>(vertex_count), edges_cut);
  std::vector<Triangle> neighbours(triangles.size());
  for (std::size_t h = 0; h < twins.size(); ++h)
    neighbours[h / 3][h % 3] = twins[h] == kNone ? kNone : twins[h] / 3;
  return neighbours;
}

}  // namespace

ProgressiveMesh::ProgressiveMesh(std::span<const Triangle> triangles,
                                 std::span<const std::uint32_t> substitute, std::uint32_t base_resolution)
    : corners_(by_birth(triangles, substitute, base_resolution)),
      neighbours_(neighbours_of(corners_, static_cast<std::uint32_t>(substitute.size()))),
      splits_(substitute.size() - base_resolution),
      base_resolution_(base_resolution),
      resolution_(static_cast<std::uint32_t>(substitute.size())),
      triangle_count_(static_cast<std::uint32_t>(corners_.size())) {
  Stars stars(substitute.size());
  for (std::uint32_t f = 0; f < triangle_count_; ++f)
    for (const std::uint32_t v : corners_[f]) stars[v].push_back(f);
  while (resolution_ > base_resolution_) {
    const std::uint32_t u = resolution_ - 1, v = substitute[u], before = triangle_count_;
    if (!record(u, v, stars)) {
      splits_.erase(splits_.begin(), splits_.begin() + (resolution_ - base_resolution_));
      base_resolution_ = resolution_;
      break;
    }
    collapse();
    for (const std::uint32_t f : stars[u])
      if (f < triangle_count_) stars[v].push_back(f);
    for (std::uint32_t f = triangle_count_; f < before; ++f)
      for (const std::uint32_t w : corners_[f]) std::erase(stars[w], f);
    stars[u] = {};
  }
  set_resolution(static_cast<std::uint32_t>(substitute.size()));
}

/// What collapse() needs to take u away; false if u and what is around it are not as the class says.
bool ProgressiveMesh::record(std::uint32_t u, std::uint32_t v, const Stars& stars) {
  Sides beside{kNone, kNone};
  std::uint32_t faces = 0;  // of the fan
  for (const std::uint32_t f : stars[u]) {
    const std::uint32_t at_v = corner_of(corners_[f], v);
    if (at_v == 3) {
      ++faces;
      continue;
    }
    std::uint32_t& side = corners_[f][next(at_v)] == u ? beside.left : beside.right;
    if (side != kNone) return false;
    side = f;
  }
  const std::uint32_t new_faces = (beside.left != kNone) + (beside.right != kNone);
  if (new_faces == 0 || faces > 0xFFFF || (faces == 0 && new_faces == 2)) return false;
  Place first{};
  if (faces > 0) {
    first = begin_of_fan(u, beside, faces);
    if (!is_fan(first, u, faces, beside)) return false;
  } else {
    first.face = beside.left != kNone ? neighbours_[beside.left][2] : neighbours_[beside.right][1];
    if (first.face == kNone) return false;
    first.corner = corner_of(corners_[first.face], v);
  }
  splits_[u - base_resolution_] = {first.face,
                                   static_cast<std::uint16_t>(faces),
                                   static_cast<std::uint16_t>(first.corner & 3u),
                                   beside.left != kNone,
                                   beside.right != kNone,
                                   beside.right < beside.left};
  return true;
}

/// The face of the fan beside the left face, or else where the fan ends counter-clockwise.
ProgressiveMesh::Place ProgressiveMesh::begin_of_fan(std::uint32_t u, Sides beside,
                                                     std::uint32_t faces) const {
  const auto place = [&](std::uint32_t face) {
    return Place{face, face == kNone ? 3 : corner_of(corners_[face], u)};
  };
  if (beside.left != kNone) return place(neighbours_[beside.left][1]);
  Place p = place(neighbours_[beside.right][2]);
  for (std::uint32_t i = 1; i < faces && p.corner != 3; ++i)
    p = place(neighbours_[p.face][previous(p.corner)]);
  return p;
}

/// Whether so many faces lie clockwise around u from the first, then the right one or a border, and no other
/// is there.
bool ProgressiveMesh::is_fan(Place p, std::uint32_t u, std::uint32_t faces, Sides beside) const {
  if (p.corner == 3 || neighbours_[p.face][previous(p.corner)] != beside.left) return false;
  for (std::uint32_t i = 1; i < faces; ++i) {
    const std::uint32_t on = neighbours_[p.face][p.corner];
    if (on == kNone || on == beside.right) return false;
    p = clockwise(p, u);
    if (p.corner == 3) return false;
  }
  return neighbours_[p.face][p.corner] == beside.right;
}

std::uint64_t ProgressiveMesh::set_resolution(std::uint32_t resolution) {
  CUESTA_CHECK(resolution >= base_resolution_ && resolution <= vertex_count(), resolution, base_resolution_);
  std::uint64_t steps = 0;
  for (; resolution_ > resolution; ++steps) collapse();
  for (; resolution_ < resolution; ++steps) split();
  return steps;
}

ProgressiveMesh::Place ProgressiveMesh::clockwise(Place p, std::uint32_t around) const {
  const std::uint32_t face = neighbours_[p.face][p.corner];
  return {face, corner_of(corners_[face], around)};
}

ProgressiveMesh::Sides ProgressiveMesh::sides(const Split& split, std::uint32_t first) {
  if (!split.has_right) return {first, kNone};
  if (!split.has_left) return {kNone, first};
  return {first + split.right_first, first + !split.right_first};
}

void ProgressiveMesh::split() {
  const Split& s = splits_[resolution_ - base_resolution_];
  const std::uint32_t u = resolution_++, v = corners_[s.flclw][s.corner];
  const auto [left, right] = sides(s, triangle_count_);
  triangle_count_ += s.has_left + s.has_right;
  if (s.vlr_rot == 0) {
    const std::uint32_t edge = left != kNone ? s.corner : previous(s.corner);
    if (left != kNone) {
      corners_[left] = {v, u, corners_[s.flclw][next(s.corner)]};
      neighbours_[left] = {kNone, kNone, s.flclw};
    } else {
      corners_[right] = {u, v, corners_[s.flclw][edge]};
      neighbours_[right] = {kNone, s.flclw, kNone};
    }
    neighbours_[s.flclw][edge] = triangle_count_ - 1;
    return;
  }
  Place p{s.flclw, s.corner};
  corners_[p.face][p.corner] = u;
  for (std::uint32_t i = 1; i < s.vlr_rot; ++i) {
    p = clockwise(p, v);
    corners_[p.face][p.corner] = u;
  }
  if (left != kNone) {
    const std::uint32_t edge = previous(s.corner), beyond = neighbours_[s.flclw][edge];
    corners_[left] = {v, u, corners_[s.flclw][edge]};
    neighbours_[left] = {right, s.flclw, beyond};
    neighbours_[s.flclw][edge] = left;
    if (beyond != kNone) neighbours_[beyond][corner_of(corners_[beyond], v)] = left;
  }
  if (right != kNone) {
    const std::uint32_t beyond = neighbours_[p.face][p.corner];
    corners_[right] = {u, v, corners_[p.face][next(p.corner)]};
    neighbours_[right] = {left, beyond, p.face};
    neighbours_[p.face][p.corner] = right;
    if (beyond != kNone) neighbours_[beyond][previous(corner_of(corners_[beyond], v))] = right;
  }
}

void ProgressiveMesh::collapse() {
  const std::uint32_t u = --resolution_;
  const Split& s = splits_[u - base_resolution_];
  triangle_count_ -= s.has_left + s.has_right;
  const auto [left, right] = sides(s, triangle_count_);
  if (s.vlr_rot == 0) {
    neighbours_[s.flclw][left != kNone ? s.corner : previous(s.corner)] = kNone;
    return;
  }
  const std::uint32_t v = left != kNone ? corners_[left][0] : corners_[right][1];
  Place p{s.flclw, s.corner};
  corners_[p.face][p.corner] = v;
  for (std::uint32_t i = 1; i < s.vlr_rot; ++i) {
    p = clockwise(p, u);
    corners_[p.face][p.corner] = v;
  }
  if (left != kNone) {
    const std::uint32_t beyond = neighbours_[left][2];
    neighbours_[s.flclw][previous(s.corner)] = beyond;
    if (beyond != kNone) neighbours_[beyond][corner_of(corners_[beyond], v)] = s.flclw;
  }
  if (right != kNone) {
    const std::uint32_t beyond = neighbours_[right][1];
    neighbours_[p.face][p.corner] = beyond;
    if (beyond != kNone) neighbours_[beyond][previous(corner_of(corners_[beyond], v))] = p.face;
  }
}

std::size_t ProgressiveMesh::write_indices(std::span<std::uint32_t> out) const {
  CUESTA_CHECK(out.size() >= corners_.size() * 3, out.size(), corners_.size());
  std::copy_n(corners_.data()->data(), std::size_t{triangle_count_} * 3, out.data());
  return std::size_t{triangle_count_} * 3;
}

std::uint64_t ProgressiveMesh::bytes() const {
  return corners_.size() * sizeof(Triangle) + neighbours_.size() * sizeof(Triangle) +
         splits_.size() * sizeof(Split);
}

}  // namespace cuesta::baselines
