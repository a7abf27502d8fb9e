#pragma once
/// What a thin client keeps: the triangles that it draws, changed by each message of the server. Also the
/// reference for clients in other languages.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "apps/serve/session_messages.h"
#include "runtime/draw_list.h"

namespace cuesta::serve {

inline constexpr std::uint32_t no_vertex = 0xFFFFFFFFu;

class SessionMesh {
 public:
  /// Vertices and triangles that are kept at most.
  static constexpr std::uint32_t most_slots = 1u << 24;

  /// Attributes that a file does not have are not sent: normals are "none" then, colours white.
  SessionMesh(bool has_normals, bool has_colours) : has_normals_(has_normals), has_colours_(has_colours) {}

  /// Applies a whole message.
  /// @error corrupt, also where a slot lies beyond those that are in use and new in this message, a triangle
  /// has a corner
  ///        that was never sent, or numbers are out of order. What was applied before the fault stays.
  Result<ChangeHead> apply(std::span<const std::byte> message);

  /// By slot. Vertices that no triangle uses may hold anything.
  std::span<const DrawVertex> vertices() const { return vertices_; }
  /// By slot; those that are not in use have three times no_vertex.
  std::span<const std::array<std::uint32_t, 3>> triangles() const { return triangles_; }
  std::uint32_t triangle_count() const { return used_; }

 private:
  Result<void> apply_body(std::span<const std::byte> body);

  bool has_normals_, has_colours_;
  std::vector<DrawVertex> vertices_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::uint32_t used_ = 0;
  std::uint32_t sequence_ = 0;
};

}  // namespace cuesta::serve
