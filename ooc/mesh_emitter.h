#pragma once
/// Gathers single vertices and faces into the sink's blocks, checks indices, triangulates and counts.

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "ooc/polygon.h"
#include "ooc/read_job.h"

namespace cuesta {

struct Vertex {
  Vec3d position;
  Vec3f normal;
  Rgba8 colour{255, 255, 255, 255};
  TexCoord texcoord{};
};

/// Nearest byte of a value in 0…255, clamped; not-a-number is 0.
inline std::uint8_t colour_byte(double value) {
  return !(value > 0) ? 0 : value >= 255 ? 255 : static_cast<std::uint8_t>(value + 0.5);
}

/// At most 2^16 vertices and 2^16 triangles are held: 4.7 MB with all attributes, not charged to the budget.
class MeshEmitter {
 public:
  static constexpr std::size_t block_elements = std::size_t{1} << 16;
  /// Position of the corner-th corner of the face, which is `vertex`; asked for every corner of a polygon
  /// with more than three, whose vertices have been checked.
  using PositionOf = std::function<Result<Vec3d>(std::size_t corner, std::uint64_t vertex)>;

  MeshEmitter(const ReadJob& job, AttributeSet attributes);

  /// Faces with an index of `count` or more are dropped and counted.
  void set_vertex_count(std::uint64_t count) { vertex_count_ = count; }
  void set_positions(PositionOf position_of) { position_of_ = std::move(position_of); }
  /// How far in the file the reader is, for the progress callback of the next block.
  void at_byte(std::uint64_t byte) { byte_ = byte; }

  Result<void> vertex(const Vertex& v) {
    const std::size_t i = vertices_held_;
    positions_[i] = v.position;
    if (attributes_.normals) normals_[i] = v.normal;
    if (attributes_.colours) colours_[i] = v.colour;
    if (attributes_.texcoords) texcoords_[i] = v.texcoord;
    return commit_vertices(1);
  }

  /// Room for vertices to be written in place, at least one and at most `wanted`; then commit_vertices().
  /// Columns of absent attributes are null.
  struct Columns {
    std::size_t count;
    Vec3d* positions;
    Vec3f* normals;
    Rgba8* colours;
    TexCoord* texcoords;
  };
  Columns columns(std::size_t wanted);
  Result<void> commit_vertices(std::size_t count) {
    vertices_held_ += count;
    report_.vertices += count;
    return vertices_held_ == positions_.size() ? full_vertices() : Result<void>{};
  }

  Result<void> triangle(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    if (a >= vertex_count_ || b >= vertex_count_ || c >= vertex_count_) {
      ++report_.faces_out_of_range;
      return {};
    }
    return push({a, b, c});
  }
  /// Call before gathering the corners of a face: charges the memory that large polygons need.
  /// @error corrupt above 2^24 corners, which no real face has; out_of_budget.
  Result<void> expect_corners(std::uint64_t count) {
    return count <= corners_charged_ ? Result<void>{} : charge_corners(count);
  }
  /// A face with any number of corners, in order, after expect_corners() of as many.
  Result<void> face(std::span<const std::uint64_t> corners);

  /// Sends the vertices held so far: readers that have all vertices before the first face call it in between.
  Result<void> flush_vertices();
  Result<ReadReport> finish();

 private:
  Result<void> push(std::array<std::uint64_t, 3> t) {
    triangles_[triangles_held_++] = t;
    ++report_.triangles;
    return triangles_held_ == triangles_.size() ? full_triangles() : Result<void>{};
  }
  Result<void> charge_corners(std::uint64_t count);
  Result<void> full_vertices();
  Result<void> full_triangles();
  void resize_vertices(std::size_t elements);
  Result<void> flush_triangles();

  const ReadJob& job_;
  AttributeSet attributes_;
  std::uint64_t vertex_count_ = 0;
  PositionOf position_of_;
  std::uint64_t byte_ = 0;
  ReadReport report_;
  std::size_t vertices_held_ = 0;
  std::size_t triangles_held_ = 0;
  std::vector<Vec3d> positions_;
  std::vector<Vec3f> normals_;
  std::vector<Rgba8> colours_;
  std::vector<TexCoord> texcoords_;
  std::vector<std::array<std::uint64_t, 3>> triangles_;
  PolygonTriangulator triangulator_;
  std::vector<Vec3d> corner_positions_;
  std::uint64_t corners_charged_ = 4096;
};

}  // namespace cuesta
