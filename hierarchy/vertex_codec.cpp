#include "hierarchy/vertex_codec.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <optional>

namespace cuesta {
namespace {

using Corners = std::array<std::uint32_t, 3>;

using TexcoordSteps = std::array<std::int32_t, 2>;

/// The guessed k-th component of an owned vertex's position; `places` are those of local vertices.
std::int64_t guessed_place(const OwnedMesh& mesh, std::span<const Vec3i> places, std::size_t vertex, int k) {
  if (mesh.local(vertex) == 0) return 0;
  const Guess& g = mesh.position_guess(vertex);
  return std::int64_t{places[g.a][k]} + places[g.b][k] - places[g.across][k];
}

std::int64_t guessed_texcoord(const OwnedMesh& mesh, const std::vector<TexcoordSteps>& values,
                              std::size_t vertex, std::size_t k) {
  if (vertex == 0) return 0;
  const Guess& g = mesh.guess(vertex);
  return std::int64_t{values[g.a][k]} + values[g.b][k] - values[g.across][k];
}

/// v as a T; false if it is none.
template <class T>
bool put_into(std::int64_t v, T& out) {
  out = static_cast<T>(v);
  return out == v;
}

/// Parallelograms are closer than the other guesses: their classes have planes of their own.
std::size_t first_position_plane(const OwnedMesh& mesh, std::size_t vertex) {
  return mesh.local(vertex) > 0 && mesh.position_guess(vertex).is_parallelogram() ? 0 : 3;
}

// ---- normals
// ------------------------------------------------------------------------------------------------

using Normal = std::array<std::int64_t, 3>;

/// A triangle's normal, as long as twice its area. It may wrap around where coordinates are nonsense; it does
/// so everywhere alike.
void add_normal(const Corners& t, std::span<const Vec3i> positions, std::vector<Normal>& sums) {
  const auto difference = [](std::int32_t a, std::int32_t b) {
    return static_cast<std::uint64_t>(std::int64_t{a} - b);
  };
  const Vec3i &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
  const std::uint64_t ux = difference(b.x, a.x), uy = difference(b.y, a.y), uz = difference(b.z, a.z);
  const std::uint64_t vx = difference(c.x, a.x), vy = difference(c.y, a.y), vz = difference(c.z, a.z);
  const std::array<std::uint64_t, 3> n{uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
  for (std::uint32_t v : t)
    for (std::size_t k = 0; k < 3; ++k)
      sums[v][k] = static_cast<std::int64_t>(static_cast<std::uint64_t>(sums[v][k]) + n[k]);
}

/// Per local vertex the sum of the normals of its triangles.
std::vector<Normal> page_normals(const Page& page, std::span<const Vec3i> places) {
  std::vector<Normal> sums(places.size(), Normal{});
  for (const Corners& t : page.triangles) add_normal(t, places, sums);
  return sums;
}

constexpr int one = (1 << (normal_bits - 1)) - 1;

std::uint64_t magnitude(std::int64_t v) {
  return v < 0 ? 0 - static_cast<std::uint64_t>(v) : static_cast<std::uint64_t>(v);
}

/// The octahedral code of a direction, as oct_normal.h has it but rounded in integers; nothing for (0, 0, 0).
std::optional<std::array<std::int64_t, 2>> oct_of(const Normal& n) {
  std::uint64_t x = magnitude(n[0]), y = magnitude(n[1]), z = magnitude(n[2]);
  const int length = static_cast<int>(std::bit_width(x | y | z));
  if (length > 20) {  // the quotients below are of 32 bits
    x >>= length - 20;
    y >>= length - 20;
    z >>= length - 20;
  }
  const auto sum = static_cast<std::uint32_t>(x + y + z);
  if (sum == 0) return std::nullopt;
  const auto share = [sum](std::uint64_t part) {
    return std::int64_t{(static_cast<std::uint32_t>(part) * (2u * one) + sum) / (2 * sum)};
  };
  std::int64_t u = share(x), v = share(y);
  if (n[2] < 0) {
    const std::int64_t folded = one - v;
    v = one - u;
    u = folded;
  }
  return std::array<std::int64_t, 2>{n[0] < 0 ? -u : u, n[1] < 0 ? -v : v};
}

/// The code of what is known of a vertex's normal from its triangles; else the code of the vertex before.
std::array<std::int64_t, 2> guessed_normal(const Normal& known, const VertexTable& owned,
                                           std::size_t vertex) {
  if (const auto code = oct_of(known)) return *code;
  if (vertex == 0) return {0, 0};
  return {owned.normals[vertex - 1][0], owned.normals[vertex - 1][1]};
}

/// A normal this near to its guess, in steps of the code, becomes the guess: 0.25° at most, as the code's own
/// rounding.
constexpr std::int64_t negligible_steps = 1;

bool near_enough(const OctNormal& normal, const std::array<std::int64_t, 2>& guess) {
  constexpr int no_normal = -one - 1;
  if (normal[0] == no_normal || normal[1] == no_normal) return false;
  return std::abs(normal[0] - guess[0]) <= negligible_steps &&
         std::abs(normal[1] - guess[1]) <= negligible_steps;
}

/// A colour's channels less what they are guessed from: green, and red and blue by how they differ from it.
using Channels = std::array<std::uint8_t, 4>;

Channels guessed_colour(const OwnedMesh& mesh, const std::vector<Rgba8>& colours, std::size_t vertex) {
  Channels mean{};
  if (vertex == 0) return mean;
  const Guess& g = mesh.guess(vertex);
  for (std::size_t k = 0; k < 4; ++k)
    mean[k] = static_cast<std::uint8_t>((colours[g.a][k] + colours[g.b][k]) / 2);
  return mean;
}

}  // namespace

// ---- there
// --------------------------------------------------------------------------------------------------

std::vector<Plane> pack_positions(const OwnedMesh& mesh, std::span<const Vec3i> places) {
  NumberWriter numbers(position_planes - 1);
  for (std::size_t v = 0; v < mesh.count(); ++v) {
    const std::size_t plane = first_position_plane(mesh, v);
    for (int k = 0; k < 3; ++k)
      numbers.put_signed(plane + static_cast<std::size_t>(k),
                         places[mesh.local(v)][k] - guessed_place(mesh, places, v, k));
  }
  return numbers.take();
}

std::vector<Plane> pack_normals(const OwnedMesh& mesh, std::span<const Vec3i> places, const Page& page) {
  NumberWriter numbers(normal_planes - 1);
  const VertexTable& owned = page.owned;
  const auto known = owned.normals.empty() ? std::vector<Normal>{} : page_normals(page, places);
  for (std::size_t v = 0; v < owned.normals.size(); ++v) {
    const auto guess = guessed_normal(known[mesh.local(v)], owned, v);
    const bool is_close = near_enough(owned.normals[v], guess);
    for (std::size_t k = 0; k < 2; ++k) numbers.put_signed(k, is_close ? 0 : owned.normals[v][k] - guess[k]);
  }
  return numbers.take();
}

std::vector<Plane> pack_colours(const OwnedMesh& mesh, const std::vector<Rgba8>& colours) {
  std::vector<Plane> planes(colour_planes);
  for (Plane& p : planes) p.reserve(colours.size());
  for (std::size_t v = 0; v < colours.size(); ++v) {
    const Channels guess = guessed_colour(mesh, colours, v);
    const int green = colours[v][1] - guess[1];
    const std::array<int, 4> difference{colours[v][0] - guess[0] - green, green,
                                        colours[v][2] - guess[2] - green, colours[v][3] - guess[3]};
    for (std::size_t k = 0; k < 4; ++k) planes[k].push_back(static_cast<std::byte>(difference[k]));
  }
  return planes;
}

std::vector<Plane> pack_texcoords(const OwnedMesh& mesh, const std::vector<TexcoordSteps>& texcoords) {
  NumberWriter numbers(texcoord_planes - 1);
  for (std::size_t v = 0; v < texcoords.size(); ++v)
    for (std::size_t k = 0; k < 2; ++k)
      numbers.put_signed(k, texcoords[v][k] - guessed_texcoord(mesh, texcoords, v, k));
  return numbers.take();
}

// ---- and back
// -----------------------------------------------------------------------------------------------

bool unpack_positions(std::span<const Plane> planes, const OwnedMesh& mesh, std::span<Vec3i> places) {
  NumberReader numbers(planes);
  for (std::size_t v = 0; v < mesh.count(); ++v) {
    const std::size_t plane = first_position_plane(mesh, v);
    for (int k = 0; k < 3; ++k)
      if (!put_into(
              guessed_place(mesh, places, v, k) + numbers.get_signed(plane + static_cast<std::size_t>(k)),
              places[mesh.local(v)][k]))
        return false;
  }
  return numbers.at_end();
}

bool unpack_normals(std::span<const Plane> planes, const OwnedMesh& mesh, std::span<const Vec3i> places,
                    Page& page) {
  NumberReader numbers(planes);
  VertexTable& owned = page.owned;
  const auto known = page_normals(page, places);
  owned.normals.resize(mesh.count());
  for (std::size_t v = 0; v < owned.normals.size(); ++v) {
    const auto guess = guessed_normal(known[mesh.local(v)], owned, v);
    for (std::size_t k = 0; k < 2; ++k)
      if (!put_into(guess[k] + numbers.get_signed(k), owned.normals[v][k])) return false;
  }
  return numbers.at_end();
}

bool unpack_colours(std::span<const Plane> planes, const OwnedMesh& mesh, std::vector<Rgba8>& colours) {
  for (const Plane& p : planes)
    if (p.size() != mesh.count()) return false;
  colours.resize(mesh.count());
  for (std::size_t v = 0; v < colours.size(); ++v) {
    const Channels guess = guessed_colour(mesh, colours, v);
    const auto difference = [&](std::size_t k) { return static_cast<int>(planes[k][v]); };
    const int green = difference(1);
    colours[v] = {static_cast<std::uint8_t>(guess[0] + difference(0) + green),
                  static_cast<std::uint8_t>(guess[1] + green),
                  static_cast<std::uint8_t>(guess[2] + difference(2) + green),
                  static_cast<std::uint8_t>(guess[3] + difference(3))};
  }
  return true;
}

bool unpack_texcoords(std::span<const Plane> planes, const OwnedMesh& mesh,
                      std::vector<TexcoordSteps>& texcoords) {
  NumberReader numbers(planes);
  texcoords.resize(mesh.count());
  for (std::size_t v = 0; v < texcoords.size(); ++v)
    for (std::size_t k = 0; k < 2; ++k)
      if (!put_into(guessed_texcoord(mesh, texcoords, v, k) + numbers.get_signed(k), texcoords[v][k]))
        return false;
  return numbers.at_end();
}

}  // namespace cuesta
