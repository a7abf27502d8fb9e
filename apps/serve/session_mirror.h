#pragma once
/// What a thin client has, kept on the server's side: compares it with what is drawn now, and says what
/// changed.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "apps/serve/session_mesh.h"
#include "runtime/draw_list.h"

namespace cuesta::serve {

/// Slots of vertices and triangles are the lowest that are free. A triangle that only moved within the pools
/// is not sent again, nor is a vertex that the client has.
/// @cost a step: O(blocks that are drawn + changes).   Memory: 28 bytes per vertex that was sent, 12 per
/// triangle, 4 per slot of the pools; up to twice as much, as arrays grow.
class SessionMirror {
 public:
  SessionMirror(bool has_normals, bool has_colours) : has_normals_(has_normals), has_colours_(has_colours) {}

  /// The message that takes the client from the list before to this one; nothing if it has it already.
  /// @param list      of the one cut that this mirrors, with all that changed since the last call. Not
  /// morphed.
  /// @param settled, achieved_px  are told.
  std::optional<std::string> change(const DrawList& list, bool settled, float achieved_px);

  std::uint32_t triangle_count() const { return used_triangles_; }
  /// What it takes, but for what a single step needs beyond it.
  std::uint64_t bytes() const;

 private:
  using Corners = std::array<std::uint32_t, 3>;
  struct CornersHash {
    std::size_t operator()(const Corners& c) const {
      return (c[0] * 0x9E3779B97F4A7C15ull ^ c[1]) * 0xC2B2AE3D27D4EB4Full ^ c[2] * 0x165667B19E3779F9ull;
    }
  };
  /// A vertex of the client.
  struct Sent {
    DrawVertex vertex;
    std::uint32_t pool_slot = 0;
    std::uint32_t uses = 0;
  };
  /// Lowest first; ones that were never used follow the last that was.
  class Slots {
   public:
    std::uint32_t take();
    void give(std::uint32_t slot);
    std::uint64_t bytes() const { return free_.capacity() * sizeof(std::uint32_t); }

   private:
    std::vector<std::uint32_t> free_;  // a heap, the lowest in front
    std::uint32_t end_ = 0;
  };

  void find_affected(const DrawList& list);
  void compare(const DrawList& list);
  bool is_same(const DrawList& list, const Corners& now, const Corners& before) const;
  void match_moved(const DrawList& list);
  void place_added(const DrawList& list);
  std::uint32_t use_vertex(const DrawList& list, std::uint32_t pool_slot);
  void release_vertices(const Corners& vertices);
  void forget_unused();
  std::string message(bool settled, float achieved_px);

  bool has_normals_, has_colours_;
  std::uint32_t sequence_ = 0, used_triangles_ = 0;
  std::vector<std::uint16_t> drawn_, drawn_before_;  // triangles at the front of each block of the pool
  std::vector<std::uint32_t> slot_of_place_;         // client's triangle at a place of the pool, + 1; 0: none
  std::vector<Corners> vertices_of_slot_;            // client's vertices of a client's triangle
  std::vector<std::uint32_t> sent_of_pool_;          // client's vertex of a slot of the pool, + 1; 0: none
  std::vector<Sent> sent_;
  Slots triangle_slots_, vertex_slots_;
  // Of one step.
  std::vector<std::uint32_t> affected_, added_, removed_, set_, new_vertices_, unused_;
  std::unordered_multimap<Corners, std::uint32_t, CornersHash> lost_;  // pool's corners → client's triangle
};

}  // namespace cuesta::serve
