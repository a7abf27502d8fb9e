#pragma once
/// Topology of the full surface, and whether a cut of it is as whole as it is.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cuesta::verify {

using Triangle = std::array<std::uint32_t, 3>;

/// What edges say about one component. V - E + F is the Euler characteristic.
struct ComponentShape {
  std::int64_t euler = 0;
  std::uint64_t triangles = 0;
  std::uint64_t border_edges = 0;     ///< with one triangle
  std::uint64_t irregular_edges = 0;  ///< with more than two triangles, or two in one direction
};

/// The full surface, its wedges taken together as points.
class SurfaceShape {
 public:
  /// @param point  per vertex slot: the slot that names its point (slot_points.h)
  /// @cost O(n log n), 60 bytes per triangle for a while.
  SurfaceShape(std::vector<std::uint32_t> point, std::span<const Triangle> full);

  std::span<const ComponentShape> components() const { return full_; }
  /// @param ancestor  per point (by its naming slot): the point that stands for it in the cut, itself if
  /// active Sentences for what a cut has that the full surface has not: cracks; and where topology is kept,
  /// irregular edges and another Euler characteristic of a closed component. Components may be absent, and
  /// border loops may close.
  std::vector<std::string> complaints(std::span<const Triangle> cut, std::span<const std::uint32_t> ancestor,
                                      bool topology_kept) const;

 private:
  struct Edge;
  std::vector<Edge> sorted_edges(std::span<const Triangle> triangles) const;
  std::vector<ComponentShape> shapes_of(std::span<const Triangle> triangles,
                                        std::span<const Edge> edges) const;
  std::uint64_t torn_edges(std::span<const Edge> edges, std::span<const std::uint32_t> ancestor) const;
  void find_components(std::span<const Triangle> full);

  std::vector<std::uint32_t> point_;                  // per slot
  std::vector<std::uint32_t> component_;              // per point, dense
  std::vector<std::array<std::uint32_t, 2>> border_;  // slots at the ends of edges with one triangle
  std::vector<ComponentShape> full_;
};

}  // namespace cuesta::verify
