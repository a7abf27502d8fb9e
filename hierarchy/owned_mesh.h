#pragma once
/// What a page's triangles tell of its owned vertices, and so from what each one's attributes can be guessed.
///
/// Survivors lie in coarser pages and are not known when a page is unpacked: a guess uses owned vertices
/// only.

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "hierarchy/page.h"

namespace cuesta {

/// A value is guessed to be a + b - across: a parallelogram's fourth corner. What cannot be had is replaced:
/// across by b, so that a is left, and all three by the vertex before. All are before the one that the guess
/// is for.
struct Guess {
  std::uint32_t a = 0, b = 0, across = 0;

  bool is_parallelogram() const { return across != b; }
};

/// Local vertices that a vertex can be guessed from, or `nobody`.
struct Hint {
  static constexpr std::uint32_t nobody = ~std::uint32_t{0};
  std::uint32_t a = nobody, b = nobody, across = nobody;
};

/// Owned vertices are numbered from 0 in ascending local order.
class OwnedMesh {
 public:
  static constexpr std::uint32_t nobody = Hint::nobody;  ///< the number of a survivor

  /// @param page   vertex_count, base, wedge_tails, script and orphans are looked at.
  /// @param hints  per local vertex, local vertices to guess it from
  OwnedMesh(const Page& page, const std::vector<Hint>& hints);

  std::size_t count() const { return guesses_.size(); }
  /// @pre 0 < vertex < count(): there is nothing before the first.
  const Guess& guess(std::size_t vertex) const { return guesses_[vertex]; }
  /// Number of a local vertex, or nobody.
  std::uint32_t number(std::uint32_t local) const { return numbers_[local]; }

 private:
  std::vector<std::uint32_t> numbers_;
  std::vector<Guess> guesses_;
};

}  // namespace cuesta
