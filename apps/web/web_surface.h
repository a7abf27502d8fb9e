#pragma once
/// A surface as a page in a browser has it: opened from bytes that are fetched elsewhere, adapted a step at a
/// time, each step told as one block of words that can be handed to another thread.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/terrain_view/terrain_look.h"
#include "ooc/delivered_bytes.h"
#include "runtime/cut.h"
#include "runtime/delivered_loader.h"

namespace cuesta::web {

/// What a step aims at.
struct Aim {
  View view;
  double tau_px = 1;
  double exaggeration = 1;  ///< of terrain
  double geomorph_ms = 0;
  Budgets budgets;
};

/// Threads: one. Memory: the cut's, and one step.
class WebSurface {
 public:
  /// @param name  the address, for messages.   @param file_bytes  size of the whole file.
  WebSurface(const std::string& name, std::uint64_t file_bytes, Clock clock)
      : bytes_(std::make_shared<DeliveredBytes>(name, file_bytes)), clock_(std::move(clock)) {}

  /// Bytes of the file, for open().
  void deliver(std::uint64_t offset, std::vector<std::byte> bytes) {
    bytes_->deliver(offset, std::move(bytes));
  }
  /// Header, directory and base page; then the coarsest cut. Bytes that it lacks are its answer: deliver them
  /// and call it again. Nothing: it is open.   @error as Cut::open; corrupt for a terrain that contradicts
  /// itself.
  Result<std::optional<ByteRange>> open(std::uint64_t cache_bytes);

  /// The rest is for an open surface.
  /// A JSON object: what is known of it, for who draws it (docs/web.md).
  std::string facts() const;
  /// A view that shows all of it. @param view  its angle and size; its up where the file tells none.
  View first_view(const View& view, double exaggeration) const;

  struct Step {
    AdaptReport report;
    /// What changed in this step, and what to draw now: numbers of vertex ranges V, index ranges I and draws
    /// D; vertices and indices of the whole pools; then V, I and D ranges (first, count), D pages, the
    /// vertices of the ranges (DrawVertex, 5 words each) and their indices. Later ranges win. The first step
    /// tells all.
    std::span<const std::uint32_t> words;
  };
  /// One adapt(). The words stay until the next step.
  Step step(const Aim& aim);

  /// Pages that are to be brought, the most urgent first.
  std::vector<PageId> take_asked() { return loader_->take_asked(); }
  const BlockRef& block(PageId id) const { return cut_->directory().pages[id].block; }
  bool bring(PageId id, std::vector<std::byte> stored) { return loader_->bring(id, std::move(stored)); }
  bool give_up(PageId id, Error error) { return loader_->give_up(id, std::move(error)); }

  /// Distance to the nearest triangle on a ray that the last step told to draw; world units, `direction`
  /// unit.
  std::optional<double> distance_along(Vec3d origin, Vec3d direction, double exaggeration) const;
  /// Where a drawn point is, in words; empty for what is no terrain.
  std::string place(Vec3d p, double exaggeration) const;
  PageCache& cache() { return cut_->cache(); }

 private:
  std::optional<terrain_view::TerrainLook> look(double exaggeration) const;
  void tell_changes(bool whole);

  std::shared_ptr<DeliveredBytes> bytes_;
  Clock clock_;
  std::unique_ptr<Cut> cut_;
  DeliveredLoader* loader_ = nullptr;  // the cut's
  std::optional<terrain_view::TerrainLook> look_;
  std::vector<Vec3d> sketch_;
  DrawList drawn_;  // of the last step
  std::vector<std::uint32_t> words_;
};

}  // namespace cuesta::web
