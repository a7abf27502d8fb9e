#include "hierarchy/fan_cover.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "hierarchy/bounding_sphere.h"

namespace cuesta {
namespace {

constexpr std::uint32_t nobody = ~std::uint32_t{0};

/// Usual scripts look at some 30 triangles for each substitution. More than this many per triangle of the
/// mesh is an attack: a chain of substitutions that carries a whole page along takes the square of the page.
constexpr std::size_t most_looks(std::size_t triangles) {
  return std::max(std::size_t{1} << 24, triangles * 256);
}

/// Replays a script, fan by fan.
class FanCover {
 public:
  FanCover(const CoveredMesh& mesh, std::vector<std::uint32_t>& changed, const FanSphere& sphere)
      : mesh_(mesh),
        sphere_(sphere),
        corners_(mesh.triangles.begin(), mesh.triangles.end()),
        first_corner_(mesh.positions.size(), nobody),
        last_corner_(mesh.positions.size(), nobody),
        next_corner_(mesh.triangles.size() * 3, nobody),
        alive_(mesh.triangles.size(), 1),
        seen_triangle_(mesh.triangles.size(), 0),
        covered_by_(mesh.positions.size(), nobody),
        changed_by_(changed),
        looks_left_(most_looks(mesh.triangles.size())) {
    changed_by_.assign(corners_.size(), no_fan);
    for (std::uint32_t t = 0; t < corners_.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k) append(corners_[t][k], t * 3 + k);
  }

  bool run(Script& script) {
    spheres_.reserve(script.fans.size());
    for (fan_ = 0; fan_ < script.fans.size(); ++fan_) {
      Fan& fan = script.fans[fan_];
      guards_ = fan_ >= script.strict_fans;
      balls_.clear();
      born_balls_.clear();
      changed_.clear();
      const auto children = std::span(script.children).subspan(fan.first_child, fan.child_count);
      for (std::size_t i = 0, end = 0; i < children.size(); i = end) {
        for (end = i + 1; end < children.size() && children[end].joined;) ++end;
        if (!substitute(children.subspan(i, end - i))) return false;
      }
      const Vec3i centre = mesh_.positions[fan.centre];
      const SphereCode follows = balls_.empty() ? SphereCode{} : enclose(balls_, centre);
      fan.sphere = sphere_ ? sphere_(fan_, follows) : follows;
      spheres_.push_back(decode_sphere(fan.sphere, centre));
      for (const std::uint32_t t : changed_) changed_by_[t] = fan_;
    }
    return true;
  }

 private:
  void append(std::uint32_t v, std::uint32_t corner) {
    next_corner_[corner] = nobody;
    (first_corner_[v] == nobody ? first_corner_[v] : next_corner_[last_corner_[v]]) = corner;
    last_corner_[v] = corner;
  }

  std::uint32_t point(std::uint32_t v) const { return mesh_.first_wedge[v]; }
  bool has_point(std::uint32_t t, std::uint32_t p) const {
    return std::any_of(corners_[t].begin(), corners_[t].end(),
                       [&](std::uint32_t v) { return point(v) == p; });
  }

  /// Live triangles around a point that have not been seen in this substitution, to the end of `out`.
  void gather(std::uint32_t p, std::vector<std::uint32_t>& out) {
    for (std::uint32_t v = p; v < mesh_.first_wedge.size() && point(v) == p; ++v)
      for (std::uint32_t c = first_corner_[v]; c != nobody && looks_left_ > 0;
           c = next_corner_[c], --looks_left_)
        if (alive_[c / 3] && std::exchange(seen_triangle_[c / 3], stamp_) != stamp_) out.push_back(c / 3);
  }

  /// One substitution: the wedges of a point, or all vertices of a component.
  bool substitute(std::span<const Child> run) {
    const std::uint32_t target = point(run.front().target);
    ++stamp_;
    patch_.clear();
    std::uint32_t before = nobody;
    for (const Child& c : run)
      if (const std::uint32_t p = point(c.vertex); p != std::exchange(before, p)) gather(p, patch_);
    const auto around_it = static_cast<std::ptrdiff_t>(patch_.size());
    if (guards_) gather_guarded(target);
    for (const std::uint32_t t : patch_) cover(t);
    for (const Child& c : run) move(c);
    const auto lives = [this](std::uint32_t t) { return alive_[t] != 0; };
    std::copy_if(patch_.begin(), patch_.end(), std::back_inserter(changed_), lives);
    if (std::none_of(patch_.begin(), patch_.begin() + around_it, lives)) {
      ++stamp_;
      const std::size_t first = changed_.size();
      gather(target, changed_);
      for (std::size_t i = first; i < changed_.size(); ++i) cover(changed_[i]);
    }
    return looks_left_ > 0;
  }

  /// Behind the patch: what is around the third corners of triangles that go.
  void gather_guarded(std::uint32_t target) {
    const std::size_t patch_size = patch_.size();
    for (std::size_t i = 0; i < patch_size; ++i) {
      const std::uint32_t t = patch_[i];
      if (!has_point(t, target)) continue;
      for (const std::uint32_t v : corners_[t])
        if (point(v) != target) gather(point(v), patch_);
    }
  }

  /// The triangle's corners and the ball it was born with; each once in a fan.
  void cover(std::uint32_t t) {
    if (const std::uint32_t fan = changed_by_[t]; fan != no_fan)
      cover_ball(spheres_[fan]);
    else if (!mesh_.births.empty() && mesh_.births[t].sphere.radius > 0)
      cover_ball(mesh_.births[t].sphere);
    for (const std::uint32_t v : corners_[t])
      if (std::exchange(covered_by_[point(v)], fan_) != fan_)
        balls_.push_back({vec_cast<float>(mesh_.positions[v]), 0});
  }

  void cover_ball(const Sphere& ball) {
    const bool known = std::any_of(born_balls_.rbegin(), born_balls_.rend(), [&](std::uint32_t i) {
      return balls_[i].radius == ball.radius && balls_[i].centre == ball.centre;
    });
    if (known) return;
    born_balls_.push_back(static_cast<std::uint32_t>(balls_.size()));
    balls_.push_back(ball);
  }

  void move(const Child& child) {
    for (std::uint32_t corner = std::exchange(first_corner_[child.vertex], nobody); corner != nobody;) {
      const std::uint32_t t = corner / 3, following = next_corner_[corner];
      if (alive_[t]) {
        auto& c = corners_[t];
        alive_[t] = c[0] != child.target && c[1] != child.target && c[2] != child.target;
        c[corner % 3] = child.target;
        if (alive_[t]) append(child.target, corner);
      }
      corner = following;
    }
  }

  CoveredMesh mesh_;
  const FanSphere& sphere_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
  std::vector<std::uint32_t> first_corner_, last_corner_, next_corner_;  // lists of corners, per vertex
  std::vector<std::uint8_t> alive_;
  std::vector<std::uint32_t> seen_triangle_;
  std::uint32_t stamp_ = 0;
  std::vector<std::uint32_t> covered_by_;  // per point: the last fan
  std::vector<std::uint32_t>& changed_by_;
  std::size_t looks_left_;

  // Of the fan that is being made, and of its substitution.
  std::uint32_t fan_ = 0;
  bool guards_ = false;
  std::vector<Sphere> balls_, spheres_;
  std::vector<std::uint32_t> born_balls_, changed_, patch_;
};

}  // namespace

bool cover_fans(const CoveredMesh& mesh, Script& script, std::vector<std::uint32_t>& changed,
                const FanSphere& sphere) {
  return FanCover(mesh, changed, sphere).run(script);
}

}  // namespace cuesta
