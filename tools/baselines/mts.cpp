#include "tools/baselines/mts.h"

#include <algorithm>

#include "hierarchy/strip_reduction.h"
#include "hierarchy/stripify.h"
#include "ooc/check.h"

namespace cuesta::baselines {

/// Simplifies strips, each a list of nodes, and notes what becomes of each node.
class MtsBuilder {
 public:
  MtsBuilder(std::span<const Triangle> triangles, std::span<const std::uint32_t> substitute,
             std::uint32_t longest, Mts& mts)
      : substitute_(substitute), strips_of_(substitute.size()), mts_(mts) {
    std::vector<Triangle> proper(triangles.begin(), triangles.end());
    std::erase_if(proper, [](const Triangle& t) { return is_degenerate(t); });
    const auto n = static_cast<std::uint32_t>(substitute.size());
    const StripSet set = stripify(proper, n);
    for (std::uint32_t s = 0; s < set.strip_count(); ++s) {
      auto strip = set.strip(s);
      // The last two entries of a part are the first of the next.
      for (; strip.size() > longest; strip = strip.subspan(longest - 2)) add_strip(strip.first(longest), n);
      add_strip(strip, n);
    }
  }

  void substitute(std::uint32_t v) {
    const std::uint32_t target = substitute_[v];
    for (const std::uint32_t s : strips_of_[v]) {
      Path& path = paths_[s];
      std::replace(path.vertices.begin(), path.vertices.end(), v, target);
      reduce(path);
      note(s, v);
      auto& at_target = strips_of_[target];
      if (std::find(at_target.begin(), at_target.end(), s) == at_target.end()) at_target.push_back(s);
    }
    strips_of_[v] = {};
  }

  void finish() {
    mts_.first_version_.push_back(0);
    for (const auto& versions : versions_) {
      mts_.versions_.insert(mts_.versions_.end(), versions.begin(), versions.end());
      mts_.first_version_.push_back(static_cast<std::uint32_t>(mts_.versions_.size()));
    }
  }

 private:
  /// A strip now: its vertices, and the nodes that they are.
  struct Path {
    std::vector<std::uint32_t> vertices, nodes;

    void erase(std::size_t at, std::size_t count) {
      for (auto* list : {&vertices, &nodes}) {
        const auto first = list->begin() + static_cast<std::ptrdiff_t>(at);
        list->erase(first, first + static_cast<std::ptrdiff_t>(count));
      }
    }
  };

  void add_strip(std::span<const std::uint32_t> strip, std::uint32_t resolution) {
    const auto s = static_cast<std::uint32_t>(paths_.size()),
               head = static_cast<std::uint32_t>(versions_.size());
    Path path;
    for (const std::uint32_t v : strip) {
      path.vertices.push_back(v);
      path.nodes.push_back(head + static_cast<std::uint32_t>(path.vertices.size()));
      if (strips_of_[v].empty() || strips_of_[v].back() != s) strips_of_[v].push_back(s);
    }
    versions_.resize(versions_.size() + strip.size() + 1);
    const auto begin = static_cast<std::uint32_t>(mts_.indices_.size());
    mts_.strips_.push_back({head, begin, 0, 1, 0});
    mts_.indices_.resize(begin + strip.size());
    paths_.push_back(std::move(path));
    note(s, resolution);
  }

  static void reduce(Path& path) {
    path.erase(0, spare_head(path.vertices));
    if (path.vertices.empty()) return;
    if (const std::uint32_t spare = spare_tail(path.vertices))
      path.erase(path.vertices.size() - spare, spare);
    for (std::size_t i = 0; i + 4 <= path.vertices.size();)
      if (repeats(&path.vertices[i])) {
        path.erase(i + 2, 2);
        i -= std::min<std::size_t>(i, 2);
      } else {
        ++i;
      }
  }

  void note(std::uint32_t s, std::uint32_t resolution) {
    const Path& path = paths_[s];
    const auto next = [&](std::size_t i) { return i < path.nodes.size() ? path.nodes[i] : kNone; };
    note_node(mts_.strips_[s].head, {resolution, kNone, next(0)});
    for (std::size_t i = 0; i < path.nodes.size(); ++i)
      note_node(path.nodes[i], {resolution, path.vertices[i], next(i + 1)});
  }

  void note_node(std::uint32_t node, Mts::Version now) {
    auto& versions = versions_[node];
    if (versions.empty() || versions.back().vertex != now.vertex || versions.back().next != now.next)
      versions.push_back(now);
  }

  std::span<const std::uint32_t> substitute_;
  std::vector<Path> paths_;
  std::vector<std::vector<std::uint32_t>> strips_of_;
  std::vector<std::vector<Mts::Version>> versions_;  // of each node
  Mts& mts_;
};

Mts::Mts(std::span<const Triangle> triangles, std::span<const std::uint32_t> substitute,
         std::uint32_t base_resolution, std::uint32_t longest) {
  CUESTA_CHECK(longest >= 4 && longest % 2 == 0, longest);
  MtsBuilder builder(triangles, substitute, longest, *this);
  for (auto v = static_cast<std::uint32_t>(substitute.size()); v-- > base_resolution;) builder.substitute(v);
  builder.finish();
  indices_.resize(indices_.size() + copy_slack);
  set_resolution(static_cast<std::uint32_t>(substitute.size()));
}

std::uint64_t Mts::set_resolution(std::uint32_t resolution) {
  resolution_ = resolution;
  std::uint64_t walked = 0;
  for (Strip& strip : strips_)
    if (resolution <= strip.above || resolution > strip.upto) walked += walk(strip);
  return walked;
}

/// @return how many nodes the path has, its head included.
std::uint64_t Mts::walk(Strip& strip) {
  strip.above = 0;
  strip.upto = kNone;
  std::uint32_t* to = indices_.data() + strip.begin;
  std::uint64_t nodes = 0;
  for (std::uint32_t node = strip.head; node != kNone; ++nodes) {
    std::uint32_t i = first_version_[node];
    const std::uint32_t end = first_version_[node + 1];
    while (i + 1 < end && versions_[i + 1].from >= resolution_) ++i;
    strip.upto = std::min(strip.upto, versions_[i].from);
    if (i + 1 < end) strip.above = std::max(strip.above, versions_[i + 1].from);
    if (nodes > 0) *to++ = versions_[i].vertex;
    node = versions_[i].next;
  }
  strip.length = static_cast<std::uint32_t>(to - indices_.data()) - strip.begin;
  return nodes;
}

std::size_t Mts::write_indices(std::span<std::uint32_t> out) const {
  CUESTA_CHECK(out.size() >= index_bound(), out.size(), index_bound());
  std::uint32_t* to = out.data();
  for (const Strip& strip : strips_) {
    if (strip.length > 0) to += copy_strip(indices_.data() + strip.begin, strip.length, to);
  }
  return static_cast<std::size_t>(to - out.data());
}

std::uint64_t Mts::bytes() const {
  return strips_.size() * sizeof(Strip) + first_version_.size() * sizeof first_version_[0] +
         versions_.size() * sizeof(Version) + indices_.size() * sizeof indices_[0];
}

}  // namespace cuesta::baselines
