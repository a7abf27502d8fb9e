#pragma once
/// An input of any size as it was read, on disk: the first stage of an out-of-core build. Vertices lie in
/// columns in input order; triangles lie with the block of vertices that they index.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "ooc/bucket_file.h"
#include "ooc/file_handle.h"
#include "ooc/mesh_reader.h"
#include "ooc/vertex_table.h"

namespace cuesta {

/// A triangle whose corners lie in one block, as numbers within it.
struct LocalTriangle {
  std::uint32_t ordinal_low, ordinal_high;  ///< place among all triangles of the input
  std::array<std::uint32_t, 3> corners;

  std::uint64_t ordinal() const { return std::uint64_t{ordinal_high} << 32 | ordinal_low; }
};
/// A corner of a triangle that reaches over several blocks.
struct LocalCorner {
  std::uint32_t slot_low, slot_high;  ///< slot = 4 · ordinal + corner
  std::uint32_t vertex;               ///< number within its block

  std::uint64_t slot() const { return std::uint64_t{slot_high} << 32 | slot_low; }
};

/// Vertices of one block in memory. Arrays are empty where no input has the attribute.
struct RawVertices {
  std::vector<Vec3d> positions;
  std::vector<OctNormal> normals;
  std::vector<Rgba8> colours;
  std::vector<FixedTexCoord> texcoords;
};

/// Vertices of inputs without an attribute that another input has. All zero for one input.
struct MissingAttributes {
  std::uint64_t normals = 0;    ///< got zero normals: ingest() can compute those
  std::uint64_t colours = 0;    ///< got opaque white
  std::uint64_t texcoords = 0;  ///< got (0, 0)
};

/// What is known after reading.
struct RawCounts {
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t nonfinite_faces = 0;  ///< left out already: of vertices that were known to be not finite
  AttributeSet attributes;
  bool has_missing_normals = false;  ///< some vertex has none, or a zero one
  MissingAttributes missing;
};

/// The sink that a build reads its inputs into. One thread.
class RawSurface final : public MeshSink {
 public:
  /// @param folder        where the files go
  /// @param block_vertices  largest block; what a join of triangles with vertices holds in memory at
  ///                        raw_vertex_bytes each. Decides speed, not the result.
  static Result<RawSurface> create(const std::filesystem::path& folder, std::uint64_t block_vertices);
  /// Opens what was complete when encode() was called.
  static Result<RawSurface> open(const std::filesystem::path& folder, std::span<const std::byte> state);
  std::vector<std::byte> encode() const;

  /// Call before the first block of each input.
  void begin_input();
  Result<void> vertices(const VertexBlock& block) override;
  Result<void> triangles(TriangleBlock block) override;
  /// Call after the last input: writes what is buffered.
  Result<void> finish();

  const RawCounts& counts() const { return counts_; }
  std::uint32_t block_count() const;
  Result<RawVertices> block(std::uint32_t b) const;
  /// Positions of vertices first … first + count - 1.
  Result<std::vector<Vec3d>> positions_run(std::uint64_t first, std::uint64_t count) const;
  /// LocalTriangle records by block.
  const BucketFile& local_triangles() const { return *triangles_; }
  /// LocalCorner records by block.
  const BucketFile& local_corners() const { return *corners_; }
  /// Positions of any vertices, in ascending order of number for speed.
  Result<std::vector<Vec3d>> positions_of(std::span<const std::uint64_t> vertices) const;
  /// Whether a triangle uses vertex v; of huge inputs, v or one near it.
  bool is_used(std::uint64_t v) const {
    return (used_[(v >> used_shift_) / 64] >> ((v >> used_shift_) % 64) & 1) != 0;
  }
  /// Up to edge_sample_triangles triangles spread over the input.
  const std::vector<std::array<std::uint64_t, 3>>& sample() const { return sample_; }
  std::uint64_t block_vertices() const { return block_vertices_; }
  /// Removes the files.
  static void remove(const std::filesystem::path& folder);

 private:
  enum Column : std::uint8_t { positions, normals, colours, texcoords, column_count };
  static constexpr std::array<std::uint32_t, column_count> element_bytes{24, 4, 4, 8};

  struct Input {
    std::uint64_t vertices = 0;
    AttributeSet attributes;
  };

  RawSurface() = default;
  Result<void> put(Column column, std::span<const std::byte> bytes);
  Result<void> flush(Column column);
  void note_used(std::uint64_t v);
  void note_nonfinite(std::span<const Vec3d> block);
  bool is_nonfinite(std::uint64_t v) const {
    return v / 64 < nonfinite_.size() && (nonfinite_[v / 64] >> (v % 64) & 1) != 0;
  }
  void note_sample(std::uint64_t ordinal, const std::array<std::uint64_t, 3>& t);

  RawCounts counts_;
  std::vector<Input> inputs_;
  std::uint64_t block_vertices_ = 0, first_of_input_ = 0;
  std::array<FileHandle, column_count> columns_;
  struct Pending {
    std::uint64_t first = 0;  ///< element number
    std::vector<std::byte> bytes;
  };
  std::array<Pending, column_count> pending_;
  std::unique_ptr<BucketFile> triangles_, corners_;
  std::unique_ptr<BucketFile::Writer> triangle_writer_, corner_writer_;
  std::vector<std::uint64_t> used_;
  std::vector<std::uint64_t> nonfinite_;  ///< a bit per vertex, empty as long as all are finite
  int used_shift_ = 0;
  std::vector<std::array<std::uint64_t, 3>> sample_;
  std::uint64_t sample_stride_ = 1;
};

/// Bytes of a vertex in a block in memory, with all attributes.
inline constexpr std::uint64_t raw_vertex_bytes = 40;

}  // namespace cuesta
