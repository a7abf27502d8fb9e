#pragma once
/// Substitutions along the sides of strips only.
/// Source: Ramos, Chover, Belmonte, Rebollo, WSCG 2004, §3.2.1: "each vertex can only be collapsed with its
/// neighbours on the external edge". Then a strip stays a strip: each of its triangles shares an edge with
/// the next, and what is degenerate between two of them is at most one window, where it turns.

#include <cstdint>
#include <span>
#include <unordered_set>

#include "hierarchy/stripify.h"

namespace cuesta {

/// Which edges of the mesh, as it is simplified, strips go on across. About 32 bytes per triangle.
class StripSides {
 public:
  explicit StripSides(const StripSet& strips);

  /// Whether the edge between u and v is at the side, or the end, of strips.
  bool allows(std::uint32_t u, std::uint32_t v) const { return !crossed_.contains(key(u, v)); }

  /// To be told of u → v.   @param around  u's neighbours before, v among them
  /// @param shared  those of them that were v's neighbours, too: their edges to u and v become one, which a
  /// strip goes
  ///                on across only if it did across both.
  void applied(std::uint32_t u, std::uint32_t v, std::span<const std::uint32_t> around,
               std::span<const std::uint32_t> shared);

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a;
  }

  std::unordered_set<std::uint64_t> crossed_;
};

}  // namespace cuesta
