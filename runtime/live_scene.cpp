#include "runtime/live_scene.h"

#include <algorithm>
#include <cmath>

#include "ooc/check.h"

namespace cuesta {
namespace {

/// That come with a triangle, however small: Mesa's block of 4 × 4. They count as part of its own cost, so
/// that what a part fills of its bounds depends less on its resolution.
constexpr double fragments_of_a_triangle = 16;

std::unique_ptr<ResolutionPolicy> make_policy(const SceneSettings& s, const CostModel& costs) {
  if (s.policy == PolicyKind::stress) return stress_policy(s.stress);
  if (s.policy == PolicyKind::fixed) return fixed_policy(s.fixed_full_coverage);
  return predictive_policy(costs, s.predictive);
}

bool has_surfaces(const SceneDirectory& directory) {
  return std::any_of(directory.parts.begin(), directory.parts.end(),
                     [](const ScenePartEntry& p) { return !p.is_tom(); });
}

/// Lengths in a part's frame become about so much longer in the world.
double mean_scale(const Affine& world) {
  return std::cbrt(std::abs(determinant(world)));
}

/// Triangles of the first segment whose error is allowed; all if none is. Between segments by powers, as
/// errors fall.
double triangles_for_error(const ScenePartEntry& part, double allowed) {
  const std::vector<TomSegment>& s = part.segments;
  if (double(s.front().error) <= allowed) return s.front().triangles;
  for (std::size_t i = 1; i < s.size(); ++i) {
    if (double(s[i].error) > allowed) continue;
    if (!(s[i].error > 0)) return s[i].triangles;
    const double t =
        std::log(double(s[i - 1].error) / allowed) / std::log(double(s[i - 1].error) / double(s[i].error));
    return std::max(1.0, double(s[i - 1].triangles)) *
           std::pow(double(s[i].triangles) / std::max(1.0, double(s[i - 1].triangles)), t);
  }
  return double(part.triangles);
}

std::uint64_t triangles_of(const DrawnGroup& g) {
  return std::uint64_t{g.count} * g.indices->triangles.size();
}

std::uint64_t triangles_of(const DrawnSurface& s) {
  std::uint64_t triangles = 0;
  for (const Range& range : s.list.draws) triangles += range.count / 3;
  return triangles;
}

/// The same view as seen from within an instance.
View view_within(const Affine& world, View view) {
  const Affine in = inverse(world);
  const Vec3d target = view.eye - view.frame()[2];
  view.target = in.point(target);
  view.up = in.vector(view.up);
  view.eye = in.point(view.eye);
  return view;
}

}  // namespace

LiveScene::LiveScene(const SceneDirectory& directory, SceneSources sources, const SceneSettings& settings,
                     Clock clock)
    : directory_(directory),
      settings_(settings),
      clock_(std::move(clock)),
      instances_(instances_of(directory.scene)),
      pose_(directory.scene),
      balls_(instances_.size()),
      instance_of_node_(directory.scene.nodes.size(), no_index),
      weight_(directory.scene.nodes.size(), 1.0f),
      cuts_(instances_.size()),
      store_(directory.parts, std::move(sources.tom),
             settings.cache_bytes / (has_surfaces(directory) ? 2 : 1), settings.load_threads,
             std::move(sources.tom_at_hand)),
      indices_(settings.index_bytes),
      policy_(make_policy(settings, costs_)),
      part_fill_(directory.parts.size()),
      shown_(directory.parts.size()),
      coarsest_(directory.parts.size()) {
  for (std::uint32_t i = 0; i < instances_.size(); ++i) {
    instance_of_node_[instances_[i].node] = i;
    balls_[i] = ball_of(pose_.world(instances_[i].node), directory.parts[instances_[i].part].box);
  }
}

Result<std::unique_ptr<LiveScene>> LiveScene::open(const SceneDirectory& directory, SceneSources sources,
                                                   const SceneSettings& settings, Clock clock) {
  auto scene = std::unique_ptr<LiveScene>(new LiveScene(directory, sources, settings, std::move(clock)));
  if (auto ok = scene->open_surfaces(sources, settings); !ok) return fail(ok.error());
  return scene;
}

Result<void> LiveScene::open_surfaces(const SceneSources& sources, const SceneSettings& settings) {
  const auto is_surface = [this](const SceneInstance& i) { return !directory_.parts[i.part].is_tom(); };
  const auto count = std::count_if(instances_.begin(), instances_.end(), is_surface);
  for (std::size_t i = 0; i < instances_.size(); ++i) {
    if (!is_surface(instances_[i])) continue;
    auto cut =
        sources.surface(instances_[i].part, settings.cache_bytes / 2 / static_cast<std::uint64_t>(count));
    if (!cut) return fail(cut.error());
    cuts_[i] = std::move(*cut);
  }
  return {};
}

void LiveScene::move_instances() {
  for (const std::uint32_t node : pose_.update())
    if (const std::uint32_t i = instance_of_node_[node]; i != no_index)
      balls_[i] = ball_of(pose_.world(node), directory_.parts[instances_[i].part].box);
}

/// Of the base mesh, which a first segment goes far beyond; 0 until that is resident.
double LiveScene::coarsest_triangles(std::uint32_t part) {
  const auto& tom = store_.tom(part);
  if (tom && coarsest_[part] == 0) coarsest_[part] = triangle_count(*tom, tom->base_vertices);
  return coarsest_[part];
}

void LiveScene::add_visible(std::uint32_t instance, const ViewCone::Footprint& footprint, const View& view,
                            const SceneFrameOptions& options) {
  const SceneInstance& in = instances_[instance];
  const Ball& ball = balls_[instance];
  const double from_centre = length(ball.centre - view.eye);
  const ScenePartEntry& part = directory_.parts[in.part];
  double full = double(part.triangles), least = 0;
  if (part.is_tom()) {
    const double scale = mean_scale(pose_.world(in.node));
    const double nearest = std::max(from_centre - ball.radius, 0.0);
    full = triangles_for_error(part,
                               options.tau_px * nearest / view.pixels_per_unit() / std::max(scale, 1e-300));
    least = coarsest_triangles(in.part);
  } else {
    // A cut is view-dependent: it needs no more than a few triangles for each pixel and tau squared.
    full = std::min(full, 2 * footprint.coverage * picture_px_ / (options.tau_px * options.tau_px));
  }
  visible_.push_back(instance);
  distance_radii_.push_back(static_cast<float>(from_centre / ball.radius));
  coverage_.push_back(static_cast<float>(footprint.coverage));
  focus_.push_back(focus_at(footprint.from_centre));
  weights_.push_back(weight_[in.node]);
  triangles_.push_back(static_cast<float>(std::max(full, 1.0)));
  r_min_.push_back(static_cast<float>(std::clamp(least / std::max(full, 1.0), 0.0, 1.0)));
  fragments_.push_back(static_cast<float>(footprint.coverage * picture_px_ * part_fill_.share(in.part)));
  all_fragments_ += double(fragments_.back());
}

void LiveScene::find_visible(const View& view, const SceneFrameOptions& options) {
  for (auto* v : {&distance_radii_, &coverage_, &focus_, &weights_, &triangles_, &r_min_, &fragments_})
    v->clear();
  visible_.clear();
  picture_px_ = double(view.width_px) * double(view.height_px);
  all_fragments_ = 0;
  const ViewCone cone(view);
  for (std::uint32_t i = 0; i < instances_.size(); ++i) {
    const Ball& ball = balls_[i];
    if (!(ball.radius > 0) || !cone.may_see(ball)) continue;
    const ViewCone::Footprint footprint = cone.footprint(ball);
    if (footprint.diameter_px < options.least_px) continue;
    add_visible(i, footprint, view, options);
  }
}

void LiveScene::choose(const SceneFrameOptions& options, SceneFrameReport& report) {
  r_.resize(visible_.size());
  const double start = clock_();
  if (options.uniform) {
    for (std::size_t i = 0; i < r_.size(); ++i)
      r_[i] = std::max(r_min_[i], static_cast<float>(*options.uniform));
    report.outcome = ResolutionOutcome::heuristic;
  } else {
    const FrameTask task{std::max(options.deadline_ms - expected_choice_ms_, 0.0),
                         {double(visible_.size()), 0, all_fragments_, pixels_, reserved_changes_}};
    report.outcome = policy_->choose({coverage_, focus_, weights_, triangles_, r_min_, fragments_}, task, r_,
                                     [&] { return clock_() - start > options.most_choice_ms; });
  }
  report.optimisation_ms = clock_() - start;
}

void LiveScene::request_parts() {
  for (std::size_t k = 0; k < visible_.size(); ++k) {
    const std::uint32_t part = instances_[visible_[k]].part;
    if (directory_.parts[part].is_tom())
      store_.want(part, double(r_[k]) * double(triangles_[k]),
                  double(coverage_[k]) * double(focus_[k] * weights_[k]));
  }
}

/// Time for twice what changed of late; a flight that begins to move gets more from frame to frame.
void LiveScene::reserve_changes(const SceneFrameOptions& options) {
  constexpr double least_share = 0.02;
  const double per_ms = 1 / std::max(costs_.changed_triangle_ms(), 1e-9);
  const double most = options.change_share * options.deadline_ms * per_ms;
  reserved_changes_ = options.uniform ? 1e15 : std::clamp(2 * wished_changes_, most * least_share, most);
}

/// What is resident, or, while that would be too much to send at once, what was shown in the last frame.
const std::shared_ptr<const Tom>& LiveScene::tom_to_show(std::uint32_t part) {
  const std::shared_ptr<const Tom>& now = store_.tom(part);
  Shown& shown = shown_[part];
  shown.frame = frame_;
  if (!now || now == shown.tom) return shown.tom = now;
  const bool fits = double(new_vertices_ + indices_.extracted_triangles() + now->full()) <= reserved_changes_;
  if (!fits && shown.tom) {
    denied_vertices_ += now->full();
    return shown.tom;
  }
  new_vertices_ += now->full();
  return shown.tom = now;
}

/// What was shown would else stay in memory, unknown to the store.
void LiveScene::forget_unseen() {
  for (Shown& shown : shown_)
    if (shown.frame != frame_) shown.tom.reset();
}

void LiveScene::choose_blocks() {
  choices_.clear();
  new_vertices_ = denied_vertices_ = 0;
  for (std::size_t k = 0; k < visible_.size(); ++k) {
    const SceneInstance& in = instances_[visible_[k]];
    if (cuts_[visible_[k]] || r_[k] <= 0) continue;
    const auto& tom = tom_to_show(in.part);
    if (!tom) continue;
    const double all = double(directory_.parts[in.part].triangles);
    const double wanted = rung_triangles(std::clamp(double(r_[k]) * double(triangles_[k]), 1.0, all), all);
    const Resolution n = resolution_of_triangles(*tom, static_cast<std::uint32_t>(std::min(wanted, 4e9)));
    const double left = std::max(0.0, reserved_changes_ - double(new_vertices_));
    choices_.push_back({visible_[k], bounds_px(k), distance_radii_[k],
                        indices_.get(in.part, *tom, n, static_cast<std::uint64_t>(left)),
                        determinant(pose_.world(in.node)) < 0});
  }
}

void LiveScene::group_toms() {
  drawn_.clear(), groups_.clear();
  std::sort(choices_.begin(), choices_.end(), [](const Choice& a, const Choice& b) {
    return a.block->id != b.block->id             ? a.block->id < b.block->id
           : a.mirrored != b.mirrored             ? b.mirrored
           : a.distance_radii != b.distance_radii ? a.distance_radii < b.distance_radii
                                                  : a.instance < b.instance;
  });
  for (const Choice& c : choices_) {
    const SceneInstance& in = instances_[c.instance];
    if (groups_.empty() || groups_.back().indices != c.block || groups_.back().mirrored != c.mirrored) {
      groups_.push_back({in.part, shown_[in.part].tom, c.block, static_cast<std::uint32_t>(drawn_.size()), 0,
                         c.mirrored, c.distance_radii});
    }
    ++groups_.back().count;
    groups_.back().bounds_px += c.bounds_px;
    const bool own_colours = directory_.parts[in.part].attributes.colours;
    const Rgba8 colour =
        own_colours ? Rgba8{255, 255, 255, 255} : directory_.scene.materials[in.material].base_colour;
    drawn_.push_back({pose_.world(in.node), colour, c.instance});
  }
  std::sort(groups_.begin(), groups_.end(), [](const DrawnGroup& a, const DrawnGroup& b) {
    return a.distance_radii != b.distance_radii ? a.distance_radii < b.distance_radii : a.first < b.first;
  });
}

void LiveScene::adapt_surfaces(const View& view, const SceneFrameOptions& options, SceneFrameReport& report) {
  surfaces_.clear();
  surfaces_settled_ = true;
  double left_ms = options.change_share * options.deadline_ms;  // of all of them
  for (std::size_t k = 0; k < visible_.size(); ++k) {
    Cut* const cut = cuts_[visible_[k]].get();
    if (!cut || r_[k] <= 0) continue;
    const SceneInstance& in = instances_[visible_[k]];
    const Affine& world = pose_.world(in.node);
    Budgets budgets;
    if (!options.uniform) {
      budgets.triangles = triangle_budget(r_[k], double(triangles_[k]));
      budgets.adapt_ms = left_ms;
    }
    const View within = view_within(world, view);
    const auto scale = ErrorScale::perspective(cut->directory().grid, within, 4);
    const AdaptReport adapted = cut->adapt(scale, options.tau_px, budgets);
    left_ms = std::max(left_ms - adapted.adapt_ms, 0.0);
    report.surface_bytes += adapted.resident_bytes;
    report.store.missing += adapted.pages_missing;
    surfaces_settled_ = surfaces_settled_ && adapted.settled;
    surfaces_.push_back({cut->draw_list(scale),
                         {world, directory_.scene.materials[in.material].base_colour, visible_[k]},
                         within.eye,
                         determinant(world) < 0,
                         bounds_px(k)});
  }
}

void LiveScene::count_work(SceneFrameReport& report) {
  report.visible_objects = static_cast<std::uint32_t>(visible_.size());
  for (const std::uint32_t i : visible_)
    report.visible_triangles += directory_.parts[instances_[i].part].triangles;
  report.drawn_objects = static_cast<std::uint32_t>(drawn_.size() + surfaces_.size());
  for (const DrawnGroup& g : groups_) report.drawn_triangles += triangles_of(g);
  for (const DrawnSurface& s : surfaces_) report.drawn_triangles += triangles_of(s);
  report.changed_triangles = indices_.extracted_triangles() + new_vertices_;
  double fragments = 0;
  for (std::size_t k = 0; k < visible_.size(); ++k)
    if (r_[k] > 0) fragments += double(fragments_[k]);
  work_ = {double(report.drawn_objects), double(report.drawn_triangles), fragments, pixels_,
           double(report.changed_triangles)};
  guess_ = work_;
  const double wished = double(report.changed_triangles + indices_.denied_triangles() + denied_vertices_);
  report.settled =
      surfaces_settled_ && wished == 0 && report.store.missing <= report.store.waiting_for_budget;
  wished_changes_ += 0.3 * (wished - wished_changes_);
}

SceneFrameReport LiveScene::frame(const View& view, const SceneFrameOptions& options) {
  CUESTA_CHECK(options.deadline_ms > 0 && options.tau_px > 0, options.deadline_ms, options.tau_px);
  SceneFrameReport report;
  const double start = clock_();
  deadline_ms_ = report.desired_ms = options.deadline_ms;
  ++frame_;
  indices_.begin_frame();
  move_instances();
  find_visible(view, options);
  reserve_changes(options);
  choose(options, report);
  request_parts();
  report.store = store_.update();
  choose_blocks();
  group_toms();
  forget_unseen();
  adapt_surfaces(view, options, report);
  indices_.end_frame();
  count_work(report);
  report.choice_ms = clock_() - start;
  take_choice_time(report.choice_ms);
  report.predicted_ms = report.choice_ms + costs_.predict_ms(work_);
  return report;
}

/// What choosing, extracting and adapting take is known only afterwards; the next frame's is likely the same.
void LiveScene::take_choice_time(double ms) {
  constexpr double rise = 0.5, fall = 0.1;
  choice_ms_ = ms;
  expected_choice_ms_ += (ms > expected_choice_ms_ ? rise : fall) * (ms - expected_choice_ms_);
}

void LiveScene::drew(std::span<const CallFill> fill) {
  CUESTA_CHECK(fill.size() == groups_.size() + surfaces_.size(), fill.size(), groups_.size());
  work_.fragments = work_.pixels = 0;
  const auto add = [this](std::uint32_t part, const CallFill& f, std::uint64_t triangles, double bounds_px) {
    const double fragments =
        std::max(double(f.fragments) - fragments_of_a_triangle * double(triangles), double(f.pixels));
    part_fill_.add(part, fragments, bounds_px);
    work_.fragments += fragments, work_.pixels += double(f.pixels);
  };
  for (std::size_t i = 0; i < groups_.size(); ++i)
    add(groups_[i].part, fill[i], triangles_of(groups_[i]), groups_[i].bounds_px);
  for (std::size_t i = 0; i < surfaces_.size(); ++i)
    add(instances_[surfaces_[i].as.instance].part, fill[groups_.size() + i], triangles_of(surfaces_[i]),
        surfaces_[i].bounds_px);
  part_fill_.learn();
  pixels_ = work_.pixels;
}

void LiveScene::set_policy(PolicyKind policy) {
  settings_.policy = policy;
  policy_ = make_policy(settings_, costs_);
}

const Directory* LiveScene::surface_directory(std::uint32_t instance) const {
  return cuts_[instance] ? &cuts_[instance]->directory() : nullptr;
}

void LiveScene::measured(double ms) {
  costs_.observe(work_, ms - choice_ms_, guess_);
  policy_->measured(ms, deadline_ms_);
}

SceneFrameReport LiveScene::settle(const View& view, const SceneFrameOptions& options, int most) {
  SceneFrameReport report = frame(view, options);
  for (int i = 1; i < most && report.store.missing > report.store.waiting_for_budget; ++i) {
    store_.wait();
    report = frame(view, options);
  }
  return report;
}

Box3d LiveScene::bounds() const {
  Box3d box;
  for (const SceneInstance& in : instances_)
    box.add(map_box(pose_.world(in.node), directory_.parts[in.part].box));
  return box;
}

std::vector<Vec3d> LiveScene::corners() const {
  std::vector<Vec3d> points;
  for (const SceneInstance& in : instances_) {
    const Box3d& box = directory_.parts[in.part].box;
    if (box.empty()) continue;
    const Affine& world = pose_.world(in.node);
    for (int corner = 0; corner < 8; ++corner)
      points.push_back(world.point({corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                                    corner & 4 ? box.hi.z : box.lo.z}));
  }
  if (points.empty()) points = {{0, 0, 0}, {1, 1, 1}};
  return points;
}

}  // namespace cuesta
