#include "tests/hierarchy/seam_groups.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace cuesta {
namespace {

/// A triangle's side, from one place to another; places are numbers of positions.
struct Side {
  std::uint32_t low, high;        // places
  std::uint32_t at_low, at_high;  // vertices
  bool forward;                   // runs from low to high
};

std::vector<std::uint32_t> place_numbers(std::span<const Vec3i> positions) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return positions[a] != positions[b] ? positions[a] < positions[b] : a < b;
  });
  std::vector<std::uint32_t> place(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    place[order[i]] =
        i > 0 && positions[order[i]] == positions[order[i - 1]] ? place[order[i - 1]] : order[i];
  return place;
}

std::vector<Side> sides_between_wedges(std::span<const std::uint32_t> place,
                                       std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::vector<std::uint8_t> shared(place.size(), 0);
  for (std::size_t v = 0; v < place.size(); ++v)
    if (place[v] != v) shared[v] = shared[place[v]] = 1;
  std::vector<Side> sides;
  for (const auto& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      if (!shared[a] && !shared[b]) continue;
      if (place[a] < place[b])
        sides.push_back({place[a], place[b], a, b, true});
      else
        sides.push_back({place[b], place[a], b, a, false});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.at_low, a.at_high) < std::tie(b.low, b.high, b.at_low, b.at_high);
  });
  return sides;
}

std::uint32_t find(std::vector<std::uint32_t>& group, std::uint32_t v) {
  while (group[v] != v) v = group[v] = group[group[v]];
  return v;
}

void join(std::vector<std::uint32_t>& group, std::uint32_t a, std::uint32_t b) {
  a = find(group, a);
  b = find(group, b);
  group[std::max(a, b)] = std::min(a, b);
}

}  // namespace

std::vector<std::uint32_t> seam_groups(std::span<const Vec3i> positions,
                                       std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::vector<std::uint32_t> group(positions.size());
  std::iota(group.begin(), group.end(), 0u);
  const auto sides = sides_between_wedges(place_numbers(positions), triangles);
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    for (end = i; end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high;)
      ++end;
    if (end - i != 2 || sides[i].forward == sides[i + 1].forward) continue;
    join(group, sides[i].at_low, sides[i + 1].at_low);
    join(group, sides[i].at_high, sides[i + 1].at_high);
  }
  for (std::uint32_t v = 0; v < group.size(); ++v) group[v] = find(group, v);
  return group;
}

}  // namespace cuesta
