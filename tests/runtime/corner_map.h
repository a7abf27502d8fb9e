#pragma once
/// I1 from its definition: each original corner walks up to its first active ancestor. Knows no lists of
/// changes.

#include <algorithm>
#include <array>
#include <vector>

#include "hierarchy/page.h"
#include "ooc/triangle_order.h"
#include "runtime/cut.h"

namespace cuesta::test {

using Slots = std::vector<std::array<std::uint32_t, 3>>;

/// Drawn triangles, lowest slot first, sorted.
inline Slots drawn_triangles(Cut& cut) {
  const DrawList list = cut.draw_list();
  Slots out;
  for (const Range& r : list.draws)
    for (std::uint32_t i = r.first; i < r.first + r.count; i += 3)
      out.push_back(smallest_first({list.indices[i], list.indices[i + 1], list.indices[i + 2]}));
  std::sort(out.begin(), out.end());
  return out;
}

/// What the substitutions that `cut` has applied make of the full surface. @pre all pages are resident, as
/// they were when `full` was taken.
inline Slots mapped_triangles(Cut& cut, const Slots& full) {
  std::vector<std::uint32_t> substitute(cut.draw_list().vertices.size());
  for (std::uint32_t v = 0; v < substitute.size(); ++v) substitute[v] = v;
  for (PageId id : cut.cache().resident_ids()) {
    const ResidentPage& page = *cut.cache().resident(id);
    for (const FanState& fan : page.fans())
      for (std::uint32_t i = 0; i < fan.applied; ++i) {
        const ChildState& c = page.children(fan)[i];
        substitute[c.from_slot] = c.to_slot;
      }
  }
  Slots out;
  for (auto t : full) {
    for (std::uint32_t& v : t)
      while (substitute[v] != v) v = substitute[v];
    if (t[0] != t[1] && t[1] != t[2] && t[0] != t[2]) out.push_back(smallest_first(t));
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace cuesta::test
