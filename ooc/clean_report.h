#pragma once
/// What cleaning a surface dropped or changed, by cause.

#include <cstdint>

namespace cuesta {

struct CleanReport {
  std::uint64_t nonfinite_vertices = 0;  ///< NaN or infinite position; their faces are dropped
  std::uint64_t faces_nonfinite = 0;
  std::uint64_t vertices_welded = 0;    ///< same grid position and same attributes as another vertex
  std::uint64_t faces_degenerate = 0;   ///< two corners at one position after welding
  std::uint64_t faces_duplicate = 0;    ///< the same three positions as an earlier face, either way round
  std::uint64_t edges_nonmanifold = 0;  ///< cut: more than two faces, or two faces in the same direction
  std::uint64_t vertices_split = 0;     ///< copies made to separate sheets
  std::uint64_t vertices_unused = 0;
  std::uint64_t wedge_groups = 0;  ///< positions with more than one vertex: attribute seams

  std::uint64_t border_points = 0;         ///< on open borders; counted where borders are welded only
  std::uint64_t border_points_welded = 0;  ///< of these, moved to another within the tolerance

  void add(const CleanReport& other) {
    nonfinite_vertices += other.nonfinite_vertices;
    faces_nonfinite += other.faces_nonfinite;
    vertices_welded += other.vertices_welded;
    faces_degenerate += other.faces_degenerate;
    faces_duplicate += other.faces_duplicate;
    edges_nonmanifold += other.edges_nonmanifold;
    vertices_split += other.vertices_split;
    vertices_unused += other.vertices_unused;
    wedge_groups += other.wedge_groups;
    border_points += other.border_points;
    border_points_welded += other.border_points_welded;
  }
};

}  // namespace cuesta
