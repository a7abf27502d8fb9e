#pragma once
/// Mesh files in: PLY (ascii, both binary orders, tristrips), OBJ, STL (both), OFF, glTF/GLB (Draco and
/// meshopt too), bare Draco (.drc); each of them also inside gzip or Zstandard (scan.ply.gz, scan.obj.zst).
/// Volumes too: a surface of an OpenVDB grid, meshed block by block.
/// A reader streams blocks into a sink, so a file larger than memory can be read in one pass.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "ooc/result.h"
#include "ooc/surface_mesh.h"
#include "ooc/volume_options.h"

namespace cuesta {

/// A run of consecutive vertices in file order. Attribute spans are empty or as long as `positions`.
/// The same attributes are present in every block of a file.
struct VertexBlock {
  std::span<const Vec3d> positions;
  std::span<const Vec3f> normals;
  std::span<const Rgba8> colours;
  std::span<const TexCoord> texcoords;
};

/// Indices count the vertices of the whole file from 0, in the order in which the blocks gave them.
/// A sink may get triangles before the vertices they name; readers have checked indices against the file's
/// count.
using TriangleBlock = std::span<const std::array<std::uint64_t, 3>>;

/// Receives a file in blocks of at most 2^16 elements. An error returned by a sink ends the read with that
/// error.
class MeshSink {
 public:
  virtual ~MeshSink() = default;
  virtual Result<void> vertices(const VertexBlock& block) = 0;
  virtual Result<void> triangles(TriangleBlock block) = 0;
};

/// What a reader left out, by cause. Counted, reported once at the end, kept in the .cuesta file's metadata.
struct ReadReport {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t polygons_triangulated = 0;  ///< faces with more than three corners
  std::uint64_t faces_out_of_range = 0;     ///< dropped: an index beyond the vertices of the file
  std::uint64_t faces_too_small = 0;        ///< dropped: fewer than three corners
  std::uint64_t other_files = 0;            ///< read beside this one: buffers of a glTF document
};

/// Bytes read so far of the total, for a progress bar; returning false cancels the read.
using ReadProgress = std::function<bool(std::uint64_t bytes_done, std::uint64_t bytes_total)>;

/// Reads `path`, its format taken from the content (magic bytes), else from the extension; that of a
/// compressed file from the content inside, else from the extension before .gz or .zst.
/// @param memory_bytes  what the reader may hold. It needs none of it for STL and for PLY of binary rows; PLY
///        and OFF as text and OBJ keep what faces may name, 24 to 48 bytes per vertex, in it or, when a part
///        of it is full, in a temporary file. So they read files of any size with 1 MiB, the faster the more
///        they get. Only what cannot be read in parts needs more: one Draco mesh (120 bytes per face and 80
///        per vertex), one meshopt-compressed or sparse glTF primitive, a document's JSON, a window of zstd.
/// @param temp  folder for what does not fit and for what a compressed file unpacks to, files without a name.
///        Empty: TMPDIR, or else /tmp.
///        Unpacking is the first half of the progress; the place of an error behind it ends in "unpacked".
/// STL gives three vertices per facet and no normals; OBJ a vertex per distinct v/vt/vn, several with the
/// same values where the triples do not fit the memory (or are numbered from 2^32 on); glTF one copy of a
/// mesh per node that shows it, in world coordinates, colours as sRGB and texture coordinates with v up.
/// OpenVDB gives the vertices on the border of blocks again in each block, bit by bit the same: welding them
/// closes the surface. Its memory is the tree of the grid without values, and one block.
/// @error not_found, io; corrupt or unsupported_version with line or byte; out_of_budget before a count in
/// the
///        file makes it allocate more; cancelled; io if a file changes, or becomes shorter, while it is read.
///        Also of unpack_file() and TempFile. Never more memory than `memory_bytes` + 16 MiB, resident pages
///        of mapped files included, for any size of the input (for hostile Draco data see draco_mesh.h; a
///        single line, or a gap between two numbers, is resident as a whole).
Result<ReadReport> read_mesh(const std::filesystem::path& path, MeshSink& sink, std::uint64_t memory_bytes,
                             const ReadProgress& progress = {}, const std::filesystem::path& temp = {},
                             const VolumeOptions& volume = {});

/// Reads a whole file into memory. @error as read_mesh; out_of_budget above 2^32 - 2 vertices or
/// `memory_bytes`.
Result<SurfaceMesh> load_mesh(const std::filesystem::path& path, std::uint64_t memory_bytes,
                              ReadReport* report = nullptr, const ReadProgress& progress = {},
                              const std::filesystem::path& temp = {}, const VolumeOptions& volume = {});

}  // namespace cuesta
