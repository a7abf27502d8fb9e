#pragma once
/// A scene as a page in a browser has it: opened from bytes that are fetched elsewhere; segments of its parts
/// are asked for as the view needs them, and each step is told as one block of words.

#include <array>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "apps/web/web_surface.h"
#include "hierarchy/scene_file.h"
#include "ooc/delivered_bytes.h"
#include "runtime/live_scene.h"

namespace cuesta::web {

/// Within a step's budget of triangles, TIME's optimiser shares them out. Threads: one. Memory: the parts'
/// budget, indices that a step uses, and one step.
class WebScene {
 public:
  static constexpr int kept_steps = 60;  ///< what was drawn in them is not told again
  static constexpr std::size_t most_asked = 64;

  /// @param name  the address, for messages.   @param file_bytes  size of the whole file.
  WebScene(const std::string& name, std::uint64_t file_bytes, Clock clock)
      : bytes_(std::make_shared<DeliveredBytes>(name, file_bytes)), clock_(std::move(clock)) {}

  void deliver(std::uint64_t offset, std::vector<std::byte> bytes) {
    bytes_->deliver(offset, std::move(bytes));
  }
  /// Header and directory. Bytes that it lacks are its answer: deliver them and call it again. Nothing: open.
  /// @error as SceneFile::open; invalid_input: a part is a surface of its own, which is not shown here
  Result<std::optional<ByteRange>> open(std::uint64_t cache_bytes);

  /// The rest is for an open scene.
  std::string facts() const;
  View first_view(const View& view) const;

  struct Step {
    SceneFrameReport report;
    bool settled = false;      ///< another one with the same aim would change nothing
    std::uint32_t failed = 0;  ///< parts that could not be read whole
    /// Eight counts: parts P, blocks B, forgotten parts and blocks, groups G, instances I, 0, 0. Then, f64 as
    /// two words: of each group its grid (origin, step); of each instance its map (columns, translation).
    /// Then each instance's colour; of each group part, block, first instance, count, 1 if mirrored; of each
    /// part that is new or grew its number, vertices, and those (DrawVertex); of each new block its number,
    /// triangles, and those; numbers of parts and of blocks that are forgotten.
    std::span<const std::uint32_t> words;
  };
  Step step(const Aim& aim);

  struct Asked {
    std::uint32_t id;
    BlockRef block;
  };
  /// Segments to be brought, the most urgent first; most_asked of them at most.
  std::vector<Asked> take_asked();
  /// @return false if it is not asked for
  bool bring(std::uint32_t id, std::vector<std::byte> stored);
  /// The segment cannot be had: its part stays coarser.
  bool give_up(std::uint32_t id);

  /// To the nearest triangle that the last step told to draw; world units, `direction` unit.
  std::optional<double> distance_along(Vec3d origin, Vec3d direction) const;
  std::uint64_t resident_bytes() const { return scene_->store().resident_bytes(); }
  std::string first_error() const;

 private:
  bool at_hand(std::uint32_t part, std::uint32_t segment);
  void tell(const SceneDrawList& list);

  std::shared_ptr<DeliveredBytes> bytes_;
  Clock clock_;
  std::unique_ptr<SceneFile> file_;
  std::unique_ptr<LiveScene> scene_;
  std::map<std::uint32_t, BlockRef> waiting_;  // by id
  std::set<std::uint64_t> asked_offsets_, given_up_;
  std::deque<Asked> asked_;
  std::uint32_t next_id_ = 0;
  struct Told {
    std::weak_ptr<const void> what;
    std::uint64_t used = 0;  // step
  };
  std::unordered_map<std::uint32_t, Told> told_parts_, told_blocks_;
  std::uint64_t step_ = 0;
  SceneDrawList drawn_;
  std::vector<std::uint32_t> words_;
};

}  // namespace cuesta::web
