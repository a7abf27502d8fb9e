#pragma once
/// The active ancestors of a TOM's vertices at one resolution, as a table.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "ooc/triangle_order.h"

namespace cuesta {

/// Looks up the active ancestors of vertices. @pre they are below the table's end
struct AncestorLookup {
  std::uint32_t last_active;
  const std::uint32_t* down;  ///< per vertex from last_active on: how far down its ancestor is

  /// Without a branch: those that are active share entry 0, which is 0.
  std::uint32_t operator()(std::uint32_t v) const { return v - down[std::max(v, last_active) - last_active]; }
  Triangle operator()(const Triangle& t) const { return {(*this)(t[0]), (*this)(t[1]), (*this)(t[2])}; }
};

/// Only vertices that have gone have an entry, so the table of resolutions that differ little is small.
class TomAncestors {
 public:
  /// For resolution n and vertices below `end`.
  /// @pre 1 ≤ n ≤ end ≤ substitute.size(), n not below the base vertices
  void fill(std::span<const std::uint32_t> substitute, std::uint32_t n, std::uint32_t end);

  AncestorLookup lookup() const { return {last_active_, down_.data()}; }

  /// @param to  as many elements as `from`; may be the same
  void look_up(std::span<const Triangle> from, Triangle* to) const;

 private:
  std::uint32_t last_active_ = 0;
  std::vector<std::uint32_t> down_{0};
};

}  // namespace cuesta
