#pragma once
/// The geoid: its undulation N above the WGS 84 ellipsoid, so that ellipsoidal height h = orthometric height
/// H + N. Data sets in GeographicLib's format (16-bit .pgm over the whole Earth); interpolation by
/// GeographicLib::Geoid, cubic on 12 postings of the grid.
///
/// Accuracy: that of the data set. Interpolation and rounding add at most max_error_m() where the file states
/// it; GeographicLib's documentation gives 0.17 m (rms 6 mm) for egm96-15, 3 mm for egm96-5.
/// tools/geoid_from_gtx makes egm96-15.pgm of the grid in Debian's package proj-data.
///
/// Memory: `memory_bytes` at most for the grid, plus 64 KiB. A data set that fits is read once; then calls
/// are concurrent. One that does not fit is read posting by posting from the file, or from an area read with
/// read_area(); then calls from several threads are safe but take turns: use undulations_m() for rows.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ooc/result.h"
#include "terrain/crs_definition.h"

namespace cuesta {

struct GeoidOptions {
  std::size_t memory_bytes = std::size_t(32) << 20;  ///< egm96-15: 2 MiB, egm96-5: 18 MiB, egm2008-1: 450 MiB
  /// Where data sets are looked for by name. Empty: GEOGRAPHICLIB_GEOID_PATH, GEOGRAPHICLIB_DATA/geoids, and
  /// the folders /usr/share and /usr/local/share/GeographicLib/geoids.
  std::vector<std::filesystem::path> folders;
};

class Geoid {
 public:
  /// @param name  "egm96", "egm84" or "egm2008": the finest of that model that is installed; a data set's
  /// full
  ///              name ("egm96-5"); or a file, told by a '/' or by ".pgm" at its end.
  /// @error not_found: where was looked, and how to get it; corrupt: GeographicLib's reason; invalid_input: a
  /// name
  ///        that is none of these.
  static Result<Geoid> open(const std::string& name, const GeoidOptions& options = {});

  Geoid(Geoid&&) noexcept;
  Geoid& operator=(Geoid&&) noexcept;
  ~Geoid();

  /// N in metres. NaN where the position is NaN or beyond a pole, or where the file can no longer be read.
  /// @cost 0.16 µs in memory; from the file about 7 µs, and 0.07 µs within the same cell of the grid.
  double undulation_m(LatLon at) const;

  /// The same for many positions. @pre the spans are equally long.
  void undulations_m(std::span<const LatLon> at, std::span<double> out_m) const;

  /// h = H + N, in metres.
  double ellipsoidal_m(LatLon at, double orthometric_m) const { return orthometric_m + undulation_m(at); }
  /// H = h − N, in metres.
  double orthometric_m(Geodetic at) const { return at.h_m - undulation_m(at.lat_lon()); }

  /// Reads the part of a large data set that a terrain needs. Degrees; east of west, also across the
  /// antimeridian. Does nothing where all is in memory. Not concurrent with other calls.
  /// @error out_of_budget: the area needs more than memory_bytes; io.
  Result<void> read_area(double south_deg, double west_deg, double north_deg, double east_deg);

  bool in_memory() const;           ///< all of it: calls are concurrent and read no file
  const std::string& name() const;  ///< "egm96-15"
  std::string description()
      const;  ///< "geoid egm96-15 (WGS84 EGM96, 15-minute grid), /usr/share/…/egm96-15.pgm"
  double max_error_m() const;  ///< of interpolation and rounding, as the file states it; NaN if it does not

 private:
  struct Data;
  explicit Geoid(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

}  // namespace cuesta
