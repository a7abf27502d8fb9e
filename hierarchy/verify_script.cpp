#include "hierarchy/verify_script.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "hierarchy/replay_mesh.h"
#include "ooc/triangle_order.h"

namespace cuesta {
namespace {

std::string arrow(const Child& c) {
  return std::to_string(c.vertex) + " -> " + std::to_string(c.target);
}

class ScriptCheck {
 public:
  ScriptCheck(PageId id, const Page& page, std::span<const Vec3i> positions, std::vector<Birth> births,
              const std::optional<Vertical>& vertical, VerifyReport& report)
      : id_(id),
        page_(page),
        positions_(positions),
        births_(std::move(births)),
        vertical_(vertical),
        report_(report),
        mesh_(page, positions) {}

  ReplayedSurvivors run() {
    for (const Fan& fan : page_.script.fans) check_fan(fan);
    report_.fans += page_.script.fans.size();
    return survivors();
  }

 private:
  void check_fan(const Fan& fan) {
    sphere_ = decode_sphere(fan.sphere, positions_[fan.centre]);
    changed_.clear();
    loose_ = &fan - page_.script.fans.data() >= static_cast<std::ptrdiff_t>(page_.script.strict_fans);
    const auto children = std::span(page_.script.children).subspan(fan.first_child, fan.child_count);
    for (std::size_t first = 0, last = 0; first < children.size(); first = last) {
      for (last = first + 1; last < children.size() && children[last].joined;) ++last;
      number_ = fan.first_child + first;
      check_substitution(fan, children.subspan(first, last - first));
      if (first > 0 && children[first].error < children[first - 1].error)
        report_.add(Check::saturated, id_, number_, "the error falls along a fan");
    }
    const Birth birth{decode_error(children.back().error), sphere_};
    for (std::uint32_t t : changed_) births_[t] = birth;
  }

  void check_substitution(const Fan& fan, std::span<const Child> run) {
    ++report_.substitutions;
    const std::uint32_t v = mesh_.point(fan.centre);
    const auto goes_to_centre = [&](const Child& c) {
      return mesh_.point(c.target) == v && mesh_.point(c.vertex) != v;
    };
    if (!std::all_of(run.begin(), run.end(), goes_to_centre))
      return illegal(run[0], " or what is joined to it does not go to the fan's centre");
    const std::uint32_t u = mesh_.point(run[0].vertex);
    const bool one_point =
        std::all_of(run.begin(), run.end(), [&](const Child& c) { return mesh_.point(c.vertex) == u; });
    one_point ? check_move(run, u, v) : check_absorption(run, v);
  }

  void check_move(std::span<const Child> run, std::uint32_t u, std::uint32_t v) {
    const auto dying = mesh_.edge_triangles(u, v);
    check_wedges(run, u);
    if (dying == 0) illegal(run[0], " removes no triangle");
    if (loose_)
      count_let_go(run[0], u, v, dying);
    else
      check_link(run[0], u, v, dying);
    check_patch(run, u, v);
    removed_ += mesh_.substitute(run);
  }

  /// A whole component goes into the centre: its triangles vanish, and those around the centre stand for it.
  void check_absorption(std::span<const Child> run, std::uint32_t v) {
    std::vector<std::uint32_t> members, patch;
    for (const Child& c : run) members.push_back(mesh_.point(c.vertex));
    std::sort(members.begin(), members.end());
    for (std::uint32_t p : members) patch.insert(patch.end(), mesh_.star(p).begin(), mesh_.star(p).end());
    std::sort(patch.begin(), patch.end());
    patch.erase(std::unique(patch.begin(), patch.end()), patch.end());
    for (std::uint32_t t : patch) {
      check_birth(run[0], t);
      for (std::uint32_t w : mesh_.corners(t))
        if (!std::binary_search(members.begin(), members.end(), mesh_.point(w)))
          illegal(run[0], " and what is joined to it are not a whole component");
      mesh_.remove(t);
    }
    removed_ += static_cast<std::uint32_t>(patch.size());
    depend_on_star(run[0], v);
  }

  void check_wedges(std::span<const Child> run, std::uint32_t u) {
    for (std::uint32_t t : mesh_.star(u))
      for (std::uint32_t w : mesh_.corners(t)) {
        if (mesh_.point(w) != u) continue;
        if (std::none_of(run.begin(), run.end(), [w](const Child& c) { return c.vertex == w; }))
          return illegal(run[0], " leaves wedge " + std::to_string(w) + " behind: a seam opens");
      }
  }

  void count_let_go(const Child& child, std::uint32_t u, std::uint32_t v, std::uint32_t dying) {
    if (links_kept(u, v) && !doubled(u, v) && !leaves_border(u, v) && dying <= 2) return;
    ++report_.topology_let_go;
    report_.topology_kept_below = std::min(report_.topology_kept_below, decode_error(child.error));
  }

  void check_link(const Child& child, std::uint32_t u, std::uint32_t v, std::uint32_t dying) {
    if (dying > 2) illegal(child, " removes " + std::to_string(dying) + " triangles, not one or two");
    if (!links_kept(u, v)) illegal(child, " breaks the link condition");
    if (doubled(u, v)) illegal(child, " puts a triangle onto another");
    if (leaves_border(u, v)) illegal(child, " goes from a border inwards");
  }

  /// Points joined to both are the third corners of the triangles between u and v, and no others; except that
  /// a border loop of three edges may close.
  bool links_kept(std::uint32_t u, std::uint32_t v) {
    const auto a = mesh_.ring(u), b = mesh_.ring(v);
    std::vector<std::uint32_t> common, between, more;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
    for (std::uint32_t t : mesh_.star(u)) {
      if (!mesh_.has_point(t, v)) continue;
      for (std::uint32_t w : mesh_.corners(t))
        if (mesh_.point(w) != u && mesh_.point(w) != v) between.push_back(mesh_.point(w));
    }
    std::sort(between.begin(), between.end());
    std::set_difference(common.begin(), common.end(), between.begin(), between.end(),
                        std::back_inserter(more));
    return more.empty() || (more.size() == 1 && between.size() == 1 &&
                            mesh_.edge_triangles(u, more[0]) == 1 && mesh_.edge_triangles(v, more[0]) == 1);
  }

  bool leaves_border(std::uint32_t u, std::uint32_t v) { return at_border(u) && !at_border(v); }
  bool at_border(std::uint32_t p) { return mesh_.ring(p).size() != mesh_.star(p).size(); }

  /// Would a triangle land on one that is there, as when a tetrahedron is flattened?
  bool doubled(std::uint32_t u, std::uint32_t v) {
    for (std::uint32_t t : mesh_.star(u)) {
      if (mesh_.has_point(t, v)) continue;
      const auto base = other_points(t, u);
      for (std::uint32_t s : mesh_.star(v))
        if (!mesh_.has_point(s, u) && other_points(s, v) == base) return true;
    }
    return false;
  }

  std::pair<std::uint32_t, std::uint32_t> other_points(std::uint32_t t, std::uint32_t p) const {
    std::uint32_t low = 0xFFFFFFFFu, high = 0;
    for (std::uint32_t w : mesh_.corners(t)) {
      const std::uint32_t q = mesh_.point(w);
      if (q == p) continue;
      low = std::min(low, q);
      high = std::max(high, q);
    }
    return {low, high};
  }

  /// Turns of the triangles that stay, and the births of all that this substitution depends on.
  void check_patch(std::span<const Child> run, std::uint32_t u, std::uint32_t v) {
    bool modifies = false;
    for (std::uint32_t t : mesh_.star(u)) {
      check_birth(run[0], t);
      if (mesh_.has_point(t, v)) continue;
      modifies = true;
      check_turn(run, t);
      changed_.push_back(t);
    }
    if (!modifies) depend_on_star(run[0], v);  // the tip of an ear
  }

  /// What is left around v stands for what went, so it depends on its births and is reborn.
  void depend_on_star(const Child& child, std::uint32_t v) {
    const std::uint32_t u = mesh_.point(child.vertex);
    for (std::uint32_t t : mesh_.star(v)) {
      if (mesh_.has_point(t, u)) continue;
      check_birth(child, t);
      changed_.push_back(t);
    }
  }

  void check_turn(std::span<const Child> run, std::uint32_t t) {
    const auto now = mesh_.substituted(t, run);
    const Vec3d before = mesh_.normal(mesh_.corners(t)), after = mesh_.normal(now);
    if (vertical_) {
      for (std::uint32_t w : now)
        if (!(dot(after, vertical_->direction(mesh_.position(w))) > 0))
          return illegal(run[0], " turns triangle " + std::to_string(t) + " over, seen from above");
      return;
    }
    const double scale = length(before) * length(after);
    const double cosine = scale > 0 ? dot(before, after) / scale : -1;
    report_.least_cosine = std::min(report_.least_cosine, cosine);
    if (cosine < least_turn_cosine)
      illegal(run[0], " turns triangle " + std::to_string(t) + ": cosine " + std::to_string(cosine));
  }

  void check_birth(const Child& child, std::uint32_t t) {
    const Birth& birth = births_[t];
    if (decode_error(child.error) < birth.error)
      unsaturated(child, "'s error " + std::to_string(decode_error(child.error)) + " is below " +
                             std::to_string(birth.error) + ", that of an earlier fan of triangle " +
                             std::to_string(t));
    if (birth.sphere.radius > 0 && !contains(sphere_, birth.sphere))
      unsaturated(child,
                  "'s sphere does not contain that of an earlier fan of triangle " + std::to_string(t));
    for (std::uint32_t w : mesh_.corners(t))
      if (!contains(sphere_, {vec_cast<float>(positions_[w]), 0}))
        return unsaturated(child, "'s sphere does not contain vertex " + std::to_string(w) + " of its patch");
  }

  void illegal(const Child& child, const std::string& what) {
    report_.add(Check::legal, id_, number_, arrow(child) + what);
  }
  void unsaturated(const Child& child, const std::string& what) {
    report_.add(Check::saturated, id_, number_, arrow(child) + what);
  }

  ReplayedSurvivors survivors() {
    ReplayedSurvivors out;
    const auto owned = page_.base ? std::vector<std::uint8_t>(page_.vertex_count, 0) : owned_vertices(page_);
    std::vector<std::uint32_t> rank(page_.vertex_count, 0);
    std::vector<std::uint8_t> used(page_.vertex_count, 0);
    for (std::uint32_t v = 0; v < page_.vertex_count; ++v)
      if (!owned[v]) rank[v] = out.vertices++;
    for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
      if (!mesh_.alive(t)) continue;
      auto c = mesh_.corners(t);
      for (std::uint32_t& v : c) {
        if (owned[v])
          report_.add(Check::sources, id_, v,
                      "an orphaned vertex is used by surviving triangle " + std::to_string(t));
        used[v] = 1;
        v = rank[v];
      }
      out.triangles.push_back(smallest_first(c));
      out.births.push_back(births_[t]);
    }
    for (std::uint32_t v = 0; v < page_.vertex_count && !page_.base; ++v)
      if (!owned[v] && !used[v])
        report_.add(Check::sources, id_, v, "a surviving vertex is used by no triangle");
    out.removed_triangles = removed_;
    return out;
  }

  PageId id_;
  const Page& page_;
  std::span<const Vec3i> positions_;
  std::vector<Birth> births_;
  const std::optional<Vertical>& vertical_;
  VerifyReport& report_;
  ReplayMesh mesh_;
  Sphere sphere_;
  std::uint64_t number_ = 0;
  std::uint32_t removed_ = 0;
  bool loose_ = false;  // the link condition is let go, and only counted
  std::vector<std::uint32_t> changed_;
};

}  // namespace

ReplayedSurvivors verify_script(PageId id, const Page& page, std::span<const Vec3i> positions,
                                std::vector<Birth> births, const std::optional<Vertical>& vertical,
                                VerifyReport& report) {
  return ScriptCheck(id, page, positions, std::move(births), vertical, report).run();
}

}  // namespace cuesta
