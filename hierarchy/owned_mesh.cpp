#include "hierarchy/owned_mesh.h"

namespace cuesta {
namespace {

/// What is left of a hint; `before` stands for what is missing.
Guess guess_from(const Hint& known, std::uint32_t before) {
  constexpr std::uint32_t nobody = Hint::nobody;
  Guess g;
  g.a = known.a != nobody ? known.a : std::min(known.b, before);
  g.b = known.b != nobody ? known.b : g.a;
  g.across = known.a != nobody && known.b != nobody && known.across != nobody ? known.across : g.b;
  return g;
}

}  // namespace

OwnedMesh::OwnedMesh(const Page& page, const std::vector<Hint>& hints)
    : numbers_(page.vertex_count),
      locals_(std::size_t{page.vertex_count} + 1),
      guesses_(std::size_t{page.vertex_count} + 1),
      position_guesses_(std::size_t{page.vertex_count} + 1) {
  const auto owned = owned_vertices(page);
  std::uint32_t next = 0;
  // Whether a vertex is owned cannot be predicted: all get guesses, and the next one may overwrite them.
  for (std::uint32_t v = 0; v < page.vertex_count; ++v) {
    const Hint& hint = hints[v];
    const auto number_before = [&](std::uint32_t h) { return h < v ? numbers_[h] : nobody; };
    const auto placed_before = [&](std::uint32_t h) {
      return h < v || (h != nobody && !owned[h]) ? h : nobody;
    };
    guesses_[next] =
        guess_from({number_before(hint.a), number_before(hint.b), number_before(hint.across)}, next - 1);
    position_guesses_[next] =
        guess_from({placed_before(hint.a), placed_before(hint.b), placed_before(hint.across)}, v - 1);
    locals_[next] = v;
    numbers_[v] = owned[v] ? next : nobody;
    next += owned[v];
  }
  for (auto* guesses : {&guesses_, &position_guesses_}) guesses->resize(next);
  locals_.resize(next);
  // Wedges of one point lie where the one before does.
  for (std::uint32_t v : page.wedge_tails) {
    if (numbers_[v] == nobody) continue;
    position_guesses_[numbers_[v]] = {v - 1, v - 1, v - 1};
    if (const std::uint32_t before = numbers_[v - 1]; before != nobody)
      guesses_[numbers_[v]] = {before, before, before};
  }
}

}  // namespace cuesta
