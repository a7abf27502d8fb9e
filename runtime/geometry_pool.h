#pragma once
/// Vertices and triangles of all resident pages, in the form in which they are drawn.
/// A page owns blocks of vertex slots and blocks of triangles, wherever they were free, so whether a page
/// fits is a question of how many are free and of nothing else. Its active triangles are kept at the front of
/// its blocks.

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "hierarchy/directory.h"
#include "runtime/draw_list.h"

namespace cuesta {

/// Hands out the numbers below a capacity, one neighbour after the other where it can.
class BlockAllocator {
 public:
  explicit BlockAllocator(std::uint32_t capacity) : free_(capacity) {
    if (capacity > 0) runs_.emplace(0, capacity);
  }
  std::uint32_t free() const { return free_; }
  std::uint32_t end() const { return end_; }  ///< one past the highest number that was ever handed out
  /// `count` numbers, ascending; the lowest run that holds them all, else the lowest that are free.
  /// @pre count ≤ free().
  std::vector<std::uint32_t> allocate(std::uint32_t count);
  void release(std::span<const std::uint32_t> numbers);

 private:
  void release_run(std::uint32_t first, std::uint32_t count);
  std::map<std::uint32_t, std::uint32_t> runs_;  // of free numbers: first → count
  std::uint32_t free_;
  std::uint32_t end_ = 0;
};

/// Names a triangle as long as its page is resident.
using TriangleHandle = std::uint32_t;

/// 20 bytes per vertex slot (28 with texture coordinates); 20 bytes per triangle: three indices, its place,
/// and who is at its place. Threads: one, but for the init_ functions of different pages.
class GeometryPool {
 public:
  static constexpr std::uint32_t block = 256;  ///< vertex slots or triangles that are handed out together
  static constexpr std::uint32_t dirty_block = 64;  ///< triangles that are uploaded together
  static constexpr std::uint32_t dirty_bytes = dirty_block * 12;

  struct Capacity {
    std::uint32_t vertex_blocks = 0;
    std::uint32_t triangle_blocks = 0;
  };
  /// What a page owns. Triangle i has the handle triangle_blocks[i / block] · block + i % block, vertex i
  /// likewise.
  struct PageRun {
    std::vector<std::uint32_t> vertex_blocks, triangle_blocks;
    std::uint32_t vertices = 0;
    std::uint32_t active = 0;
    std::uint32_t uploaded_vertices = 0;
  };
  using RunId = std::uint32_t;
  static constexpr RunId no_run = 0xFFFFFFFFu;

  static std::uint32_t blocks_of(std::uint32_t elements) { return (elements + block - 1) / block; }
  /// Bytes of the pool that a page takes.
  static std::uint64_t page_bytes(std::uint32_t vertices, std::uint32_t triangles, bool texcoords);
  /// Enough for every page of a file, and not more than `budget_bytes` can hold.
  /// @param charges  bytes of the budget that each page takes at least: no more pages than they allow have
  /// room.
  static Capacity capacity_for(const Directory& directory, std::uint64_t budget_bytes,
                               std::span<const std::uint64_t> charges);

  /// Reserves address space for all of the capacity; memory is taken when it is first written.
  GeometryPool(Capacity capacity, bool texcoords);

  bool fits(std::uint32_t vertices, std::uint32_t triangles) const;
  /// Room for a page; its triangles are inactive and hold no corners yet.   @pre fits().
  RunId add(std::uint32_t vertices, std::uint32_t triangles);
  void remove(RunId run);
  const PageRun& run(RunId id) const { return runs_[id]; }
  static std::uint32_t number(std::span<const std::uint32_t> blocks, std::uint32_t i) {
    return blocks[i / block] * block + i % block;
  }

  /// Before the first triangle of the page becomes active; on any thread.
  void init_vertex(std::uint32_t slot, const DrawVertex& vertex) { vertices_[slot] = vertex; }
  void init_texcoord(std::uint32_t slot, const TexCoord& texcoord) { texcoords_[slot] = texcoord; }
  void init_corner(TriangleHandle t, std::uint32_t c, std::uint32_t slot) {
    indices_[std::size_t{t} * 3 + c] = slot;
  }

  bool has_texcoords() const { return texcoords_ != nullptr; }
  const DrawVertex& vertex(std::uint32_t slot) const { return vertices_[slot]; }
  std::uint32_t corner(TriangleHandle t, std::uint32_t c) const {
    return indices_[std::size_t{place_[t]} * 3 + c];
  }
  void set_corner(TriangleHandle t, std::uint32_t c, std::uint32_t slot) {
    const std::uint32_t place = place_[t];
    indices_[std::size_t{place} * 3 + c] = slot;
    touch(place);
  }
  bool active(TriangleHandle t) const;
  void activate(TriangleHandle t);
  void deactivate(TriangleHandle t);
  std::uint64_t active_triangles() const { return active_; }

  /// Uploads of the page's vertices, at most `most_bytes` of them, are due in this frame.
  /// @return true when all of them have been.
  bool upload_vertices(RunId run, std::uint64_t most_bytes);
  /// Off: vertices of new pages are at once as good as uploaded, and in no list. For who sends vertices when
  /// they are first drawn.
  void set_vertex_uploads(bool on) { vertex_uploads_ = on; }
  /// What the next draw_list() will ask to upload.
  std::uint64_t upload_bytes() const { return vertex_upload_bytes_ + dirty_.size() * dirty_bytes; }

  /// Notes for draw_list() that a substitution of the given kind changed a triangle; nothing when `tagging`
  /// is off.
  void tag(TriangleHandle t, std::uint8_t kind) {
    if (tagging_) tagged_.push_back({t, kind});
  }
  void set_tagging(bool on) { tagging_ = on; }
  bool tagging() const { return tagging_; }

  /// What to draw of the runs, in the order given; the ranges of what changed since the last call are part of
  /// it.
  /// @param pages  of each run: what the list calls it.
  DrawList draw_list(const Grid& grid, std::span<const RunId> runs, std::span<const PageId> pages);

 private:
  struct Tag {
    TriangleHandle triangle;
    std::uint8_t kind;
  };
  void touch(std::uint32_t place) {
    std::uint8_t& flag = is_dirty_[place / dirty_block];
    if (flag) return;
    flag = 1;
    dirty_.push_back(place / dirty_block);
  }
  void swap_places(std::uint32_t a, std::uint32_t b);
  std::uint32_t ordinal(std::uint32_t place) const { return ordinal_[place / block] * block + place % block; }
  void collect_dirty();
  void mark_tags();

  BlockAllocator vertex_blocks_, triangle_blocks_;
  std::unique_ptr<DrawVertex[]> vertices_;
  std::unique_ptr<TexCoord[]> texcoords_;
  std::unique_ptr<std::uint32_t[]> indices_, place_, at_place_;
  std::vector<RunId> owner_;            // per triangle block
  std::vector<std::uint32_t> ordinal_;  // per triangle block: which of its page's it is
  std::vector<std::uint8_t> is_dirty_;
  std::vector<std::uint32_t> dirty_;
  std::vector<PageRun> runs_;
  std::vector<RunId> free_runs_;
  std::uint64_t active_ = 0;
  std::uint64_t vertex_upload_bytes_ = 0;
  bool vertex_uploads_ = true;
  bool tagging_ = false;
  std::vector<Tag> tagged_;
  std::vector<std::uint8_t> tags_;
  std::vector<Range> draws_, changed_vertices_, changed_indices_, new_vertices_;
  std::vector<PageId> draw_pages_;
};

}  // namespace cuesta
