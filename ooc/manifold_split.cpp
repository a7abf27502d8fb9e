#include "ooc/manifold_split.h"

#include <algorithm>
#include <utility>

namespace cuesta {
namespace {

/// A vertex made for a second or later fan of its group.
struct Copy {
  std::uint32_t source;
  std::uint32_t fan;  ///< in the order of discovery
};

class FanSplitter {
 public:
  FanSplitter(std::vector<Triangle>& triangles, std::span<const std::uint32_t> group,
              std::span<const std::uint8_t> whole, std::span<const std::uint32_t> twins)
      : triangles_(triangles),
        group_(group),
        whole_(whole),
        twins_(twins),
        corner_done_(twins.size(), 0),
        vertex_flags_(group.size(), 0) {}

  SplitVertices run() {
    const auto corners = static_cast<std::uint32_t>(twins_.size());
    for (std::uint32_t c = 0; c < corners; ++c)
      if (!corner_done_[c]) visit_fan_of(c);
    return number();
  }

 private:
  enum Flag : std::uint8_t { kUsed = 1, kInFirstFan = 2, kGroupHasFan = 4 };

  void visit_fan_of(std::uint32_t corner) {
    const std::uint32_t group = group_[start_of(triangles_, corner)];
    std::uint8_t& flags = vertex_flags_[group];
    if ((flags & kGroupHasFan) && whole_[group]) return move_to_copies(corner);
    flags |= kGroupHasFan;
    for_each_corner(
        corner, [&](std::uint32_t& vertex, std::uint32_t) { vertex_flags_[vertex] |= kUsed | kInFirstFan; });
  }

  /// Calls f(vertex of the corner, corner) once for each corner of the fan: counter-clockwise from `first`
  /// until the fan closes or ends, then the other way.
  template <class F>
  void for_each_corner(std::uint32_t first, F f) {
    const auto visit = [&](std::uint32_t c) {
      corner_done_[c] = 1;
      f(triangles_[c / 3][c % 3], c);
    };
    std::uint32_t c = first;
    do {
      visit(c);
      c = twins_[prev_half_edge(c)];
    } while (c != kNone && c != first);
    if (c == first) return;
    for (c = twins_[first]; c != kNone; c = twins_[c]) visit(c = next_half_edge(c));
  }

  void move_to_copies(std::uint32_t corner) {
    wedges_.clear();
    for_each_corner(corner, [&](std::uint32_t& vertex, std::uint32_t) {
      vertex_flags_[vertex] |= kUsed;
      wedges_.push_back(vertex);
    });
    std::ranges::sort(wedges_);
    wedges_.erase(std::unique(wedges_.begin(), wedges_.end()), wedges_.end());
    const std::size_t base = group_.size() + copies_.size();
    for_each_corner(corner, [&](std::uint32_t& vertex, std::uint32_t) {
      const auto at = std::ranges::lower_bound(wedges_, vertex) - wedges_.begin();
      vertex = static_cast<std::uint32_t>(base + static_cast<std::size_t>(at));
    });
    for (const std::uint32_t w : wedges_) copies_.push_back({w, fans_});
    ++fans_;
  }

  /// Numbers of the copies, in the order in which they follow the vertices of their groups.
  std::vector<std::uint32_t> copy_order() const {
    std::vector<std::uint32_t> order(copies_.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return group_[copies_[i].source]; });
    return order;
  }

  SplitVertices number() {
    SplitVertices out;
    std::uint64_t whole = 0;
    std::vector<std::uint32_t> number_of(group_.size() + copies_.size(), kNone);
    const std::vector<std::uint32_t> order = copy_order();
    const auto add = [&](std::uint32_t vertex, std::uint32_t source, bool opens_group) {
      number_of[vertex] = static_cast<std::uint32_t>(out.source.size());
      out.group.push_back(opens_group ? number_of[vertex] : out.group.back());
      out.source.push_back(source);
      whole += whole_[source];
    };
    auto copy = order.begin();
    const auto vertices = static_cast<std::uint32_t>(group_.size());
    for (std::uint32_t begin = 0, end = 0; begin < vertices; begin = end) {
      bool opens = true;
      for (end = begin; end < vertices && group_[end] == begin; ++end) {
        out.used_before += vertex_flags_[end] & kUsed & whole_[end];
        if (vertex_flags_[end] & kInFirstFan) add(end, end, std::exchange(opens, false));
      }
      std::uint32_t fan = kNone;
      for (; copy != order.end() && copies_[*copy].source < end; ++copy) {
        const Copy& c = copies_[*copy];
        add(vertices + *copy, c.source, std::exchange(fan, c.fan) != c.fan);
      }
    }
    out.copies = whole - out.used_before;
    for (Triangle& t : triangles_) t = {number_of[t[0]], number_of[t[1]], number_of[t[2]]};
    return out;
  }

  std::vector<Triangle>& triangles_;
  std::span<const std::uint32_t> group_;
  std::span<const std::uint8_t> whole_;
  std::span<const std::uint32_t> twins_;
  std::vector<std::uint8_t> corner_done_;
  std::vector<std::uint8_t> vertex_flags_;
  std::vector<Copy> copies_;
  std::vector<std::uint32_t> wedges_;
  std::uint32_t fans_ = 0;
};

}  // namespace

SplitVertices split_fans(std::vector<Triangle>& triangles, std::span<const std::uint32_t> group,
                         std::span<const std::uint8_t> whole, std::span<const std::uint32_t> twins) {
  return FanSplitter(triangles, group, whole, twins).run();
}

}  // namespace cuesta
