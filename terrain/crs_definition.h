#pragma once
/// What a coordinate reference system is made of: the plain struct that codes and GeoKeys are turned into,
/// and that Crs (crs.h) computes with. Angles in degrees, lengths in metres, whatever the units of the
/// coordinates.

#include <cstdint>
#include <string>

namespace cuesta {

/// A position on the ellipsoid: geodetic latitude, longitude east of Greenwich in [-180, 180], in degrees.
/// NaN in both stands for "no such place".
struct LatLon {
  double lat_deg = 0;
  double lon_deg = 0;
};

/// A LatLon with the ellipsoidal height h in metres.
struct Geodetic {
  double lat_deg = 0;
  double lon_deg = 0;
  double h_m = 0;

  LatLon lat_lon() const { return {lat_deg, lon_deg}; }
};

/// Coordinates in a reference system: x grows east, y grows north, also where an authority lists north first.
/// Units are the system's own.
struct PlanePoint {
  double x = 0;
  double y = 0;
};

struct Ellipsoid {
  double equatorial_radius_m = 6378137;       ///< WGS 84
  double inverse_flattening = 298.257223563;  ///< WGS 84; 0 is a sphere
};

inline constexpr Ellipsoid wgs84_ellipsoid{};
inline constexpr double us_survey_foot_m = 1200.0 / 3937.0;
inline constexpr double foot_m = 0.3048;

/// One method for each formula. The EPSG variants (1SP and 2SP, A and B) differ in parameters only.
enum class CrsMethod : std::uint8_t {
  geographic,           ///< x = longitude, y = latitude
  transverse_mercator,  ///< UTM is this
  mercator,             ///< on the ellipsoid; EPSG methods 9804, 9805
  web_mercator,         ///< spherical formulas with ellipsoidal latitudes; EPSG method 1024
  lambert_conformal,    ///< EPSG methods 9801, 9802
  albers,               ///< EPSG method 9822
  polar_stereographic,  ///< UPS is this; EPSG methods 9810, 9829
  plane,  ///< x and y in metres that are nowhere on the Earth: files that do not say where they lie
};

/// "Lambert conformal conic"
const char* name(CrsMethod method);

struct CrsDefinition {
  std::string name;   ///< as users see it: "EPSG:2154 (RGF93 v1 / Lambert-93)"
  std::string datum;  ///< "RGF93 v1"
  /// About how far, at most, the datum's positions are from WGS 84. Nothing corrects for it. Negative:
  /// unknown.
  double datum_offset_m = 0;
  CrsMethod method = CrsMethod::geographic;
  Ellipsoid ellipsoid;
  /// What one unit of x and y is: degrees (geographic) or metres (all others).
  double unit = 1;
  double prime_meridian_deg =
      0;  ///< of the system's longitudes, east of Greenwich; also of longitude_origin_deg
  double latitude_origin_deg =
      0;  ///< where y is false_northing_m; polar stereographic: 90 or -90, which pole
  double longitude_origin_deg = 0;
  /// Standard parallels, at which the scale is `scale`. One of them: both the same (1SP).
  /// Polar stereographic, Mercator: parallel_1_deg only.
  double parallel_1_deg = 0;
  double parallel_2_deg = 0;
  double scale = 1;
  double false_easting_m = 0;
  double false_northing_m = 0;
};

}  // namespace cuesta
