#include "hierarchy/exact_errors.h"

#include <algorithm>

#include "hierarchy/replay_mesh.h"

namespace cuesta {
namespace {

constexpr std::uint32_t original = 0xFFFFFFFFu;

/// A substitution with those joined to it: children [first, last).
struct Step {
  std::uint32_t fan = 0, first = 0, last = 0;
  std::uint32_t first_dependency = 0, first_target = 0;  // up to those of the next step
  bool may_uncover = false;
};

/// Replays a script, and notes what each step depends on and makes.
class Recorder {
 public:
  Recorder(const Page& page, std::span<const Vec3i> positions, std::span<const Birth> births)
      : page_(page),
        positions_(positions),
        births_(births),
        mesh_(page, positions),
        born_(births.size(), original) {}

  void run() {
    const auto& children = page_.script.children;
    for (std::uint32_t f = 0; f < page_.script.fans.size(); ++f) {
      const Fan& fan = page_.script.fans[f];
      changed_.clear();
      for (std::uint32_t first = fan.first_child, last; first < fan.first_child + fan.child_count;
           first = last) {
        for (last = first + 1; last < fan.first_child + fan.child_count && children[last].joined;) ++last;
        add_step(f, first, last);
      }
      for (std::uint32_t t : changed_) born_[t] = f;
    }
    steps.push_back({0, 0, 0, static_cast<std::uint32_t>(fans_before.size()),
                     static_cast<std::uint32_t>(targets.size()), false});
  }

  std::vector<Step> steps;                    ///< and one after the last
  std::vector<std::uint32_t> fans_before;     ///< that steps depend on
  std::vector<float> errors_before;           ///< per step: the largest of births of earlier rounds
  std::vector<std::array<Vec3i, 3>> targets;  ///< triangles that steps make
  const std::vector<std::uint32_t>& born() const { return born_; }

 private:
  void add_step(std::uint32_t f, std::uint32_t first, std::uint32_t last) {
    const auto run = std::span(page_.script.children).subspan(first, last - first);
    const std::uint32_t u = mesh_.point(run[0].vertex), v = mesh_.point(run[0].target);
    Step step{f,
              first,
              last,
              static_cast<std::uint32_t>(fans_before.size()),
              static_cast<std::uint32_t>(targets.size()),
              false};
    error_before_ = 0;
    const auto star = mesh_.star(u);
    const std::vector<std::uint32_t> patch(star.begin(), star.end());
    const bool joins =
        std::any_of(patch.begin(), patch.end(), [&](std::uint32_t t) { return mesh_.has_point(t, v); });
    const bool strict = f < page_.script.strict_fans;
    step.may_uncover = !joins || !strict || mesh_.ring(u).size() != patch.size();
    made_.clear();
    if (joins) {
      for (std::uint32_t t : patch) {
        depend_on(t);
        if (mesh_.has_point(t, v)) {
          if (!strict) depend_around(t);
        } else {
          made_.push_back(t);
        }
      }
      mesh_.substitute(run);
    } else {
      absorb(run);
    }
    if (made_.empty()) {
      const auto around = mesh_.star(v);
      made_.assign(around.begin(), around.end());
      for (std::uint32_t t : made_) depend_on(t);
    }
    changed_.insert(changed_.end(), made_.begin(), made_.end());
    for (std::uint32_t t : made_) {
      const auto& c = mesh_.corners(t);
      targets.push_back({positions_[c[0]], positions_[c[1]], positions_[c[2]]});
    }
    steps.push_back(step);
    errors_before.push_back(error_before_);
  }

  void depend_on(std::uint32_t t) {
    if (born_[t] == original)
      error_before_ = std::max(error_before_, births_[t].error);
    else
      fans_before.push_back(born_[t]);
  }
  /// Without the link condition triangles at the corners of what goes must not change before it, and are
  /// reborn too.
  void depend_around(std::uint32_t triangle) {
    for (std::uint32_t vertex : mesh_.corners(triangle))
      for (std::uint32_t t : mesh_.star(mesh_.point(vertex))) {
        depend_on(t);
        changed_.push_back(t);
      }
  }
  /// The run's vertices are all of a component.
  void absorb(std::span<const Child> run) {
    for (const Child& c : run) {
      const auto star = mesh_.star(mesh_.point(c.vertex));
      const std::vector<std::uint32_t> gone(star.begin(), star.end());
      for (std::uint32_t t : gone) {
        depend_on(t);
        mesh_.remove(t);
      }
    }
  }

  const Page& page_;
  std::span<const Vec3i> positions_;
  std::span<const Birth> births_;
  ReplayMesh mesh_;
  std::vector<std::uint32_t> born_;  // per triangle, the fan that changed it last
  std::vector<std::uint32_t> changed_, made_;
  float error_before_ = 0;
};

}  // namespace

Result<void> make_errors_exact(const InputSurface& surface, std::span<const Vec3i> positions,
                               std::span<const Birth> births, Page& page, CellSurvivors& survivors) {
  Recorder record(page, positions, births);
  record.run();
  std::vector<float> distances(record.targets.size());
  if (auto r = surface.measure(record.targets, distances); !r) return r;
  std::vector<ErrorCode8> fan_error(page.script.fans.size(), 0);
  for (std::size_t i = 0; i + 1 < record.steps.size(); ++i) {
    const Step &step = record.steps[i], &next = record.steps[i + 1];
    float error = record.errors_before[i];
    for (std::uint32_t t = step.first_target; t < next.first_target; ++t)
      error = std::max(error, distances[t]);
    if (step.may_uncover) error = std::max(error, decode_error(page.script.children[step.first].error));
    ErrorCode8 code = std::max(encode_error_up(error), fan_error[step.fan]);
    for (std::uint32_t d = step.first_dependency; d < next.first_dependency; ++d)
      code = std::max(code, fan_error[record.fans_before[d]]);
    for (std::uint32_t c = step.first; c < step.last; ++c) page.script.children[c].error = code;
    fan_error[step.fan] = code;
  }
  for (std::size_t i = 0; i < survivors.triangles.size(); ++i)
    if (const std::uint32_t fan = record.born()[survivors.triangles[i]]; fan != original)
      survivors.births[i].error = decode_error(fan_error[fan]);
  return {};
}

}  // namespace cuesta
