#pragma once
/// Heights of a terrain file at places, linear on the triangles of its original surface.
///
/// On the globe those triangles are chords: between postings at a distance d from each other the surface is
/// up to d² / 8R (R 6371 km) lower than heights interpolated along the ellipsoid: 0.2 mm at 100 m, 1.6 m at 9
/// km. At postings the height is the file's, but for Grid::snap_error().

#include <filesystem>
#include <memory>
#include <optional>

#include "apps/sample/finest_surface.h"
#include "terrain/terrain_metadata.h"

namespace cuesta::sample {

struct HeightSample {
  Vec3d position_m;  ///< in the file's frame
  Geodetic at;       ///< its h_m is the height, of the kind TerrainFacts::heights names
};

class HeightSampler {
 public:
  /// @error as CuestaFile::open; invalid_input: a file that is no terrain; corrupt: damaged facts.
  static Result<std::unique_ptr<HeightSampler>> open(const std::filesystem::path& path);

  const TerrainFacts& facts() const { return facts_; }

  /// Nothing where there is no data: a hole, outside of the terrain, or no such place.
  /// @error of reading a page.
  Result<std::optional<HeightSample>> at(LatLon place);
  /// The same at coordinates in the units of `crs`.
  Result<std::optional<HeightSample>> at(const Crs& crs, PlanePoint point);

 private:
  HeightSampler(CuestaFile file, TerrainFacts facts)
      : file_(std::move(file)), facts_(std::move(facts)), surface_(file_) {}
  Result<std::optional<HeightSample>> between(Vec3d low, Vec3d high);

  CuestaFile file_;
  TerrainFacts facts_;
  FinestSurface surface_;
};

}  // namespace cuesta::sample
