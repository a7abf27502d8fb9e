#include "hierarchy/build_tom.h"

#include <tbb/task_arena.h>
#include <algorithm>
#include <limits>
#include <utility>

#include "hierarchy/attribute_quadric.h"
#include "hierarchy/component_absorber.h"
#include "hierarchy/deviation_stage.h"
#include "hierarchy/greedy_substitution.h"
#include "hierarchy/substitution_fairness.h"
#include "hierarchy/substitution_oracle.h"
#include "hierarchy/tom_codec.h"
#include "hierarchy/tom_input.h"
#include "ooc/check.h"

namespace cuesta {
namespace {

/// Below this many triangles for each handle or hole, topology is let go (TomOracle::any_edge).
constexpr std::uint32_t triangles_per_loop = 12;
/// Components of this many points go whole as soon as the error allows it; larger ones if nothing else is
/// left.
constexpr std::uint32_t small_component = 6;
constexpr std::uint32_t stuck_component = 64;

/// Near the end a substitution costs so much for each cube of its measured deviation, beside its fairness.
constexpr float deviation_weight = 5;
constexpr float one_per_cent = 0.01f;

/// The substitutions of vertices in the order in which they were made, and how the error rises.
struct Removals {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> steps;  // vertex → target, of the cell
  std::vector<RemovalError> errors;
};

/// Applies substitutions in the kernel and writes them down.
class Recorder {
 public:
  Recorder(SubstitutionKernel& kernel, SurfaceSamples& samples,
           const std::vector<std::uint32_t>& first_vertex)
      : kernel_(kernel), deviations_(samples), first_vertex_(first_vertex) {}

  std::span<const Child> apply(PointId u, PointId v) {
    const Replacement replacement = kernel_.replacement(u, v);
    if (std::exchange(measured_, nothing) == std::pair(u, v))
      deviations_.add_measured(replacement, removed());
    else
      deviations_.add(replacement, removed());
    children_.clear();
    changed_.clear();
    kernel_.apply(u, v, 0, children_, changed_);
    for (const Child& c : children_) removals_.steps.emplace_back(c.vertex, c.target);
    if (children_.size() < first_vertex_[u + 1] - first_vertex_[u]) remove_unused_wedges(u, v);
    return children_;
  }

  float surcharge(PointId u, PointId v) {
    const float deviation = deviations_.measure(kernel_.replacement(u, v));
    measured_ = {u, v};
    return deviation_weight * deviation * deviation * deviation;
  }

  /// A whole component goes: its points one after the other into the next, the last into v. What is left of
  /// it meanwhile only adds to the surface that was measured.
  void absorb(std::span<const PointId> members, PointId v) {
    deviations_.add(kernel_.absorption(members, v), removed());
    children_.clear();
    changed_.clear();
    kernel_.absorb(members, v, 0, children_, changed_);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const PointId next = i + 1 < members.size() ? members[i + 1] : v;
      for (std::uint32_t w = first_vertex_[members[i]]; w < first_vertex_[members[i] + 1]; ++w)
        removals_.steps.emplace_back(w, first_vertex_[next]);
    }
  }

  /// Lets others measure. Returns the error, all that was applied having been measured.
  float settle() {
    measured_ = nothing;
    return deviations_.error();
  }
  Removals take() {
    removals_.errors = deviations_.take_errors();
    return std::move(removals_);
  }

 private:
  static constexpr std::pair<PointId, PointId> nothing{none, none};
  std::uint32_t removed() const { return static_cast<std::uint32_t>(removals_.steps.size()); }

  /// Wedges of u that no triangle has any more.
  void remove_unused_wedges(PointId u, PointId v) {
    for (std::uint32_t w = first_vertex_[u]; w < first_vertex_[u + 1]; ++w)
      if (std::none_of(children_.begin(), children_.end(), [w](const Child& c) { return c.vertex == w; }))
        removals_.steps.emplace_back(w, first_vertex_[v]);
  }

  SubstitutionKernel& kernel_;
  DeviationStage deviations_;
  const std::vector<std::uint32_t>& first_vertex_;
  Removals removals_;
  std::pair<PointId, PointId> measured_ = nothing;  // last
  std::vector<Child> children_;
  std::vector<TriangleId> changed_;
};

template <class Oracle, class Fairness>
class Simplification {
 public:
  Simplification(SubstitutionKernel& kernel, SurfaceSamples& samples,
                 const std::vector<std::uint32_t>& first_vertex, Oracle oracle, Fairness fairness,
                 TomOracle which)
      : kernel_(kernel),
        oracle_(std::move(oracle)),
        fairness_(std::move(fairness)),
        recorder_(kernel, samples, first_vertex),
        greedy_(kernel, oracle_, fairness_, recorder_),
        absorber_(kernel, samples),
        lets_topology_go_(which == TomOracle::any_edge) {}

  Removals run() {
    greedy_.queue_all();
    for (;;) {
      while (advance()) absorb_now_and_then();
      recorder_.settle();
      if (!(lets_topology_go_ && absorb(stuck_component, never)) && !retry() &&
          !(lets_topology_go_ && loosen()))
        break;
    }
    return recorder_.take();
  }

 private:
  static constexpr float never = std::numeric_limits<float>::infinity();

  bool advance() {
    if (lets_topology_go_ && !loose_ &&
        kernel_.live_triangles() < std::uint64_t{triangles_per_loop} * kernel_.loops())
      loosen();
    return greedy_.step();
  }

  /// What was refused may have become legal through changes farther away.
  bool retry() {
    greedy_.queue_all();
    return greedy_.step();
  }

  bool loosen() {
    if (std::exchange(loose_, true)) return false;
    kernel_.loosen_topology();
    greedy_.queue_all();
    return true;
  }

  /// Each time a tenth of the triangles has gone.
  void absorb_now_and_then() {
    if (!lets_topology_go_ || !absorber_.has_work() || kernel_.live_triangles() > absorb_below_) return;
    absorb(small_component, recorder_.settle());
    absorb_below_ = kernel_.live_triangles() / 10 * 9;
  }

  /// After recorder_.settle().
  bool absorb(std::uint32_t most_points, float reach) {
    if (!absorber_.has_work()) return false;
    live_.clear();
    for (PointId p = 0; p < kernel_.point_count(); ++p)
      if (!kernel_.removed(p)) live_.push_back(p);
    bool any = false;
    for (const auto& candidate : absorber_.candidates(live_, most_points, reach)) {
      if (!absorber_.valid(candidate)) continue;
      recorder_.absorb(absorber_.members(candidate), candidate.target);
      any = true;
    }
    if (any) greedy_.queue_all();
    return any;
  }

  SubstitutionKernel& kernel_;
  Oracle oracle_;
  Fairness fairness_;
  Recorder recorder_;
  GreedySubstitution<Oracle, Fairness, Recorder> greedy_;
  ComponentAbsorber absorber_;
  bool lets_topology_go_, loose_ = false;
  std::uint32_t absorb_below_ = ~std::uint32_t{0};
  std::vector<PointId> live_;
};

template <class Fairness>
Removals simplify(SubstitutionKernel& kernel, const TomInput& input, const TomOptions& options,
                  Fairness fairness) {
  SurfaceSamples samples({}, kernel);
  const auto run = [&](auto oracle) {
    return tbb::this_task_arena::isolate([&] {
      return Simplification(kernel, samples, input.first_vertex, std::move(oracle), std::move(fairness),
                            options.oracle)
          .run();
    });
  };
  return options.oracle == TomOracle::pairs
             ? run(PairOracle(kernel, static_cast<float>(options.pair_threshold / input.grid.step)))
             : run(EdgeOracle(kernel));
}

/// Grid steps that a change of an attribute by 1 counts as much as.
float attribute_scale(const TomInput& input, float weight) {
  Vec3i lo = input.cell.positions.front(), hi = lo;
  for (const Vec3i& p : input.cell.positions) {
    lo = min(lo, p);
    hi = max(hi, p);
  }
  return weight * one_per_cent * length(vec_cast<float>(hi - lo));
}

Removals simplify(SubstitutionKernel& kernel, const TomInput& input, const SurfaceMesh& mesh,
                  const TomOptions& options) {
  if (options.fairness == TomFairness::memoryless)
    return simplify(kernel, input, options, MemorylessFairness(kernel));
  if (options.fairness == TomFairness::quadric)
    return simplify(kernel, input, options, QuadricFairness(kernel));
  return simplify(
      kernel, input, options,
      AttributeQuadricFairness(kernel, mesh, input.source, attribute_scale(input, options.attribute_weight)));
}

/// Removed last, first in the order; what was never removed before all. The wedges of a point stay together.
std::vector<std::uint32_t> resolution_order(const Removals& removals, std::size_t vertices) {
  std::vector<std::uint8_t> removed(vertices, 0);
  for (const auto& step : removals.steps) removed[step.first] = 1;
  std::vector<std::uint32_t> order;
  order.reserve(vertices);
  for (std::uint32_t v = 0; v < vertices; ++v)
    if (!removed[v]) order.push_back(v);
  for (auto step = removals.steps.rbegin(); step != removals.steps.rend(); ++step)
    order.push_back(step->first);
  return order;
}

/// Stable counting sort by resolution.
std::vector<Triangle> by_resolution(const std::vector<Triangle>& triangles, const Tom& tom) {
  std::vector<std::uint32_t> starts(tom.positions.size() + 2, 0), resolution(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    resolution[t] = triangle_resolution(tom.substitute, tom.base_vertices, triangles[t]);
    ++starts[resolution[t] + 1];
  }
  counts_to_starts(starts);
  std::vector<Triangle> sorted(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) sorted[starts[resolution[t]]++] = triangles[t];
  return sorted;
}

void take_attributes(Tom& tom, const SurfaceMesh& mesh, const TomInput& input,
                     const std::vector<std::uint32_t>& order) {
  const auto take = [&](auto& to, const auto& from) {
    if (from.empty()) return;
    to.reserve(order.size());
    for (std::uint32_t v : order) to.push_back(from[input.source[v]]);
  };
  take(tom.normals, mesh.normals);
  take(tom.colours, mesh.colours);
  take(tom.texcoords, mesh.texcoords);
}

float largest_snap(const SurfaceMesh& mesh, const TomInput& input) {
  double most = 0;
  for (std::size_t v = 0; v < input.source.size(); ++v)
    most =
        std::max(most, length(mesh.positions[input.source[v]] - input.grid.world(input.cell.positions[v])));
  return std::nextafter(static_cast<float>(most), std::numeric_limits<float>::infinity());
}

Tom ordered_mesh(const SurfaceMesh& mesh, const TomInput& input, const Removals& removals,
                 const std::vector<Triangle>& triangles) {
  Tom tom;
  tom.origin = input.grid.origin;
  tom.step = input.grid.step;
  const auto order = resolution_order(removals, input.source.size());
  tom.base_vertices = static_cast<Resolution>(order.size() - removals.steps.size());
  std::vector<std::uint32_t> place(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  tom.positions.reserve(order.size());
  for (std::uint32_t v : order)
    tom.positions.push_back(vec_cast<float>(vec_cast<double>(input.cell.positions[v]) * tom.step));
  for (const Vec3f& p : tom.positions) tom.bounds.add(p);
  take_attributes(tom, mesh, input, order);
  snap_attributes(tom);
  tom.substitute.resize(order.size());
  for (std::uint32_t i = 0; i < tom.base_vertices; ++i) tom.substitute[i] = i;
  for (const auto& [vertex, target] : removals.steps) tom.substitute[place[vertex]] = place[target];
  std::vector<Triangle> placed = triangles;
  for (Triangle& t : placed) t = smallest_first({place[t[0]], place[t[1]], place[t[2]]});
  tom.triangles = by_resolution(placed, tom);
  for (const auto& e : removals.errors)
    tom.errors.push_back({tom.full() - e.removed, static_cast<float>(decode_error(e.code) * tom.step)});
  tom.snap_error = largest_snap(mesh, input);
  return tom;
}

}  // namespace

Result<Tom> build_tom(const SurfaceMesh& mesh, const TomOptions& options, TomReport* report) {
  TomReport ignored;
  auto input = tom_input(mesh, options.step, report ? *report : ignored);
  if (!input) return fail(input.error());
  if (input->cell.positions.empty()) return Tom{};
  const std::vector<Triangle> triangles = input->cell.triangles;
  SubstitutionKernel kernel(input->cell);
  return ordered_mesh(mesh, *input, simplify(kernel, *input, mesh, options), triangles);
}

}  // namespace cuesta
