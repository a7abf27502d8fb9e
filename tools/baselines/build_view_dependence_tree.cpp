#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "hierarchy/quadric.h"
#include "ooc/check.h"
#include "tools/baselines/view_dependence_tree.h"

namespace cuesta::baselines {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
constexpr std::uint32_t none = 0xFFFFFFFFu;
/// Weight of the planes that hold a border in place, against that of a triangle on a square over the border's
/// edge.
constexpr float border_weight = 10;

/// An edge in the heap. Stale when the sum of the versions of its vertices is another.
struct Candidate {
  float cost;
  std::uint32_t from, to;
  std::uint32_t version;  // sum of versions · 2 + 1 if it is the second direction that is tried

  bool operator<(const Candidate& o) const {  // the heap's top is the largest
    if (cost != o.cost) return cost > o.cost;
    return from != o.from ? from > o.from : to > o.to;
  }
};

class Builder {
 public:
  Builder(std::span<const Vec3f> positions, std::span<const Triangle> triangles) {
    tree_.positions.assign(positions.begin(), positions.end());
    tree_.triangles.assign(triangles.begin(), triangles.end());
    tree_.leaves = static_cast<std::uint32_t>(positions.size());
    tree_.parent.assign(positions.size(), no_node);
    tree_.parent.reserve(positions.size() * 2);
    tree_.internal.reserve(positions.size() + 1);
    node_.resize(positions.size());
    for (std::uint32_t v = 0; v < positions.size(); ++v) node_[v] = v;
    alive_.assign(triangles.size(), true);
    version_.assign(positions.size(), 0);
    mark_.assign(positions.size(), 0);
    in_new_star_.assign(positions.size(), 0);
    link_corners();
    make_quadrics();
  }

  ViewDependenceTree run() {
    fill_heap();
    while (!heap_.empty() || retry()) {
      const Candidate c = heap_.top();
      heap_.pop();
      if (!is_current(c)) continue;
      if (is_legal(c.from, c.to))
        collapse(c);
      else
        put_off(c);
    }
    tree_.internal.push_back({});
    tree_.internal.back().first_corner = static_cast<std::uint32_t>(tree_.corners.size());
    return std::move(tree_);
  }

 private:
  // Corners of a vertex are a linked list; those of removed triangles leave it when it is walked.
  void link_corners() {
    head_.assign(tree_.positions.size(), none);
    next_.resize(tree_.triangles.size() * 3);
    for (std::uint32_t c = static_cast<std::uint32_t>(next_.size()); c-- > 0;) {
      std::uint32_t& head = head_[corner(c)];
      next_[c] = head;
      head = c;
    }
  }
  std::uint32_t& corner(std::uint32_t c) { return tree_.triangles[c / 3][c % 3]; }

  template <class F>
  void for_each_corner(std::uint32_t v, const F& f) {
    std::uint32_t* link = &head_[v];
    while (*link != none) {
      const std::uint32_t c = *link;
      if (alive_[c / 3]) {
        f(c / 3, c % 3);
        link = &next_[c];
      } else {
        *link = next_[c];
      }
    }
  }

  Vec3f normal_times_area(const Triangle& t) const {
    const auto& p = tree_.positions;
    return cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]) * 0.5f;
  }

  void make_quadrics() {
    quadric_.resize(tree_.positions.size());
    border_.assign(tree_.positions.size(), false);
    for (const Triangle& t : tree_.triangles) {
      const Vec3f n = normal_times_area(t);
      const float area = length(n);
      if (area > 0)
        for (const std::uint32_t v : t) quadric_[v].add_plane(n / area, area);
    }
    for (const Triangle& t : tree_.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        if (const std::uint32_t a = t[k], b = t[(k + 1) % 3]; triangles_at_edge(a, b) == 1)
          hold_border(t, a, b);
  }

  int triangles_at_edge(std::uint32_t a, std::uint32_t b) {
    int count = 0;
    for_each_corner(a, [&](std::uint32_t t, std::uint32_t) {
      const Triangle& x = tree_.triangles[t];
      count += x[0] == b || x[1] == b || x[2] == b;
    });
    return count;
  }

  void hold_border(const Triangle& t, std::uint32_t a, std::uint32_t b) {
    border_[a] = border_[b] = true;
    const Vec3f edge = tree_.positions[b] - tree_.positions[a];
    const Vec3f n = normalized(cross(normalized(edge), normalized(normal_times_area(t))));
    for (const std::uint32_t v : {a, b}) quadric_[v].add_plane(n, dot(edge, edge) * border_weight);
  }

  /// Mean squared distance of `to` to the planes of both.
  float cost(std::uint32_t from, std::uint32_t to) const {
    const float weight = quadric_[from].weight + quadric_[to].weight;
    if (!(weight > 0)) return 0;
    return (quadric_[from].at(tree_.positions[to] - tree_.positions[from]) + quadric_[to].at({})) / weight;
  }

  Candidate candidate(std::uint32_t a, std::uint32_t b) const {
    const float ab = cost(a, b), ba = cost(b, a);
    const std::uint32_t version = (version_[a] + version_[b]) * 2;
    return ab <= ba ? Candidate{ab, a, b, version} : Candidate{ba, b, a, version};
  }

  void fill_heap() {
    std::vector<Candidate> edges;
    edges.reserve(tree_.positions.size() * 3);
    for (const Triangle& t : tree_.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        if (a < b || (border_[a] && border_[b] && triangles_at_edge(a, b) == 1))
          edges.push_back(candidate(a, b));
      }
    heap_ = std::priority_queue<Candidate>({}, std::move(edges));
  }

  bool is_current(const Candidate& c) const {
    return node_[c.from] != no_node && node_[c.to] != no_node &&
           version_[c.from] + version_[c.to] == c.version / 2;
  }

  /// The other direction, else until other edges have been collapsed.
  void put_off(const Candidate& c) {
    if (c.version % 2 == 0)
      heap_.push({std::max(cost(c.to, c.from), c.cost), c.to, c.from, c.version + 1});
    else
      put_off_.push_back(c);
  }

  bool retry() {
    if (collapses_ == collapses_at_retry_) return false;
    collapses_at_retry_ = collapses_;
    for (const Candidate& c : std::exchange(put_off_, {}))
      if (is_current(c)) heap_.push(candidate(c.from, c.to));
    return !heap_.empty();
  }

  /// Fills moved_, kept_ and removed_.
  bool is_legal(std::uint32_t from, std::uint32_t to) {
    moved_.clear(), kept_.clear(), removed_.clear();
    // The link condition: a vertex next to both is the third corner of a triangle at the edge.
    ++stamp_;
    for_each_corner(to, [&](std::uint32_t t, std::uint32_t c) {
      const Triangle& x = tree_.triangles[t];
      const std::uint32_t a = x[(c + 1) % 3], b = x[(c + 2) % 3];
      if (a == from || b == from) {
        removed_.push_back(t * 4);
      } else {
        kept_.push_back(t * 4 + c);
        in_new_star_[a] = in_new_star_[b] = stamp_;
      }
      mark_[a] = mark_[b] = stamp_;
    });
    if (removed_.empty() || removed_.size() > 2) return false;
    if (border_[from] && !(border_[to] && removed_.size() == 1)) return false;
    if (border_[to] && border_[from] && removed_.size() == 2) return false;
    std::size_t common = 0;
    bool turned = false;
    for_each_corner(from, [&](std::uint32_t t, std::uint32_t c) {
      const Triangle& x = tree_.triangles[t];
      const std::uint32_t a = x[(c + 1) % 3], b = x[(c + 2) % 3];
      for (const std::uint32_t w : {a, b})
        if (w != to && mark_[w] == stamp_) mark_[w] = 0, ++common;
      if (a == to || b == to) return;
      moved_.push_back(t * 4 + c);
      in_new_star_[a] = in_new_star_[b] = stamp_;
      turned = turned || turns_over(x, c, to);
    });
    if (turned || common != removed_.size() || moved_.size() + kept_.size() == 0) return false;
    // What stays must still be a surface: not two triangles back to back, no vertex without a triangle.
    if (!border_[from] && moved_.size() == 1 && kept_.size() == 1) return false;
    for (const CornerRef r : removed_)
      for (const std::uint32_t w : tree_.triangles[r / 4])
        if (w != from && w != to && in_new_star_[w] != stamp_) return false;
    return moved_.size() <= 0xFFFF && kept_.size() <= 0xFFFF;
  }

  bool turns_over(Triangle t, std::uint32_t c, std::uint32_t to) const {
    const Vec3f before = normal_times_area(t);
    t[c] = to;
    return dot(before, normal_times_area(t)) <= 0;
  }

  void collapse(const Candidate& c) {
    const NodeId id = static_cast<NodeId>(tree_.parent.size());
    const NodeId left = node_[c.to], right = node_[c.from];
    const auto first = static_cast<std::uint32_t>(tree_.corners.size());
    for (const auto* list : {&moved_, &kept_, &removed_})
      tree_.corners.insert(tree_.corners.end(), list->begin(), list->end());
    const float error = std::max({std::sqrt(c.cost), tree_.error_of(left), tree_.error_of(right)});
    tree_.internal.push_back({left, right, c.to, error, radius_of(c, left, right), first,
                              static_cast<std::uint16_t>(moved_.size()),
                              static_cast<std::uint16_t>(kept_.size())});
    tree_.parent.push_back(no_node);
    tree_.parent[left] = tree_.parent[right] = id;
    node_[c.to] = id;
    node_[c.from] = no_node;
    apply(c);
    ++collapses_;
  }

  float radius_of(const Candidate& c, NodeId left, NodeId right) const {
    const auto& p = tree_.positions;
    const auto own = [&](NodeId n) { return tree_.is_leaf(n) ? 0 : tree_.node(n).radius; };
    float radius = std::max(own(left), length(p[c.from] - p[c.to]) + own(right));
    for (const auto* list : {&moved_, &kept_})
      for (const CornerRef r : *list)
        for (const std::uint32_t v : tree_.triangles[r / 4])
          radius = std::max(radius, length(p[v] - p[c.to]));
    return radius * (1 + 0x1p-20f);
  }

  void apply(const Candidate& c) {
    for (const CornerRef r : removed_) alive_[r / 4] = false;
    for (const CornerRef r : moved_) {
      const std::uint32_t k = r / 4 * 3 + r % 4;
      corner(k) = c.to;
      next_[k] = head_[c.to];
      head_[c.to] = k;
    }
    quadric_[c.to].add(quadric_[c.from], tree_.positions[c.from] - tree_.positions[c.to]);
    ++version_[c.to];
    ++stamp_;
    for_each_corner(c.to, [&](std::uint32_t t, std::uint32_t) {
      for (const std::uint32_t w : tree_.triangles[t])
        if (w != c.to && mark_[w] != stamp_) {
          mark_[w] = stamp_;
          heap_.push(candidate(w, c.to));
        }
    });
  }

  ViewDependenceTree tree_;
  std::vector<NodeId> node_;  // of each vertex, no_node once it is gone
  std::vector<std::uint32_t> head_, next_;
  std::vector<bool> alive_, border_;
  std::vector<Quadric> quadric_;
  std::vector<std::uint32_t> version_;
  std::vector<std::uint32_t> mark_, in_new_star_;
  std::uint32_t stamp_ = 0;
  std::priority_queue<Candidate> heap_;
  std::vector<Candidate> put_off_;
  std::vector<CornerRef> moved_, kept_, removed_;
  std::uint64_t collapses_ = 0, collapses_at_retry_ = 0;
};

}  // namespace

std::uint64_t ViewDependenceTree::bytes() const {
  return parent.size() * sizeof(NodeId) + internal.size() * sizeof(InternalNode) +
         corners.size() * sizeof(CornerRef);
}

ViewDependenceTree build_view_dependence_tree(std::span<const Vec3f> positions,
                                              std::span<const std::array<std::uint32_t, 3>> triangles) {
  CUESTA_CHECK(positions.size() < (std::size_t{1} << 30) && triangles.size() < (std::size_t{1} << 30));
  return Builder(positions, triangles).run();
}

}  // namespace cuesta::baselines
