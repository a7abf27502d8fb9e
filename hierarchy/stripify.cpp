#include "hierarchy/stripify.h"

#include <algorithm>
#include <numeric>

#include "ooc/edge_twins.h"

namespace cuesta {
namespace {

/// Of each half-edge the one that a strip may go on with, or kNone.
std::vector<std::uint32_t> crossings(std::span<const Triangle> triangles, std::uint32_t vertex_count,
                                     const MayCross& may_cross) {
  std::vector<std::uint32_t> group(vertex_count);
  std::iota(group.begin(), group.end(), 0u);
  std::uint64_t edges_cut = 0;
  auto twins = edge_twins(triangles, group, std::vector<std::uint8_t>(vertex_count), edges_cut);
  if (!may_cross) return twins;
  for (std::uint32_t h = 0; h < twins.size(); ++h)
    if (twins[h] != kNone && !may_cross(start_of(triangles, h), start_of(triangles, twins[h])))
      twins[h] = kNone;
  return twins;
}

class Stripifier {
 public:
  Stripifier(std::span<const Triangle> triangles, std::uint32_t vertex_count, const MayCross& may_cross)
      : triangles_(triangles),
        twins_(crossings(triangles, vertex_count, may_cross)),
        free_(triangles.size()),
        taken_(triangles.size()) {
    for (std::uint32_t h = 0; h < twins_.size(); ++h) free_[h / 3] += twins_[h] != kNone;
    for (auto t = static_cast<std::uint32_t>(triangles.size()); t-- > 0;) by_free_[free_[t]].push_back(t);
  }

  StripSet run() {
    strips_.begin.push_back(0);
    for (std::uint32_t seed = next_seed(); seed != kNone; seed = next_seed()) {
      grow(seed);
      write_strip();
      strips_.begin.push_back(static_cast<std::uint32_t>(strips_.entries.size()));
    }
    return std::move(strips_);
  }

 private:
  std::uint32_t start(std::uint32_t half_edge) const { return start_of(triangles_, half_edge); }

  std::uint32_t next_seed() {
    for (auto& seeds : by_free_)
      while (!seeds.empty()) {
        const std::uint32_t t = seeds.back();
        seeds.pop_back();
        if (!taken_[t] && &seeds == &by_free_[free_[t]]) return t;
      }
    return kNone;
  }

  void take(std::uint32_t t) {
    taken_[t] = true;
    for (std::uint32_t e = 3 * t; e < 3 * t + 3; ++e)
      if (twins_[e] != kNone)
        if (const std::uint32_t other = twins_[e] / 3; !taken_[other])
          by_free_[--free_[other]].push_back(other);
  }

  /// Fills path_ with the edges that a strip through `seed` leaves its triangles by, but for the last
  /// triangle's.
  void grow(std::uint32_t seed) {
    take(seed);
    last_ = seed;
    path_.clear();
    const std::uint32_t out = best_of({3 * seed, 3 * seed + 1, 3 * seed + 2}, kNone);
    if (out == kNone) return;
    extend(out);
    std::vector<std::uint32_t> backwards;
    backwards.swap(path_);
    const std::uint32_t end = last_;
    const std::uint32_t back = best_of({next_half_edge(out), prev_half_edge(out), kNone}, kNone);
    if (back != kNone) extend(back);
    // From the end of the second half over the seed to the end of the first.
    for (std::uint32_t& e : path_) e = twins_[e];
    std::reverse(path_.begin(), path_.end());
    path_.insert(path_.end(), backwards.begin(), backwards.end());
    last_ = end;
  }

  void extend(std::uint32_t out) {
    std::uint32_t straight = kNone;
    for (bool left = true; out != kNone; left = !left) {
      path_.push_back(out);
      const std::uint32_t in = twins_[out], a = next_half_edge(in), b = prev_half_edge(in);
      last_ = in / 3;
      take(last_);
      // Turning left and right by turns needs no turn of the strip.
      straight = left ? a : b;
      out = best_of({a, b, kNone}, straight);
      if (out != kNone && out != straight) left = !left;
    }
  }

  /// Of edges that lead to a free triangle, the one to that with the fewest free neighbours; of equal ones
  /// `straight`.
  std::uint32_t best_of(const std::array<std::uint32_t, 3>& edges, std::uint32_t straight) const {
    std::uint32_t best = kNone, least = kNone;
    for (const std::uint32_t e : edges) {
      if (e == kNone || twins_[e] == kNone || taken_[twins_[e] / 3]) continue;
      const std::uint32_t cost = 2u * free_[twins_[e] / 3] + (e != straight);
      if (cost < least) least = cost, best = e;
    }
    return best;
  }

  void write_strip() {
    auto& to = strips_.entries;
    if (path_.empty()) {
      to.insert(to.end(), {triangles_[last_][0], triangles_[last_][1], triangles_[last_][2]});
      return;
    }
    const std::uint32_t first = path_.front();
    to.insert(to.end(), {start(prev_half_edge(first)), start(first), start(next_half_edge(first))});
    for (std::size_t i = 1; i <= path_.size(); ++i) {
      const std::uint32_t in = twins_[path_[i - 1]];
      const std::uint32_t apex = start(prev_half_edge(in));
      if (i < path_.size()) {
        // The next edge has the apex and should have the last entry; else the entry before is the last once
        // more.
        const std::uint32_t out = path_[i];
        const std::uint32_t kept = start(out) == apex ? start(next_half_edge(out)) : start(out);
        if (kept != to.back()) to.push_back(kept);
      }
      to.push_back(apex);
    }
  }

  std::span<const Triangle> triangles_;
  std::vector<std::uint32_t> twins_;
  std::vector<std::uint8_t> free_;  // neighbours that are not taken
  std::vector<bool> taken_;
  std::array<std::vector<std::uint32_t>, 4> by_free_;
  std::vector<std::uint32_t> path_;
  std::uint32_t last_ = kNone;  // triangle
  StripSet strips_;
};

}  // namespace

StripSet stripify(std::span<const Triangle> triangles, std::uint32_t vertex_count,
                  const MayCross& may_cross) {
  if (triangles.empty()) return {{}, {0}};
  return Stripifier(triangles, vertex_count, may_cross).run();
}

}  // namespace cuesta
