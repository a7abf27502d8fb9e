#pragma once
/// A coordinate reference system: coordinates of rasters to latitude and longitude, and back.
///
/// Made from an EPSG code, from GeoTIFF's GeoKeys, or from a plain struct. The formulas are GeographicLib's
/// (Karney, "Transverse Mercator with an accuracy of a few nanometers", J. Geodesy 2011; Snyder, "Map
/// Projections: A Working Manual", 1987, for the conics), Web Mercator is EPSG guidance note 7-2, §3.2.1.2.
///
/// Axis order: x east, y north, always, as rasters store it. EPSG lists latitude first for EPSG:4326 and
/// others, and northing first for EPSG:32661: that order is not used.
///
/// Datums: latitudes and longitudes are taken as WGS 84. That is right for WGS 84, and right within about 1 m
/// for realisations of ITRS frozen to a plate (ETRS89, SIRGAS 2000, CGCS2000, ...), 2 m for NAD83, GDA94 and
/// NZGD2000, 6 m for JGD2000; description() says which. Older datums (NAD27, OSGB36, ED50, ...) are 50 to 500
/// m away. They are refused, since this module has no shifts of datum.
///
/// Accuracy: forward after inverse gives the coordinates back within 1e-9 relative or 1e-6 m, whichever is
/// larger; inverse after forward gives the place back within 1e-3 m, but Albers within 1 degree of a pole 0.2
/// m, since equal-area coordinates there hardly change with latitude. Threads: const calls are concurrent.
/// Memory: about 0.5 KiB; copies share it.

#include <memory>
#include <string>
#include <string_view>

#include "ooc/result.h"
#include "terrain/crs_definition.h"

namespace cuesta {

class Projection;

/// How far from its central meridian a transverse Mercator projection is used, in degrees of arc: within it
/// the series is good to 5 nm; a UTM zone needs 3.5 degrees (norm) to 9 (extended use).
inline constexpr double transverse_mercator_reach_deg = 33;

class Crs {
 public:
  /// @param code EPSG code of a geographic or projected system.
  /// @error unsupported_version a system that is known but has another projection or datum ("EPSG:3035
  ///        (ETRS89-extended / LAEA Europe): Lambert Azimuthal Equal Area is not supported"); not_found: a
  ///        code that is not in the table at all.
  static Result<Crs> from_epsg(int code);

  /// As users write it: "EPSG:32633", "epsg:32633" or "32633".
  /// @error invalid_input what is not of this form; else as from_epsg.
  static Result<Crs> from_name(std::string_view name);
  /// The code alone. @error invalid_input what is not of this form
  static Result<int> code_of_name(std::string_view name);

  /// A plane in metres that is nowhere on the Earth: lat_lon() and coordinates() give NaN.
  static Crs plane();

  /// @error invalid_input for parameters without meaning: not finite, a latitude beyond a pole, a scale not >
  /// 0.
  static Result<Crs> from_definition(CrsDefinition definition);

  /// Latitude and longitude at coordinates in the units of the system.
  /// NaN outside of the projection's picture of the Earth: beyond a pole, outside the fan of a conic, farther
  /// from the central meridian than transverse_mercator_reach_deg. Longitudes of geographic systems and
  /// eastings of Mercator wrap around. Latitudes up to 1e-9 degrees beyond a pole are taken as the pole.
  /// @cost 0.04 µs (geographic) to 0.6 µs (Lambert); no allocation.
  LatLon lat_lon(PlanePoint p) const;

  /// The inverse; longitudes of geographic systems in [-180, 180]. NaN where `at` has no coordinates: a
  /// latitude beyond a pole, a place too far from the central meridian. Mercator gives poles a far but finite
  /// northing.
  PlanePoint coordinates(LatLon at) const;

  bool geographic() const { return definition_.method == CrsMethod::geographic; }
  const CrsDefinition& definition() const { return definition_; }

  /// For reports, for example "EPSG:5070 (NAD83 / Conus Albers), Albers equal area, metres; NAD83 is taken as
  /// WGS 84, from which it is up to 2 m away".
  std::string description() const;

 private:
  Crs(CrsDefinition definition, std::shared_ptr<const Projection> projection);

  CrsDefinition definition_;
  std::shared_ptr<const Projection> projection_;  // shared: immutable, and copies of a Crs go to many threads
};

/// Whether coordinates of one system are coordinates of the other. Names and datums are not compared, nor the
/// ellipsoids of geographic systems, as all latitudes are taken as WGS 84.
bool same_coordinates(const CrsDefinition& a, const CrsDefinition& b);

}  // namespace cuesta
