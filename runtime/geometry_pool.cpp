#include "runtime/geometry_pool.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "ooc/check.h"

namespace cuesta {

std::uint32_t RunAllocator::allocate(std::uint32_t count) {
  for (auto it = free_.begin(); it != free_.end(); ++it) {
    if (it->second < count) continue;
    const auto [first, size] = *it;
    free_.erase(it);
    if (size > count) free_.emplace(first + count, size - count);
    return first;
  }
  return std::exchange(end_, end_ + count);
}

void RunAllocator::release(std::uint32_t first, std::uint32_t count) {
  auto next = free_.lower_bound(first);
  if (next != free_.end() && first + count == next->first) {
    count += next->second;
    next = free_.erase(next);
  }
  if (next != free_.begin()) {
    auto before = std::prev(next);
    if (before->first + before->second == first) {
      first = before->first;
      count += before->second;
      free_.erase(before);
    }
  }
  if (first + count == end_)
    end_ = first;
  else
    free_.emplace(first, count);
}

GeometryPool::RunId GeometryPool::add(std::uint32_t vertices, std::uint32_t triangles) {
  PageRun r;
  r.vertices = vertices;
  r.first_vertex = vertices > 0 ? vertex_runs_.allocate(vertices) : 0;
  const std::uint32_t blocks = (triangles + block - 1) / block;
  const std::uint32_t first_block = blocks > 0 ? block_runs_.allocate(blocks) : 0;
  r.first_triangle = first_block * block;
  r.triangles = blocks * block;
  RunId id = static_cast<RunId>(runs_.size());
  if (free_runs_.empty()) {
    runs_.push_back(r);
  } else {
    id = free_runs_.back();
    free_runs_.pop_back();
    runs_[id] = r;
  }
  if (vertices_.size() < vertex_runs_.end()) vertices_.resize(vertex_runs_.end());
  if (has_texcoords_) texcoords_.resize(vertices_.size());
  const std::size_t end = std::size_t{block_runs_.end()} * block;
  if (place_.size() < end) {
    indices_.resize(end * 3);
    place_.resize(end);
    at_place_.resize(end);
    owner_.resize(block_runs_.end());
  }
  const auto handles = std::span(place_).subspan(r.first_triangle, r.triangles);
  std::iota(handles.begin(), handles.end(), r.first_triangle);
  std::copy(handles.begin(), handles.end(), at_place_.begin() + r.first_triangle);
  std::fill_n(owner_.begin() + first_block, blocks, id);
  if (vertices > 0) new_vertices_.push_back({r.first_vertex, vertices});
  return id;
}

void GeometryPool::remove(RunId run) {
  PageRun& r = runs_[run];
  active_ -= r.active;
  if (r.vertices > 0) vertex_runs_.release(r.first_vertex, r.vertices);
  if (r.triangles > 0) block_runs_.release(r.first_triangle / block, r.triangles / block);
  r = {};
  free_runs_.push_back(run);
}

std::span<DrawVertex> GeometryPool::vertices(RunId run) {
  return std::span(vertices_).subspan(runs_[run].first_vertex, runs_[run].vertices);
}

std::span<TexCoord> GeometryPool::texcoords(RunId run) {
  if (!has_texcoords_) return {};
  return std::span(texcoords_).subspan(runs_[run].first_vertex, runs_[run].vertices);
}

void GeometryPool::swap_places(std::uint32_t a, std::uint32_t b) {
  if (a == b) return;
  std::swap_ranges(indices_.begin() + std::size_t{a} * 3, indices_.begin() + std::size_t{a} * 3 + 3,
                   indices_.begin() + std::size_t{b} * 3);
  std::swap(at_place_[a], at_place_[b]);
  place_[at_place_[a]] = a;
  place_[at_place_[b]] = b;
}

void GeometryPool::activate(TriangleHandle t) {
  PageRun& r = runs_[owner_[t / block]];
  const std::uint32_t to = r.first_triangle + r.active;
  CUESTA_CHECK(place_[t] >= to, t);
  swap_places(place_[t], to);
  ++r.active;
  ++active_;
  touch(r, to);
}

void GeometryPool::deactivate(TriangleHandle t) {
  PageRun& r = runs_[owner_[t / block]];
  const std::uint32_t last = r.first_triangle + r.active - 1;
  CUESTA_CHECK(r.active > 0 && place_[t] <= last, t);
  touch(r, place_[t]);
  swap_places(place_[t], last);
  --r.active;
  --active_;
}

DrawList GeometryPool::draw_list(const Grid& grid) {
  draws_.clear();
  changed_indices_.clear();
  changed_vertices_ = std::exchange(new_vertices_, {});
  for (PageRun& r : runs_) {
    if (r.active > 0) draws_.push_back({r.first_triangle * 3, r.active * 3});
    // Places behind the active ones are not drawn, and are uploaded when they become so.
    const std::uint32_t hi = std::min(r.changed_hi, r.first_triangle + r.active);
    if (r.changed_lo < hi) changed_indices_.push_back({r.changed_lo * 3, (hi - r.changed_lo) * 3});
    r.changed_lo = 0xFFFFFFFFu;
    r.changed_hi = 0;
  }
  return {grid, vertices_, texcoords_, indices_, draws_, changed_vertices_, changed_indices_};
}

}  // namespace cuesta
