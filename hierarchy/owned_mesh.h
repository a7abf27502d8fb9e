#pragma once
/// What a page's triangles tell of its owned vertices, and so from what each one's position and attributes
/// can be guessed.
///
/// Survivors lie in coarser pages: their positions are known when a page is unpacked, their attributes are
/// not.

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "hierarchy/page.h"

namespace cuesta {

/// A value is guessed to be a + b - across: a parallelogram's fourth corner. What cannot be had is replaced:
/// across by b, so that a is left, and all three by the vertex before. All are known before the one that the
/// guess is for.
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
  /// From what an owned vertex's attributes are guessed: owned ones before it.
  /// @pre 0 < vertex < count(): there is nothing before the first.
  const Guess& guess(std::size_t vertex) const { return guesses_[vertex]; }
  /// From what its position is: local numbers of survivors, and of owned ones before it.
  /// @pre local(vertex) > 0
  const Guess& position_guess(std::size_t vertex) const { return position_guesses_[vertex]; }
  /// Number of a local vertex, or nobody.
  std::uint32_t number(std::uint32_t local) const { return numbers_[local]; }
  std::uint32_t local(std::size_t vertex) const { return locals_[vertex]; }
  std::size_t local_count() const { return numbers_.size(); }

 private:
  std::vector<std::uint32_t> numbers_, locals_;
  std::vector<Guess> guesses_, position_guesses_;
};

}  // namespace cuesta
