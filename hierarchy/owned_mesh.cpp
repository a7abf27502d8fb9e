#include "hierarchy/owned_mesh.h"

namespace cuesta {

OwnedMesh::OwnedMesh(const Page& page, const std::vector<Hint>& hints)
    : numbers_(page.vertex_count), guesses_(std::size_t{page.vertex_count} + 1) {
  const auto owned = owned_vertices(page);
  std::uint32_t next = 0;
  // Whether a vertex is owned cannot be predicted: all get a guess, and the next one may overwrite it.
  const auto before = [&](std::uint32_t local, std::uint32_t v) {
    return local < v ? numbers_[local] : nobody;
  };
  for (std::uint32_t v = 0; v < page.vertex_count; ++v) {
    const Hint& hint = hints[v];
    const std::uint32_t a = before(hint.a, v), b = before(hint.b, v), across = before(hint.across, v);
    Guess& g = guesses_[next];
    g.a = a != nobody ? a : std::min(b, next - 1);
    g.b = b != nobody ? b : g.a;
    g.across = a != nobody && b != nobody && across != nobody ? across : g.b;
    numbers_[v] = owned[v] ? next : nobody;
    next += owned[v];
  }
  guesses_.resize(next);
  // Wedges of one point lie where the one before does.
  for (std::uint32_t v : page.wedge_tails)
    if (numbers_[v] != nobody && numbers_[v - 1] != nobody)
      guesses_[numbers_[v]] = {numbers_[v - 1], numbers_[v - 1], numbers_[v - 1]};
}

}  // namespace cuesta
