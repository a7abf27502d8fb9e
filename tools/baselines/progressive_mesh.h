#pragma once
/// A progressive mesh (PM) with half-edge collapses: triangles in the order in which splits make them, so
/// that those of a resolution are a prefix, and splits of 8 bytes that find their place by walking around a
/// vertex. Source: Hoppe, "Progressive Meshes", SIGGRAPH 1996; layout: Hoppe, "Efficient Implementation of
/// Progressive Meshes", Computers & Graphics 22(1), 1998, §3: a split names the face flclw beside its new
/// left face, which corner of it is the vertex, and how many faces clockwise the right one is (vlr_rot).
/// Wedges, normals and materials are left out.

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/triangle_order.h"

namespace cuesta::baselines {

class ProgressiveMesh {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  /// A totally ordered mesh as build_strips() takes it.
  /// The coarsest resolution here is the lowest one above which all substitutions are collapses of an edge
  /// with one or two triangles, of a vertex whose triangles are a fan and with one left beside them.
  ProgressiveMesh(std::span<const Triangle> triangles, std::span<const std::uint32_t> substitute,
                  std::uint32_t base_resolution);

  std::uint32_t vertex_count() const { return base_resolution_ + static_cast<std::uint32_t>(splits_.size()); }
  std::uint32_t base_resolution() const { return base_resolution_; }
  std::uint32_t resolution() const { return resolution_; }

  /// Splits and collapses one by one.   @return how many.   @cost O(faces around the vertices).
  std::uint64_t set_resolution(std::uint32_t resolution);
  /// Copies the corners of the active triangles.   @pre out has 3 for each triangle of the full mesh.
  std::size_t write_indices(std::span<std::uint32_t> out) const;
  std::span<const Triangle> triangles() const { return std::span(corners_).first(triangle_count_); }

  /// Of all arrays; positions not included. 24 per triangle and 8 per split.
  std::uint64_t bytes() const;

 private:
  /// Of vertex u from v. Faces beside the new edge: left (v, u, l) and right (u, v, r); the fan that gets u
  /// for v lies clockwise from left to right.
  struct Split {
    std::uint32_t
        flclw;  // the fan's face beside the left one; without a fan, the face beside the only new face
    std::uint16_t vlr_rot;     // faces of the fan
    std::uint16_t corner : 2;  // of flclw that is v
    std::uint16_t has_left : 1;
    std::uint16_t has_right : 1;
    std::uint16_t right_first : 1;  // the right face has the lower number
  };
  static_assert(sizeof(Split) == 8);
  struct Place {
    std::uint32_t face, corner;
  };
  /// The new faces of a split, or kNone.
  struct Sides {
    std::uint32_t left, right;
  };
  using Stars = std::vector<std::vector<std::uint32_t>>;

  static Sides sides(const Split& split, std::uint32_t first);
  bool record(std::uint32_t u, std::uint32_t v, const Stars& stars);
  Place begin_of_fan(std::uint32_t u, Sides beside, std::uint32_t faces) const;
  bool is_fan(Place first, std::uint32_t u, std::uint32_t faces, Sides beside) const;
  void split();
  void collapse();
  Place clockwise(Place p, std::uint32_t around) const;

  std::vector<Triangle> corners_;
  std::vector<Triangle> neighbours_;  // across the edge from corner i to the next
  std::vector<Split> splits_;         // of vertex base_resolution_ + i
  std::uint32_t base_resolution_ = 0, resolution_ = 0, triangle_count_ = 0;
};

}  // namespace cuesta::baselines
