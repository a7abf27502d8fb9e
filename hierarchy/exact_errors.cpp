#include "hierarchy/exact_errors.h"

#include <algorithm>

#include "hierarchy/replay_mesh.h"
#include "hierarchy/rim_postings.h"

namespace cuesta {
namespace {

constexpr std::uint32_t original = 0xFFFFFFFFu;
/// Areas that the rim moves over are looked up so many at a time.
constexpr std::size_t areas_at_once = 64;
using Corners = std::array<Vec3i, 3>;

/// A substitution with those joined to it: children [first, last).
struct Step {
  std::uint32_t fan = 0, first = 0, last = 0;
  std::uint32_t first_dependency = 0, first_patch = 0, first_made = 0, first_area = 0;  // up to the next's
};

/// Replays a script, and notes what each step depends on and makes.
class Recorder {
 public:
  Recorder(const Page& page, const CellMesh& cell)
      : page_(page),
        positions_(cell.positions),
        births_(cell.births),
        vertical_(*cell.vertical),
        mesh_(page, cell.positions),
        born_(cell.births.size(), original) {}

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
    steps.push_back(begin_step(0, 0, 0));
  }

  std::vector<Step> steps;                 ///< and one after the last
  std::vector<std::uint32_t> fans_before;  ///< that steps depend on
  std::vector<float> errors_before;        ///< per step: the largest of births of earlier rounds
  std::vector<std::uint32_t> patches;      ///< triangles that go or change
  std::vector<std::uint32_t> made;         ///< triangles that are new, or change
  std::vector<Corners> made_corners;       ///< theirs, after the step
  std::vector<Corners> areas;              ///< that the rim moves over, or that are left without triangles
  const std::vector<std::uint32_t>& born() const { return born_; }

 private:
  Step begin_step(std::uint32_t fan, std::uint32_t first, std::uint32_t last) const {
    const auto size = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
    return {fan, first, last, size(fans_before), size(patches), size(made), size(areas)};
  }

  void add_step(std::uint32_t f, std::uint32_t first, std::uint32_t last) {
    const auto run = std::span(page_.script.children).subspan(first, last - first);
    const std::uint32_t u = mesh_.point(run[0].vertex), v = mesh_.point(run[0].target);
    steps.push_back(begin_step(f, first, last));
    error_before_ = 0;
    const auto star = mesh_.star(u);
    const std::vector<std::uint32_t> patch(star.begin(), star.end());
    made_.clear();
    if (std::any_of(patch.begin(), patch.end(), [&](std::uint32_t t) { return mesh_.has_point(t, v); }))
      substitute(run, patch, f < page_.script.strict_fans);
    else
      absorb(run);
    if (made_.empty()) {
      const auto around = mesh_.star(v);
      made_.assign(around.begin(), around.end());
      for (std::uint32_t t : made_) depend_on(t);
    }
    changed_.insert(changed_.end(), made_.begin(), made_.end());
    made.insert(made.end(), made_.begin(), made_.end());
    for (std::uint32_t t : made_) made_corners.push_back(corners_of(mesh_.corners(t)));
    errors_before.push_back(error_before_);
  }

  void substitute(std::span<const Child> run, const std::vector<std::uint32_t>& patch, bool strict) {
    const std::uint32_t u = mesh_.point(run[0].vertex), v = mesh_.point(run[0].target);
    if (mesh_.ring(u).size() != patch.size()) move_rim(u, v);
    for (std::uint32_t t : patch) {
      depend_on(t);
      patches.push_back(t);
      if (!mesh_.has_point(t, v))
        made_.push_back(t);
      else if (!strict)
        depend_around(t);
    }
    mesh_.substitute(run);
  }

  /// u is on a rim: its edges there sweep over triangles on their way to v.
  void move_rim(std::uint32_t u, std::uint32_t v) {
    for (const std::uint32_t q : mesh_.ring(u)) {
      if (q == v || mesh_.edge_triangles(u, q) != 1) continue;
      add_area({u, q, v});
      // The hole (u, v, q) is closed: what appears lies up to its edges' length from the surface.
      if (mesh_.edge_triangles(u, v) == 1 && mesh_.edge_triangles(v, q) == 1 && !is_triangle(u, v, q))
        error_before_ = std::max({error_before_, distance(u, v), distance(u, q)});
    }
  }
  bool is_triangle(std::uint32_t u, std::uint32_t v, std::uint32_t q) {
    const auto star = mesh_.star(u);
    return std::any_of(star.begin(), star.end(),
                       [&](std::uint32_t t) { return mesh_.has_point(t, v) && mesh_.has_point(t, q); });
  }
  float distance(std::uint32_t p, std::uint32_t q) const {
    return static_cast<float>(length(mesh_.position(p) - mesh_.position(q)) * (1 + 1e-6));
  }
  /// Whichever way round: areas face up.
  void add_area(std::array<std::uint32_t, 3> corners) {
    if (dot(mesh_.normal(corners), vertical_.direction(mesh_.position(corners[0]))) < 0)
      std::swap(corners[1], corners[2]);
    areas.push_back(corners_of(corners));
  }
  Corners corners_of(const std::array<std::uint32_t, 3>& c) const {
    return {positions_[c[0]], positions_[c[1]], positions_[c[2]]};
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
        patches.push_back(t);
        areas.push_back(corners_of(mesh_.corners(t)));
        mesh_.remove(t);
      }
    }
  }

  const Page& page_;
  std::span<const Vec3i> positions_;
  std::span<const Birth> births_;
  Vertical vertical_;
  ReplayMesh mesh_;
  std::vector<std::uint32_t> born_;  // per triangle, the fan that changed it last
  std::vector<std::uint32_t> changed_, made_;
  float error_before_ = 0;
};

/// No posting is farther from any place of the surface.
float size_of(const Box3<std::int32_t>& box) {
  return static_cast<float>(length(vec_cast<double>(box.hi) - vec_cast<double>(box.lo)) * (1 + 1e-6)) + 1;
}

/// Per step, how far postings are beside what it makes.
Result<std::vector<float>> measure_rims(const InputSurface& surface, const Recorder& record,
                                        RimPostings& rim) {
  std::vector<float> errors;
  std::vector<Vec3i> uncovered;
  const auto part = [](const auto& list, std::uint32_t first, std::uint32_t end) {
    return std::span(list).subspan(first, end - first);
  };
  for (std::size_t i = 0, end; i + 1 < record.steps.size(); i = end) {
    const std::uint32_t first_area = record.steps[i].first_area;
    for (end = i + 1;
         end + 1 < record.steps.size() && record.steps[end + 1].first_area - first_area <= areas_at_once;)
      ++end;
    const auto found =
        surface.postings_over(part(record.areas, first_area, record.steps[end].first_area), most_beside);
    if (!found) return fail(found.error());
    for (std::size_t k = i; k < end; ++k) {
      const Step &step = record.steps[k], &next = record.steps[k + 1];
      uncovered.clear();
      bool all_found = true;
      for (std::uint32_t a = step.first_area; a < next.first_area; ++a) {
        const auto& postings = (*found)[a - first_area];
        all_found &= postings.has_value();
        if (postings) uncovered.insert(uncovered.end(), postings->begin(), postings->end());
      }
      const auto error = rim.move(part(record.patches, step.first_patch, next.first_patch), uncovered,
                                  part(record.made, step.first_made, next.first_made),
                                  part(record.made_corners, step.first_made, next.first_made));
      errors.push_back(all_found && error ? *error : size_of(surface.box));
    }
  }
  return errors;
}

/// Every posting beside a triangle becomes one of its samples; those that are already are not doubled.
void add_samples(const RimPostings& rim, CellSurvivors& survivors) {
  const TriangleSamples before = std::move(survivors.samples);
  survivors.samples = {{0}, {}};
  auto& [begin, points] = survivors.samples;
  const auto less = [](const Vec3i& a, const Vec3i& b) {
    return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
  };
  for (std::size_t i = 0; i < survivors.triangles.size(); ++i) {
    const auto beside = rim.beside(survivors.triangles[i]);
    const std::size_t first = points.size();
    points.insert(points.end(), before.points.begin() + before.begin[i],
                  before.points.begin() + before.begin[i + 1]);
    if (!beside.empty()) {
      points.insert(points.end(), beside.begin(), beside.end());
      const auto at = points.begin() + static_cast<std::ptrdiff_t>(first);
      std::sort(at, points.end(), less);
      points.erase(std::unique(at, points.end()), points.end());
    }
    begin.push_back(static_cast<std::uint32_t>(points.size()));
  }
}

}  // namespace

Result<void> make_errors_exact(const InputSurface& surface, const CellMesh& cell, Page& page,
                               CellSurvivors& survivors) {
  Recorder record(page, cell);
  record.run();
  std::vector<float> distances(record.made.size());
  if (auto r = surface.measure(record.made_corners, distances); !r) return r;
  RimPostings rim(cell);
  const auto beside = measure_rims(surface, record, rim);
  if (!beside) return fail(beside.error());
  std::vector<ErrorCode8> fan_error(page.script.fans.size(), 0);
  for (std::size_t i = 0; i + 1 < record.steps.size(); ++i) {
    const Step &step = record.steps[i], &next = record.steps[i + 1];
    float error = std::max(record.errors_before[i], (*beside)[i]);
    for (std::uint32_t t = step.first_made; t < next.first_made; ++t) error = std::max(error, distances[t]);
    ErrorCode8 code = std::max(encode_error_up(error), fan_error[step.fan]);
    for (std::uint32_t d = step.first_dependency; d < next.first_dependency; ++d)
      code = std::max(code, fan_error[record.fans_before[d]]);
    for (std::uint32_t c = step.first; c < step.last; ++c) page.script.children[c].error = code;
    fan_error[step.fan] = code;
  }
  for (std::size_t i = 0; i < survivors.triangles.size(); ++i)
    if (const std::uint32_t fan = record.born()[survivors.triangles[i]]; fan != original)
      survivors.births[i].error = decode_error(fan_error[fan]);
  add_samples(rim, survivors);
  return {};
}

}  // namespace cuesta
