#pragma once
/// The formulas behind Crs: latitude and longitude on an ellipsoid to metres on a plane. Only
/// crs_projection.cpp knows GeographicLib.

#include <memory>

#include "ooc/result.h"
#include "terrain/crs_definition.h"

namespace cuesta {

/// Threads: const calls are concurrent. Longitudes are relative to nothing but the definition's own prime
/// meridian.
class Projection {
 public:
  virtual ~Projection() = default;
  /// Metres with false easting and northing. @pre |lat| ≤ 90. NaN outside of the domain that crs.h states.
  virtual PlanePoint forward(LatLon at) const = 0;
  /// NaN outside of the domain that crs.h states.
  virtual LatLon inverse(PlanePoint p_m) const = 0;
};

/// @pre the definition is not geographic.
/// @error invalid_input, with GeographicLib's reason, for parameters without meaning.
Result<std::shared_ptr<const Projection>> make_projection(const CrsDefinition& definition);

}  // namespace cuesta
