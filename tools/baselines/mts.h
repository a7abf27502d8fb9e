#pragma once
/// Multiresolution triangle strips (MTS): each strip is a graph whose paths are the strip at every
/// resolution; strips that a change of resolution touches are walked again, the others are drawn as they
/// were. Source: Belmonte, Remolar, Ribelles, Chover, Fernández, "Efficiently using connectivity information
/// between triangles in a mesh for real-time rendering", FGCS 20 (2004). Nodes are the entries of the strip
/// at full resolution, so a vertex that comes twice is two nodes; an arc tells its vertex and where the path
/// goes on, and from which resolution on it is valid. A path has no entry that can go without
/// (hierarchy/strip_reduction.h).

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/triangle_order.h"

namespace cuesta::baselines {

class Mts {
 public:
  /// A totally ordered mesh as build_strips() takes it; the strips are stripify()'s.
  /// @param longest  even, entries of a strip; longer ones are cut. Walks are of whole strips, so short
  /// strips are
  ///                 quicker to change and longer to draw.
  Mts(std::span<const Triangle> triangles, std::span<const std::uint32_t> substitute,
      std::uint32_t base_resolution, std::uint32_t longest);

  std::uint32_t resolution() const { return resolution_; }

  /// @return how many nodes were walked.   @cost O(strips + nodes of strips that change).
  std::uint64_t set_resolution(std::uint32_t resolution);
  /// As StripMesh's: strips with strip_restart behind each. @pre out has index_bound() elements.
  std::size_t write_indices(std::span<std::uint32_t> out) const;
  std::size_t index_bound() const { return indices_.size() + strips_.size(); }

  /// Of all arrays; positions not included.
  std::uint64_t bytes() const;

 private:
  friend class MtsBuilder;

  /// What a node was from resolution `from` down, until its next version.
  struct Version {
    std::uint32_t from, vertex, next;
  };
  struct Strip {
    std::uint32_t head;           // a node without vertex, which goes to the first
    std::uint32_t begin, length;  // in indices_, as it is now
    std::uint32_t above, upto;    // resolutions (above, upto] have this path
  };

  std::uint64_t walk(Strip& strip);

  std::vector<Strip> strips_;
  std::vector<std::uint32_t> first_version_;  // of each node, and the end of the last
  std::vector<Version> versions_;             // of a node: by falling resolution
  std::vector<std::uint32_t> indices_;
  std::uint32_t resolution_ = 0;
};

}  // namespace cuesta::baselines
