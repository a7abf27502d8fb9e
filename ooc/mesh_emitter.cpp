#include "ooc/mesh_emitter.h"

#include <algorithm>

namespace cuesta {

/// Blocks start small, so that a small file costs little, and grow by four up to block_elements.
constexpr std::size_t first_block = 1024;

MeshEmitter::MeshEmitter(const ReadJob& job, AttributeSet attributes)
    : job_(job), attributes_(attributes), triangles_(first_block) {
  resize_vertices(first_block);
}

void MeshEmitter::resize_vertices(std::size_t elements) {
  positions_.resize(elements);
  if (attributes_.normals) normals_.resize(elements);
  if (attributes_.colours) colours_.resize(elements);
  if (attributes_.texcoords) texcoords_.resize(elements);
}

Result<void> MeshEmitter::full_vertices() {
  if (vertices_held_ == block_elements) return flush_vertices();
  resize_vertices(4 * vertices_held_);
  return {};
}

Result<void> MeshEmitter::full_triangles() {
  if (triangles_held_ == block_elements) return flush_triangles();
  triangles_.resize(4 * triangles_held_);
  return {};
}

MeshEmitter::Columns MeshEmitter::columns(std::size_t wanted) {
  const std::size_t first = vertices_held_;
  return {std::min(wanted, positions_.size() - first), positions_.data() + first,
          attributes_.normals ? normals_.data() + first : nullptr,
          attributes_.colours ? colours_.data() + first : nullptr,
          attributes_.texcoords ? texcoords_.data() + first : nullptr};
}

Result<void> MeshEmitter::face(std::span<const std::uint64_t> corners) {
  if (corners.size() < 3) {
    ++report_.faces_too_small;
    return {};
  }
  if (corners.size() == 3) return triangle(corners[0], corners[1], corners[2]);
  for (const std::uint64_t corner : corners) {
    if (corner >= vertex_count_) {
      ++report_.faces_out_of_range;
      return {};
    }
  }
  ++report_.polygons_triangulated;
  corner_positions_.clear();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto position = position_of_(k, corners[k]);
    if (!position) return fail(position.error());
    corner_positions_.push_back(*position);
  }
  for (const auto& t : triangulator_.triangulate(corner_positions_)) {
    CUESTA_TRY(push({corners[t[0]], corners[t[1]], corners[t[2]]}));
  }
  return {};
}

Result<void> MeshEmitter::charge_corners(std::uint64_t count) {
  constexpr std::uint64_t most = std::uint64_t{1} << 24;
  // The caller's lists (up to 32 bytes a corner, doubling as they grow), positions, and the triangulator's
  // ring, reflex list, triangles.
  constexpr std::uint64_t bytes = 3 * 32 + sizeof(Vec3d) + PolygonTriangulator::bytes_per_corner;
  if (count > most) {
    return job_.corrupt_at(byte_, "a face with " + std::to_string(count) + " corners; at most 2^24 are read");
  }
  CUESTA_TRY(job_.budget.charge(count - corners_charged_, bytes, "corners of a polygon"));
  corners_charged_ = count;
  corner_positions_.reserve(count);
  return {};
}

Result<void> MeshEmitter::flush_vertices() {
  const std::size_t n = vertices_held_;
  vertices_held_ = 0;
  if (n == 0) return {};
  VertexBlock block{
      .positions = std::span(positions_).first(n), .normals = {}, .colours = {}, .texcoords = {}};
  if (attributes_.normals) block.normals = std::span(normals_).first(n);
  if (attributes_.colours) block.colours = std::span(colours_).first(n);
  if (attributes_.texcoords) block.texcoords = std::span(texcoords_).first(n);
  CUESTA_TRY(job_.sink.vertices(block));
  return job_.report_progress(byte_);
}

Result<void> MeshEmitter::flush_triangles() {
  const std::size_t n = triangles_held_;
  triangles_held_ = 0;
  if (n == 0) return {};
  CUESTA_TRY(job_.sink.triangles(std::span(triangles_).first(n)));
  return job_.report_progress(byte_);
}

Result<ReadReport> MeshEmitter::finish() {
  CUESTA_TRY(flush_vertices());
  CUESTA_TRY(flush_triangles());
  CUESTA_TRY(job_.report_progress(job_.bytes.size()));
  return report_;
}

}  // namespace cuesta
