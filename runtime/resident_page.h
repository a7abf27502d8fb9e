#pragma once
/// A page in memory, its script replayed into lists of what each substitution changes: FAN's removed(v) and
/// modified(v).

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hierarchy/directory.h"
#include "hierarchy/page.h"
#include "hierarchy/survivor_places.h"
#include "ooc/result.h"
#include "runtime/active_nodes.h"
#include "runtime/geometry_pool.h"
#include "runtime/visual_error.h"

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

/// Which of its two paths a fan takes. Both end at the same mesh. On the coarse path a fan is applied when
/// all its substitutions may be and split as a whole; what lies between is left alone, which is as legal:
/// what leans on a fan has at least the error of its last substitution.
enum class FanPath : std::uint8_t { fine, coarse };

class ResidentPage {
 public:
  /// Replays `page` on top of its coarser pages, all resident, and enters its geometry into `run` of the
  /// pool. The page arrives fully coarse. Reads of the coarser pages and of the pool only what does not
  /// change while they are resident, so any thread may do it while another one adapts.
  /// @param run  GeometryPool::add() of the owned vertices and triangles in the page's directory entry.
  /// @error corrupt when the page does not fit the coarser ones or the run.
  static Result<std::unique_ptr<ResidentPage>> create(PageId id, const Page& page,
                                                      std::span<const ResidentPage* const> coarser,
                                                      GeometryPool& pool, GeometryPool::RunId run,
                                                      const GeometryPool::PageRun& blocks);
  ResidentPage(const ResidentPage&) = delete;
  ResidentPage& operator=(const ResidentPage&) = delete;

  PageId id() const { return id_; }
  /// Adds what a finer page needs to be decoded. Any thread may call it, as create().
  void place_survivors(PageId finer, SurvivorPlaces& places) const;
  GeometryPool::RunId run() const { return run_; }
  std::span<const FanState> fans() const { return fans_; }
  const Sphere& sphere(std::size_t fan) const { return spheres_[fan]; }
  std::span<const ChildState> children(const FanState& f) const {
    return std::span(children_).subspan(f.first_child, f.child_count);
  }
  /// Calls `visit` with every triangle that the substitution removes or modifies.
  template <class Visit>
  void for_each_changed(const ChildState& c, Visit visit) const {
    const std::uint32_t modified = c.first_entry + c.removed, end = (&c + 1)->first_entry;
    for (std::uint32_t e = c.first_entry; e < end; ++e) visit(e < modified ? entries_[e] : entries_[e] / 4);
  }
  /// Takes the fan to `goal` applied substitutions, one at a time.   @pre joined ones are not torn apart.
  void move_fan(std::size_t fan, std::uint16_t goal);
  /// Triangles that undoing down to `goal` would add; entries that moving there would write.
  std::uint32_t undo_gain(std::size_t fan, std::uint16_t goal) const;
  std::uint32_t entries_between(std::size_t fan, std::uint16_t goal) const;
  /// The goal of the next undo_last().
  std::uint16_t one_undone(std::size_t fan) const;
  /// Draws what never goes away.   @pre the base page, once.
  void activate_survivors();

  /// Number of substitutions applied, over all fans.
  std::uint32_t applied() const { return applied_; }
  std::uint32_t child_count() const { return static_cast<std::uint32_t>(children_.size() - 1); }
  bool fully_coarse() const { return applied_ == child_count(); }

  /// Of the page's triangles at the start of its round.
  const NormalCone& normals() const { return normals_; }
  ActiveNodes& active_nodes() { return nodes_; }
  FanPath path() const { return path_; }
  /// @return true if it was another: then all blocks are due.
  bool set_path(FanPath path);
  void tag_changes(std::size_t fan, std::uint16_t from, std::uint8_t kind);

  std::uint64_t bytes() const;        ///< without its share of the pool
  std::uint32_t finer_residents = 0;  ///< pages that lean on this one, those on their way included
  std::uint64_t last_wanted = 0;      ///< frame
  double tested_limit = -1;           ///< what the active nodes were last tested with

 private:
  friend class PageReplay;
  ResidentPage(PageId id, GeometryPool& pool, GeometryPool::RunId run) : id_(id), pool_(pool), run_(run) {}
  void apply_next(FanState& f);
  void undo_last(FanState& f);
  void update_band(std::size_t fan);

  struct SourceTable {
    PageId page;
    std::uint32_t first_triangle;
    std::vector<std::uint32_t> triangles, vertices, local_vertices;
  };
  const SourceTable* source(PageId finer) const;

  PageId id_;
  GeometryPool& pool_;
  GeometryPool::RunId run_;
  FanPath path_ = FanPath::fine;
  std::vector<std::uint32_t> vertex_slot_;   // per local vertex
  std::vector<std::uint32_t> triangle_ref_;  // per local triangle: handle · 4 + turn of its corners
  std::vector<FanState> fans_;
  std::vector<Sphere> spheres_;
  std::vector<ChildState> children_;    // one more than there are: the end of the last one's entries
  std::vector<std::uint32_t> entries_;  // removed: handle; modified: handle · 4 + corner
  std::vector<SourceTable> sources_;
  std::vector<TriangleHandle> survivors_;  // base page: until they are drawn
  ActiveNodes nodes_;
  NormalCone normals_;
  std::uint32_t applied_ = 0;
};

}  // namespace cuesta
