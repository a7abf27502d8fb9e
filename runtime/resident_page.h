#pragma once
/// A page in memory, its script replayed into lists of what each substitution changes: FAN's removed(v) and
/// modified(v).

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hierarchy/directory.h"
#include "hierarchy/page.h"
#include "ooc/result.h"
#include "runtime/geometry_pool.h"

namespace cuesta {

/// State of a fan: how many of its substitutions are applied. Between fans of all resident pages these counts
/// are the cut.
struct FanState {
  std::uint32_t first_child;
  std::uint16_t child_count;
  std::uint16_t applied;
};

/// What one substitution changes is entries[first_entry … next child's first_entry): removed triangles, then
/// corners of modified ones.
struct ChildState {
  std::uint32_t from_slot, to_slot;
  std::uint32_t first_entry;
  std::uint16_t removed;
  ErrorCode8 error;
  bool joined;
};

/// About 60 bytes per owned triangle, its share of the pool included.
class ResidentPage {
 public:
  /// Replays `page` on top of its coarser pages, all resident, and enters its geometry into the pool. The
  /// page arrives fully coarse: nothing that is drawn changes (except for the base page, which draws its
  /// survivors).
  /// @error corrupt when the page does not fit the coarser ones.
  static Result<std::unique_ptr<ResidentPage>> create(PageId id, const Page& page,
                                                      std::span<ResidentPage* const> coarser,
                                                      GeometryPool& pool);
  ~ResidentPage();
  ResidentPage(const ResidentPage&) = delete;
  ResidentPage& operator=(const ResidentPage&) = delete;

  PageId id() const { return id_; }
  std::span<const FanState> fans() const { return fans_; }
  const Sphere& sphere(std::size_t fan) const { return spheres_[fan]; }
  std::span<const ChildState> children(const FanState& f) const {
    return std::span(children_).subspan(f.first_child, f.child_count);
  }
  /// Applies or undoes the fan's next substitution (with its joined ones). @pre there is one.
  void apply_next(std::size_t fan);
  void undo_last(std::size_t fan);
  /// Triangles that undo_last(fan) would add.
  std::uint32_t undo_gain(std::size_t fan) const;
  /// Number of substitutions applied, over all fans.
  std::uint32_t applied() const { return applied_; }
  std::uint32_t child_count() const { return static_cast<std::uint32_t>(children_.size() - 1); }
  bool fully_coarse() const { return applied_ == child_count(); }

  std::uint64_t bytes() const;
  std::uint32_t finer_residents = 0;  ///< pages that lean on this one; it cannot go before them
  std::uint64_t last_wanted = 0;      ///< frame

 private:
  friend class PageReplay;
  explicit ResidentPage(GeometryPool& pool) : pool_(pool) {}

  struct SourceTable {
    PageId page;
    std::uint32_t first_triangle;
    std::vector<std::uint32_t> triangles, vertices, local_vertices;
  };

  PageId id_ = 0;
  GeometryPool& pool_;
  GeometryPool::RunId run_ = GeometryPool::no_run;
  std::vector<std::uint32_t> vertex_slot_;   // per local vertex
  std::vector<std::uint32_t> triangle_ref_;  // per local triangle: handle · 4 + turn of its corners
  std::vector<FanState> fans_;
  std::vector<Sphere> spheres_;
  std::vector<ChildState> children_;    // one more than there are: the end of the last one's entries
  std::vector<std::uint32_t> entries_;  // removed: handle; modified: handle · 4 + corner
  std::vector<SourceTable> sources_;
  std::uint32_t applied_ = 0;
};

}  // namespace cuesta
