#pragma once
/// Any number of rasters as one field of postings: files on one lattice become a layer, layers of different
/// spacing or reference system are joined by seams of triangles.
///
/// The surface of a mosaic: every lattice cell of a layer with heights at its 4 postings gives the triangles
/// (c, r), (c, r+1), (c+1, r) and (c+1, r), (c, r+1), (c+1, r+1); one with 3 gives a triangle; others none.
/// The seams are the rest. No two triangles overlap, and every edge has at most two triangles, of opposite
/// directions; edges with one are at the outer rim and at voids. Counter-clockwise from above.
///
/// Layers of one reference system or several: a posting inside of a layer of more priority, or within about
/// 0.7 of its own spacing (cover_reach, mosaic_cover.h), is not used; gaps up to about 2 spacings are seams
/// (mosaic_seams.h), also where files only touch. Wider ones, and places where no layer has data, are voids
/// with a border.
///
/// Threads: const calls are concurrent. Memory: memory_bytes(); infos of all files (about 1 KiB each), a row
/// of heights at a pole, and of layers that meet others what lies along their common border: never a field.

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ooc/result.h"
#include "terrain/crs.h"
#include "terrain/geoid.h"
#include "terrain/height_raster.h"

namespace cuesta {

/// Which layer, and which file of a layer, is seen where several have a height.
enum class MosaicPriority : std::uint8_t {
  finest_first,  ///< the layer of the finest spacing; among equals, and in a layer, the file given first
  given_order,   ///< the layer whose first file was given first; in a layer, the file given first
};

struct MosaicOptions {
  RasterOptions raster = {};  ///< for every file
  MosaicPriority priority = MosaicPriority::finest_first;
  /// Datum that read() answers in. Unknown: that of the files, which then must agree. A file that does not
  /// name its datum is taken to be in this one.
  VerticalDatum heights = VerticalDatum::unknown;
  const Geoid* geoid = nullptr;  ///< needed where a file's datum is the other one; outlives the mosaic
  /// Surface of water, in metres: postings of a file without data become it, unless a file of a layer of less
  /// priority lies there, and heights below it are raised to it. A height above the geoid where `geoid` is
  /// given, else above the datum of read().
  std::optional<double> sea_level_m = {};
  /// A posting without data is interpolated if there is data within so many postings on both sides of it
  /// along its row or its column, also in gaps between files of a layer; at most most_fill_postings. Goes
  /// before water, and before layers of less priority.
  std::uint32_t fill_postings = 0;
  std::uint32_t most_open_files = 64;                   ///< at least 1
  std::uint64_t cache_bytes = std::uint64_t{64} << 20;  ///< blocks decoded of all open files together
};

inline constexpr std::uint32_t most_fill_postings = 4096;

/// Spacings of one lattice differ by less than this part of them,
inline constexpr double lattice_spacing_tolerance = 1e-6;
/// and postings of a file are so near to the lattice's, in spacings.
inline constexpr double lattice_phase_tolerance = 1e-3;

/// Rasters whose postings lie on one lattice: same reference system, spacing and phase.
struct MosaicLayer {
  Crs crs;
  /// Where the postings are. Rows run from the north; of a rotated lattice, columns run within 45° of x and
  /// rows to their right, as in an image with north up. Geographic: x of column 0 is in [-180, 180) of the
  /// system's own meridian, and grows beyond 180 where the layer crosses the antimeridian.
  PostingMap map = {};
  std::uint64_t width = 0, height = 0;  ///< bounding rectangle of its files, postings
  /// Of a geographic lattice: so many columns make 360°, and width ≤ columns_around; 0: it is no whole
  /// number. If width == columns_around the layer closes on itself.
  std::uint64_t columns_around = 0;
  /// The first, or last, row lies at the pole: all its postings are one place, and read() gives all of them
  /// one height, the mean of those with data.
  bool north_pole = false, south_pole = false;
  std::vector<std::uint32_t> files = {};  ///< indices into the files given, by falling priority

  bool closes() const { return columns_around != 0 && width == columns_around; }
};

struct PostingRef {
  std::uint32_t layer = 0;
  std::uint64_t column = 0, row = 0;  ///< column < width of the layer
  bool operator==(const PostingRef&) const = default;
};
using SeamTriangle = std::array<PostingRef, 3>;  ///< counter-clockwise from above

/// What became of postings that were read. Sums over windows that do not overlap are those of the mosaic.
struct MosaicCounts {
  std::uint64_t heights = 0;  ///< postings that have one
  std::uint64_t filled = 0;   ///< interpolated
  std::uint64_t flooded = 0;  ///< no data, now at sea level
  std::uint64_t raised = 0;   ///< below the sea level before
  std::uint64_t covered = 0;  ///< not used, as another layer covers the place
  MosaicCounts& operator+=(const MosaicCounts& other);
};

class Mosaic {
 public:
  /// Opens every file once to see what it is.
  /// @error of open_height_raster(); unsupported_version, invalid_input, not_found: a reference system that
  ///        is not known, by name and file; invalid_input: files of which only some say where they are,
  ///        heights above different datums without a geoid.
  /// @cost  what layers have near each other is read once, about 10 million postings a second.
  static Result<Mosaic> open(std::span<const std::filesystem::path> files, const MosaicOptions& options = {});

  Mosaic(Mosaic&&) noexcept;
  Mosaic& operator=(Mosaic&&) noexcept;
  ~Mosaic();

  /// By falling priority.
  const std::vector<MosaicLayer>& layers() const;
  /// Of all files, in the order given.
  const std::vector<RasterInfo>& infos() const;

  /// Heights in metres, NaN where there is none or another layer covers the place. The same for any order of
  /// calls and any windows.
  /// @param window   columns are taken modulo columns_around where that is not 0, and may run past the width;
  ///                 postings outside of all files are NaN. Rows, and other columns, lie in the layer.
  /// @param heights  window.width · window.height, row by row.
  /// @param counts   what was read is added to it, if given.
  /// @error of HeightRaster::read(); corrupt: a file has changed since open(). `heights` is then undefined.
  /// @cost  of the files' windows; with `fill_postings` F, those of a window larger by F on all sides; a
  ///        conversion between datums 0.2 to 0.8 µs a posting.
  Result<void> read(std::uint32_t layer, const Window& window, std::span<double> heights,
                    MosaicCounts* counts = nullptr) const;

  /// Whether read() may find heights in a window: false where no file lies in or near it, as between far
  /// files.
  /// @pre the window is one for read(). @cost O(files of the layer).
  bool has_files(std::uint32_t layer, const Window& window) const;

  /// Triangles that join layers of different lattices without cracks or overlaps.
  std::span<const SeamTriangle> seams() const;

  /// Datum of read(); unknown where no file names one and no option does.
  VerticalDatum heights() const;
  /// Smallest difference of heights that the files' integer samples can have, before any conversion between
  /// datums; 0 if some are floats.
  double vertical_quantum_m() const;
  /// Of all layers' bounding rectangles together: what a pass over everything reads.
  std::uint64_t postings() const;
  /// For the user, the files' own among them.
  const std::vector<std::string>& warnings() const;
  /// At most, for blocks of open files and what is kept of poles and seams; one window being read, by one
  /// thread, needs its own heights once more, and a file's.
  std::uint64_t memory_bytes() const;

 private:
  struct State;
  explicit Mosaic(std::unique_ptr<const State> state);
  std::unique_ptr<const State> state_;
};

}  // namespace cuesta
