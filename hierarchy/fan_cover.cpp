#include "hierarchy/fan_cover.h"

#include <algorithm>
#include <array>
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

/// Replays a script, fan by fan. What one look needs of a triangle, or of a vertex, is in half a cache line.
class FanCover {
 public:
  FanCover(const CoveredMesh& mesh, std::vector<std::uint32_t>& changed, const FanSphere& sphere)
      : births_(mesh.births),
        sphere_(sphere),
        vertices_(mesh.positions.size()),
        triangles_(mesh.triangles.size()),
        changed_by_(changed),
        looks_left_(most_looks(mesh.triangles.size())) {
    for (std::uint32_t v = 0; v < vertices_.size(); ++v)
      vertices_[v] = {mesh.first_wedge[v], nobody, nobody, no_fan, vec_cast<float>(mesh.positions[v])};
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      triangles_[t] = {mesh.triangles[t], {nobody, nobody, nobody}, no_fan, 0};
      for (std::uint32_t k = 0; k < 3; ++k) append(mesh.triangles[t][k], t * 3 + k);
    }
  }

  bool run(Script& script, std::span<const Vec3i> positions) {
    spheres_.reserve(script.fans.size());
    ball_in_.assign(script.fans.size(), no_fan);
    for (fan_ = 0; fan_ < script.fans.size(); ++fan_) {
      Fan& fan = script.fans[fan_];
      guards_ = fan_ >= script.strict_fans;
      balls_.clear();
      birth_balls_.clear();
      changed_.clear();
      const auto children = std::span(script.children).subspan(fan.first_child, fan.child_count);
      for (std::size_t i = 0, end = 0; i < children.size(); i = end) {
        for (end = i + 1; end < children.size() && children[end].joined;) ++end;
        if (!substitute(children.subspan(i, end - i))) return false;
      }
      const Vec3i centre = positions[fan.centre];
      const SphereCode follows = balls_.empty() ? SphereCode{} : enclose(balls_, centre);
      fan.sphere = sphere_ ? sphere_(fan_, follows) : follows;
      spheres_.push_back(decode_sphere(fan.sphere, centre));
      for (const std::uint32_t t : changed_) triangles_[t].changed_by = fan_;
    }
    changed_by_.clear();
    for (const TriangleState& t : triangles_) changed_by_.push_back(t.changed_by);
    return true;
  }

 private:
  static constexpr std::uint32_t gone = ~std::uint32_t{0};

  struct TriangleState {
    std::array<std::uint32_t, 3> corners;
    std::array<std::uint32_t, 3> next;  // corner in the list of its vertex; corner k of triangle t is 3 t + k
    std::uint32_t changed_by;           // the last fan
    std::uint32_t seen;                 // in this substitution; or gone
  };
  struct VertexState {
    std::uint32_t point;        // first of its wedge group
    std::uint32_t first, last;  // of its corners
    std::uint32_t covered_by;   // a point: the last fan
    Vec3f position;
  };

  void append(std::uint32_t v, std::uint32_t corner) {
    VertexState& at = vertices_[v];
    next(corner) = nobody;
    (at.first == nobody ? at.first : next(at.last)) = corner;
    at.last = corner;
  }
  std::uint32_t& next(std::uint32_t corner) { return triangles_[corner / 3].next[corner % 3]; }
  std::uint32_t point(std::uint32_t v) const { return vertices_[v].point; }
  bool lives(std::uint32_t t) const { return triangles_[t].seen != gone; }

  /// Live triangles around a point that have not been seen in this substitution, to the end of `out`.
  void gather(std::uint32_t p, std::vector<std::uint32_t>& out) {
    for (std::uint32_t v = p; v < vertices_.size() && point(v) == p; ++v)
      for (std::uint32_t c = vertices_[v].first; c != nobody && looks_left_ > 0; --looks_left_) {
        TriangleState& t = triangles_[c / 3];
        if (t.seen != gone && std::exchange(t.seen, stamp_) != stamp_) out.push_back(c / 3);
        c = t.next[c % 3];
      }
  }

  /// One substitution: the wedges of a point, or all vertices of a component.
  bool substitute(std::span<const Child> run) {
    const std::uint32_t target = point(run.front().target);
    ++stamp_;
    patch_.clear();
    std::uint32_t before = nobody;
    for (const Child& c : run)
      if (const std::uint32_t p = point(c.vertex); p != std::exchange(before, p)) gather(p, patch_);
    const std::size_t around_it = patch_.size();
    if (guards_) gather_guarded(target);
    for (const std::uint32_t t : patch_) cover(t);
    for (const Child& c : run) move(c);
    bool some_left = false;
    for (std::size_t i = 0; i < patch_.size(); ++i) {
      if (!lives(patch_[i])) continue;
      changed_.push_back(patch_[i]);
      some_left |= i < around_it;
    }
    if (!some_left) cover_around(target);
    return looks_left_ > 0;
  }

  /// Behind the patch: what is around the third corners of triangles that go.
  void gather_guarded(std::uint32_t target) {
    const std::size_t around_it = patch_.size();
    for (std::size_t i = 0; i < around_it; ++i) {
      const auto corners = triangles_[patch_[i]].corners;
      const auto is_target = [&](std::uint32_t v) { return point(v) == target; };
      if (std::none_of(corners.begin(), corners.end(), is_target)) continue;
      for (const std::uint32_t v : corners)
        if (!is_target(v)) gather(point(v), patch_);
    }
  }

  /// What is left around the target stands for what went.
  void cover_around(std::uint32_t target) {
    ++stamp_;
    const std::size_t first = changed_.size();
    gather(target, changed_);
    for (std::size_t i = first; i < changed_.size(); ++i) cover(changed_[i]);
  }

  /// The ball that the triangle was born with and its corners; each once in a fan.
  void cover(std::uint32_t t) {
    const TriangleState& triangle = triangles_[t];
    if (triangle.changed_by != no_fan) {
      if (std::exchange(ball_in_[triangle.changed_by], fan_) != fan_)
        balls_.push_back(spheres_[triangle.changed_by]);
    } else if (!births_.empty() && births_[t].sphere.radius > 0) {
      cover_birth(births_[t].sphere);
    }
    for (const std::uint32_t v : triangle.corners) {
      VertexState& at = vertices_[point(v)];
      if (std::exchange(at.covered_by, fan_) != fan_) balls_.push_back({at.position, 0});
    }
  }

  void cover_birth(const Sphere& ball) {
    const bool known = std::any_of(birth_balls_.rbegin(), birth_balls_.rend(), [&](const Sphere& b) {
      return b.radius == ball.radius && b.centre == ball.centre;
    });
    if (known) return;
    birth_balls_.push_back(ball);
    balls_.push_back(ball);
  }

  void move(const Child& child) {
    for (std::uint32_t corner = std::exchange(vertices_[child.vertex].first, nobody); corner != nobody;) {
      TriangleState& t = triangles_[corner / 3];
      const std::uint32_t following = t.next[corner % 3];
      if (t.seen != gone) {
        auto& c = t.corners;
        if (c[0] == child.target || c[1] == child.target || c[2] == child.target) {
          t.seen = gone;
        } else {
          c[corner % 3] = child.target;
          append(child.target, corner);
        }
      }
      corner = following;
    }
  }

  std::span<const Birth> births_;
  const FanSphere& sphere_;
  std::vector<VertexState> vertices_;
  std::vector<TriangleState> triangles_;
  std::vector<std::uint32_t>& changed_by_;
  std::size_t looks_left_;
  std::uint32_t stamp_ = 0;
  std::vector<Sphere> spheres_;         // of the fans before
  std::vector<std::uint32_t> ball_in_;  // per fan: the last fan that has its sphere among its balls

  // Of the fan that is being made, and of its substitution.
  std::uint32_t fan_ = 0;
  bool guards_ = false;
  std::vector<Sphere> balls_, birth_balls_;
  std::vector<std::uint32_t> changed_, patch_;
};

}  // namespace

bool cover_fans(const CoveredMesh& mesh, Script& script, std::vector<std::uint32_t>& changed,
                const FanSphere& sphere) {
  return FanCover(mesh, changed, sphere).run(script, mesh.positions);
}

}  // namespace cuesta
