#pragma once
/// Vertices and triangles of all resident pages, in the form in which they are drawn.
/// A page owns a run of vertex slots and a run of triangles; its active triangles are kept at the front of
/// its run.

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "runtime/draw_list.h"

namespace cuesta {

/// First-fit allocator of runs of integers, merging free neighbours.
class RunAllocator {
 public:
  /// @return first element of a run of `count` > 0; grows the end when no hole fits.
  std::uint32_t allocate(std::uint32_t count);
  void release(std::uint32_t first, std::uint32_t count);
  std::uint32_t end() const { return end_; }  ///< one past the highest element in use

 private:
  std::map<std::uint32_t, std::uint32_t> free_;  // first → count
  std::uint32_t end_ = 0;
};

/// Names a triangle as long as its page is resident.
using TriangleHandle = std::uint32_t;

/// 20 bytes per vertex slot; 20 bytes per triangle (three indices, its place, and who is at its place).
class GeometryPool {
 public:
  struct PageRun {
    std::uint32_t first_vertex = 0, vertices = 0;
    std::uint32_t first_triangle = 0, triangles = 0;  ///< handles; rounded up to whole blocks
    std::uint32_t active = 0;
    std::uint32_t changed_lo = 0xFFFFFFFFu, changed_hi = 0;  ///< places changed since the last draw_list()
  };
  using RunId = std::uint32_t;
  static constexpr RunId no_run = 0xFFFFFFFFu;

  /// @param texcoords  keep texture coordinates beside the vertices: 8 more bytes per slot
  explicit GeometryPool(bool texcoords = false) : has_texcoords_(texcoords) {}

  /// Room for a page; its triangles are inactive and hold no corners yet.
  RunId add(std::uint32_t vertices, std::uint32_t triangles);
  void remove(RunId run);
  const PageRun& run(RunId id) const { return runs_[id]; }

  std::span<DrawVertex> vertices(RunId run);
  /// As long as vertices(run), or empty without texture coordinates.
  std::span<TexCoord> texcoords(RunId run);
  const DrawVertex& vertex(std::uint32_t slot) const { return vertices_[slot]; }
  std::uint32_t corner(TriangleHandle t, std::uint32_t c) const {
    return indices_[std::size_t{place_[t]} * 3 + c];
  }
  void set_corner(TriangleHandle t, std::uint32_t c, std::uint32_t slot) {
    const std::uint32_t place = place_[t];
    indices_[std::size_t{place} * 3 + c] = slot;
    touch(runs_[owner_[t / block]], place);
  }
  bool active(TriangleHandle t) const {
    const PageRun& r = runs_[owner_[t / block]];
    return place_[t] < r.first_triangle + r.active;
  }
  void activate(TriangleHandle t);
  void deactivate(TriangleHandle t);
  std::uint64_t active_triangles() const { return active_; }

  /// What to draw; the ranges of what changed since the last call are part of it.
  DrawList draw_list(const Grid& grid);

 private:
  static constexpr std::uint32_t block = 256;  // triangles are handed out in blocks, each with one owner
  void touch(PageRun& r, std::uint32_t place) {
    r.changed_lo = std::min(r.changed_lo, place);
    r.changed_hi = std::max(r.changed_hi, place + 1);
  }
  void swap_places(std::uint32_t a, std::uint32_t b);

  RunAllocator vertex_runs_, block_runs_;
  bool has_texcoords_;
  std::vector<DrawVertex> vertices_;
  std::vector<TexCoord> texcoords_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::uint32_t> place_, at_place_;
  std::vector<RunId> owner_;  // per block
  std::vector<PageRun> runs_;
  std::vector<RunId> free_runs_;
  std::uint64_t active_ = 0;
  std::vector<Range> draws_, changed_vertices_, changed_indices_, new_vertices_;
};

}  // namespace cuesta
