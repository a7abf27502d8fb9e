#include "tools/bench/total_order.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <queue>

#include "hierarchy/quadric.h"

namespace cuesta::bench {
namespace {

using Vertices = std::vector<std::uint32_t>;

class Simplifier {
 public:
  Simplifier(const SurfaceMesh& mesh, const Restriction& restriction)
      : positions_(mesh.positions),
        triangles_(mesh.triangles),
        restriction_(restriction),
        star_(positions_.size()),
        quadric_(positions_.size()),
        moved_(positions_.size()),
        version_(positions_.size()) {
    std::erase_if(triangles_, [](const Triangle& t) { return is_degenerate(t); });
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const Vec3d n = normal(triangles_[t]);
      const double twice_area = std::sqrt(dot(n, n));
      for (const std::uint32_t v : triangles_[t]) {
        star_[v].push_back(t);
        if (twice_area > 0)
          quadric_[v].add_plane(vec_cast<float>(n * (1 / twice_area)), static_cast<float>(twice_area / 2));
      }
    }
  }

  /// Pairs u, v in the order in which they were applied.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> run() {
    for (std::uint32_t u = 0; u < positions_.size(); ++u) queue(u);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> done;
    while (!heap_.empty()) {
      const Candidate c = heap_.top();
      heap_.pop();
      if (moved_[c.u] || c.version != version_[c.u]) continue;
      if (moved_[c.v] || !is_legal(c.u, c.v)) {
        queue(c.u);
        continue;
      }
      done.emplace_back(c.u, c.v);
      substitute(c.u, c.v);
    }
    return done;
  }

 private:
  struct Candidate {
    float cost;
    std::uint32_t u, v, version;
    bool operator<(const Candidate& o) const { return cost != o.cost ? cost > o.cost : u > o.u; }
  };

  Vec3d normal(const Triangle& t) const {
    return cross(positions_[t[1]] - positions_[t[0]], positions_[t[2]] - positions_[t[0]]);
  }
  bool has(std::uint32_t t, std::uint32_t v) const {
    const Triangle& c = triangles_[t];
    return c[0] == v || c[1] == v || c[2] == v;
  }
  Vertices neighbours(std::uint32_t u) const {
    Vertices near;
    for (const std::uint32_t t : star_[u])
      for (const std::uint32_t v : triangles_[t])
        if (v != u) near.push_back(v);
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    return near;
  }
  static Vertices common(const Vertices& a, const Vertices& b) {
    Vertices both;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
    return both;
  }

  /// Whether the triangles around u follow each other, once around or from border to border.
  bool is_fan(std::uint32_t u) const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> rim;  // counter-clockwise
    for (const std::uint32_t t : star_[u]) {
      const Triangle& c = triangles_[t];
      const int at = c[0] == u ? 0 : c[1] == u ? 1 : 2;
      rim.emplace_back(c[static_cast<std::size_t>((at + 1) % 3)], c[static_cast<std::size_t>((at + 2) % 3)]);
    }
    for (std::size_t i = 0; i + 1 < rim.size(); ++i) {
      const auto follows = [&](const auto& e) { return e.first == rim[i].second; };
      auto next = std::find_if(rim.begin() + static_cast<std::ptrdiff_t>(i) + 1, rim.end(), follows);
      if (next == rim.end()) {  // a border: go on from where the fan so far begins
        const auto leads = [&](const auto& e) { return e.second == rim[0].first; };
        next = std::find_if(rim.begin() + static_cast<std::ptrdiff_t>(i) + 1, rim.end(), leads);
        if (next == rim.end()) return false;
        std::rotate(rim.begin(), next, next + 1);
      } else {
        std::iter_swap(rim.begin() + static_cast<std::ptrdiff_t>(i) + 1, next);
      }
    }
    return true;
  }

  bool is_legal(std::uint32_t u, std::uint32_t v) const {
    if (restriction_.allows && !restriction_.allows(u, v)) return false;
    const Vertices near = neighbours(u), beside = neighbours(v);
    std::size_t shared = 0;
    for (const std::uint32_t t : star_[u]) shared += has(t, v);
    const bool on_border = near.size() != star_[u].size();
    if (shared != (on_border ? 1u : 2u) || common(near, beside).size() != shared || beside.size() < 4)
      return false;
    return is_fan(u) && std::all_of(star_[u].begin(), star_[u].end(), [&](std::uint32_t t) {
             if (has(t, v)) return true;
             Triangle after = triangles_[t];
             std::replace(after.begin(), after.end(), u, v);
             const Vec3d a = normal(triangles_[t]), b = normal(after);
             return dot(a, b) >= 0.1 * std::sqrt(dot(a, a) * dot(b, b));
           });
  }

  void queue(std::uint32_t u) {
    Candidate best{INFINITY, u, u, ++version_[u]};
    const float divisor = std::sqrt(quadric_[u].weight);
    for (const std::uint32_t v : neighbours(u)) {
      const float cost =
          divisor > 0 ? quadric_[u].at(vec_cast<float>(positions_[v] - positions_[u])) / divisor : 0;
      if (cost < best.cost && is_legal(u, v)) best.cost = cost, best.v = v;
    }
    if (best.v != u) heap_.push(best);
  }

  void substitute(std::uint32_t u, std::uint32_t v) {
    const Vertices around = neighbours(u), shared = common(around, neighbours(v));
    moved_[u] = true;
    for (const std::uint32_t t : star_[u]) {
      if (has(t, v)) {
        for (const std::uint32_t w : triangles_[t])
          if (w != u) std::erase(star_[w], t);
      } else {
        std::replace(triangles_[t].begin(), triangles_[t].end(), u, v);
        star_[v].push_back(t);
      }
    }
    star_[u] = {};
    quadric_[v].add(quadric_[u], vec_cast<float>(positions_[u] - positions_[v]));
    if (restriction_.applied) restriction_.applied(u, v, around, shared);
    Vertices changed = neighbours(v);
    changed.push_back(v);
    for (const std::uint32_t w : changed) queue(w);
  }

  const std::vector<Vec3d>& positions_;
  std::vector<Triangle> triangles_;
  const Restriction& restriction_;
  std::vector<Vertices> star_;
  std::vector<Quadric> quadric_;
  std::vector<bool> moved_;
  std::vector<std::uint32_t> version_;
  std::priority_queue<Candidate> heap_;
};

}  // namespace

TotalOrder order_by_quadrics(const SurfaceMesh& mesh, const Restriction& restriction) {
  const auto done = Simplifier(mesh, restriction).run();
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  Vertices number(n, kNone);
  for (std::uint32_t i = 0; i < done.size(); ++i) number[done[i].first] = n - 1 - i;
  std::uint32_t next = 0;
  for (std::uint32_t& v : number)
    if (v == kNone) v = next++;
  TotalOrder order{std::vector<Vec3d>(n), mesh.triangles, Vertices(n), next};
  for (std::uint32_t v = 0; v < n; ++v) order.positions[number[v]] = mesh.positions[v];
  for (const auto& [u, v] : done) order.substitute[number[u]] = number[v];
  for (Triangle& t : order.triangles)
    for (std::uint32_t& v : t) v = number[v];
  return order;
}

}  // namespace cuesta::bench
