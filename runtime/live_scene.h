#pragma once
/// A scene that is open: instances that move, parts that stream in, and a resolution for each within a
/// frame's time. Source: Gobbetti, Scateni, Agus, "Exploring Virtual Prototypes Using Time-Critical
/// Multiresolution Rendering", §3 and §4. Threads: one caller; loader threads of its own. It has no clock and
/// draws nothing: the caller measures and draws.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hierarchy/scene_directory.h"
#include "runtime/cost_model.h"
#include "runtime/cut.h"
#include "runtime/index_cache.h"
#include "runtime/instance_culling.h"
#include "runtime/part_fill.h"
#include "runtime/part_store.h"
#include "runtime/resolution_policy.h"
#include "runtime/scene_pose.h"

namespace cuesta {

/// Where the geometry comes from.
struct SceneSources {
  PrefixReader tom;
  /// A large part as a cut of its own, for one instance.
  std::function<Result<std::unique_ptr<Cut>>(std::uint32_t part, std::uint64_t cache_bytes)> surface;
  PrefixAtHand tom_at_hand = {};  ///< empty: all is
};

enum class PolicyKind : std::uint8_t { predictive, stress, fixed };

struct SceneSettings {
  PolicyKind policy = PolicyKind::predictive;
  PredictiveOptions predictive;
  StressOptions stress;
  double fixed_full_coverage = 0.01;
  std::uint64_t cache_bytes = std::uint64_t{1}
                              << 30;  ///< of geometry: half for TOMs if there are surfaces, else all
  std::uint64_t index_bytes = std::uint64_t{256} << 20;  ///< of extracted indices that a frame does not use
  std::uint32_t load_threads = 2;  ///< 0: frames wait, so that a flight is the same each time
};

struct SceneFrameOptions {
  double deadline_ms = 33;  ///< of the whole frame, its drawing included
  double tau_px = 0.5;      ///< nothing is drawn finer than this error needs, > 0
  double least_px = 1;      ///< instances of a smaller diameter are left out
  /// Every object at this share of what tau_px asks for, whatever the policy: to calibrate, and for reference
  /// pictures.
  std::optional<double> uniform;
  /// Ends the choice early; ms of the deadline. TIME uses 10 % of it.
  double most_choice_ms = std::numeric_limits<double>::infinity();
  /// Share of the deadline that new indices and vertices may take; what is not there yet is drawn coarser for
  /// a frame.
  double change_share = 0.15;
};

/// One frame, as TIME's figures 4 and 5 report it.
struct SceneFrameReport {
  std::uint32_t visible_objects = 0;    ///< in the view, and not too small
  std::uint64_t visible_triangles = 0;  ///< of those, at full resolution
  std::uint32_t drawn_objects = 0;
  std::uint64_t drawn_triangles = 0;
  std::uint64_t changed_triangles =
      0;                       ///< whose indices were extracted, and vertices of parts that are new or grew
  double desired_ms = 0;       ///< the deadline
  double predicted_ms = 0;     ///< before drawing: choice_ms, and the cost model's of drawing
  double choice_ms = 0;        ///< culling, choosing, extracting
  double optimisation_ms = 0;  ///< of that, choosing resolutions
  ResolutionOutcome outcome = ResolutionOutcome::full;
  StoreReport store;
  std::uint64_t surface_bytes = 0;  ///< resident, of large parts
  /// All that was chosen is drawn: the next frame shows the same, unless view, pose or costs change.
  bool settled = false;
};

/// An instance as it is drawn.
struct DrawnInstance {
  Affine world;
  Rgba8 colour{255, 255, 255, 255};  ///< sRGB; multiplies the vertices'
  std::uint32_t instance = 0;        ///< of LiveScene::instances(): the same in all frames
};

/// Instances of one part at one resolution.
struct DrawnGroup {
  std::uint32_t part = 0;
  std::shared_ptr<const Tom> tom;
  std::shared_ptr<const IndexBlock> indices;
  std::uint32_t first = 0, count = 0;  ///< of SceneDrawList::instances
  bool mirrored = false;               ///< clockwise triangles are front faces
  float distance_radii = 0;  ///< of the instance that looks largest: from the eye to its ball's centre
  double bounds_px = 0;      ///< pixels of the instances' bounds, together
};

struct DrawnSurface {
  DrawList list;
  DrawnInstance as;
  Vec3d eye;  ///< in the part's frame
  bool mirrored = false;
  double bounds_px = 0;
};

/// What looks largest comes first, groups as well as instances within a group: what it hides is not written.
/// Valid until the next frame.
struct SceneDrawList {
  std::span<const DrawnInstance> instances;
  std::span<const DrawnGroup> groups;
  std::span<const DrawnSurface> surfaces;
};

class LiveScene {
 public:
  /// @param directory  outlives the scene   @param clock  ms since some moment
  /// @error of opening a large part
  static Result<std::unique_ptr<LiveScene>> open(const SceneDirectory& directory, SceneSources sources,
                                                 const SceneSettings& settings, Clock clock);

  /// Where things are; takes effect with the next frame.
  ScenePose& pose() { return pose_; }
  /// What the user cares about more or less, ≥ 0; 1 at first.   @pre node < nodes
  void set_weight(std::uint32_t node, float weight) { weight_[node] = weight; }

  /// From the next frame on; what a policy learned is forgotten, what the cost model did is not.
  void set_policy(PolicyKind policy);
  PolicyKind policy() const { return settings_.policy; }

  /// Chooses what to draw: nothing in it waits for I/O, unless load_threads is 0.
  /// @post list() has every visible object of which anything is resident, but those below least_px, and,
  /// where not even the coarsest of all fit the deadline, those of least interest (outcome infeasible).
  SceneFrameReport frame(const View& view, const SceneFrameOptions& options);
  SceneDrawList list() const { return {drawn_, groups_, surfaces_}; }
  /// What the last frame has filled, one for each group of list(), then for each surface: later frames are
  /// predicted from these. Without it all bounds count as full.
  void drew(std::span<const CallFill> fill);
  /// The frame that was chosen last took so long, choice and drawing: cost model (of drawing) and policy
  /// learn from it.
  void measured(double ms);
  /// Replaces what the cost model knows.
  void calibrate(std::span<const MeasuredFrame> frames) { costs_ = CostModel(frames); }
  const CostModel& costs() const { return costs_; }
  /// What the last frame draws, for calibrate(), which is about drawing alone.
  const FrameWork& work() const { return work_; }
  /// The same as it was known before drew().
  const FrameWork& guess() const { return guess_; }

  /// Frames until nothing is missing or `most` are done, waiting for what loads; the last one's report.
  SceneFrameReport settle(const View& view, const SceneFrameOptions& options, int most = 1000);

  Box3d bounds() const;  ///< of all instances where they are now
  /// Corners of the instances' boxes where they are now, to place cameras. Never empty.
  std::vector<Vec3d> corners() const;
  const PartStore& store() const { return store_; }
  std::span<const SceneInstance> instances() const { return instances_; }
  /// Around an instance where it was in the last frame.
  const Ball& ball(std::uint32_t instance) const { return balls_[instance]; }
  /// Of a large part's surface; null for TOMs.
  const Directory* surface_directory(std::uint32_t instance) const;

 private:
  LiveScene(const SceneDirectory& directory, SceneSources sources, const SceneSettings& settings,
            Clock clock);
  Result<void> open_surfaces(const SceneSources& sources, const SceneSettings& settings);
  void move_instances();
  void find_visible(const View& view, const SceneFrameOptions& options);
  void add_visible(std::uint32_t instance, const ViewCone::Footprint& footprint, const View& view,
                   const SceneFrameOptions& options);
  double coarsest_triangles(std::uint32_t part);
  void reserve_changes(const SceneFrameOptions& options);
  void choose(const SceneFrameOptions& options, SceneFrameReport& report);
  void request_parts();
  const std::shared_ptr<const Tom>& tom_to_show(std::uint32_t part);
  void choose_blocks();
  void group_toms();
  void forget_unseen();
  void adapt_surfaces(const View& view, const SceneFrameOptions& options, SceneFrameReport& report);
  void count_work(SceneFrameReport& report);
  void take_choice_time(double ms);
  double bounds_px(std::size_t visible) const { return double(coverage_[visible]) * picture_px_; }

  const SceneDirectory& directory_;
  SceneSettings settings_;
  Clock clock_;
  std::vector<SceneInstance> instances_;
  ScenePose pose_;
  std::vector<Ball> balls_;                      // per instance
  std::vector<std::uint32_t> instance_of_node_;  // no_index: none
  std::vector<float> weight_;                    // per node
  std::vector<std::unique_ptr<Cut>> cuts_;       // per instance; null for TOMs
  PartStore store_;
  IndexCache indices_;
  CostModel costs_;
  std::unique_ptr<ResolutionPolicy> policy_;
  double deadline_ms_ = 0;

  // Of the frame. Visible objects in structure of arrays, as policies take them.
  std::vector<std::uint32_t> visible_;  // instances
  std::vector<float> distance_radii_, coverage_, focus_, weights_, triangles_, r_min_, fragments_, r_;
  double picture_px_ = 0;
  double all_fragments_ = 0;  // Σ fragments_
  double pixels_ = 0;         // that the last frame has written
  PartFill part_fill_;
  double choice_ms_ = 0, expected_choice_ms_ = 0;  // of the last frame; of the next, quick to rise
  double wished_changes_ = 0;    // running mean: made, and denied for they would have been too many
  double reserved_changes_ = 0;  // that the frame has time for
  std::uint64_t new_vertices_ = 0, denied_vertices_ = 0;
  struct Shown {
    std::shared_ptr<const Tom> tom;
    std::uint64_t frame = 0;
  };
  std::vector<Shown> shown_;             // per part, as drawn in the last frame
  std::vector<std::uint32_t> coarsest_;  // per part, triangles of the base mesh; 0: not known yet
  std::uint64_t frame_ = 0;
  struct Choice {
    std::uint32_t instance = 0;
    double bounds_px = 0;
    float distance_radii = 0;
    std::shared_ptr<const IndexBlock> block;
    bool mirrored = false;
  };
  std::vector<Choice> choices_;
  std::vector<DrawnInstance> drawn_;
  std::vector<DrawnGroup> groups_;
  std::vector<DrawnSurface> surfaces_;
  bool surfaces_settled_ = true;
  FrameWork guess_, work_;  // before it is drawn, and with what was filled then
};

}  // namespace cuesta
