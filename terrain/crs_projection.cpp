#include "terrain/crs_projection.h"

#include <GeographicLib/AlbersEqualArea.hpp>
#include <GeographicLib/LambertConformalConic.hpp>
#include <GeographicLib/PolarStereographic.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "ooc/check.h"
#include "terrain/crs.h"

namespace cuesta {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double degree = std::numbers::pi / 180;

double flattening(const Ellipsoid& e) {
  return e.inverse_flattening == 0 ? 0 : 1 / e.inverse_flattening;
}

class TransverseMercatorPlane final : public Projection {
 public:
  explicit TransverseMercatorPlane(const CrsDefinition& d)
      : map_(d.ellipsoid.equatorial_radius_m, flattening(d.ellipsoid), d.scale),
        lon0_deg_(d.longitude_origin_deg),
        reach_m_(d.scale * d.ellipsoid.equatorial_radius_m * std::atanh(sin_reach + 0.01)) {
    double x, y;
    map_.Forward(0, 0, 180, x, y);
    far_equator_m_ = std::abs(y);
    map_.Forward(0, d.latitude_origin_deg, 0, x, y);
    x0_ = d.false_easting_m;
    y0_ = d.false_northing_m - y;
  }
  PlanePoint forward(LatLon at) const override {
    const double away = std::cos(at.lat_deg * degree) * std::sin((at.lon_deg - lon0_deg_) * degree);
    if (!(std::abs(away) <= sin_reach)) return {nan, nan};
    double x, y;
    map_.Forward(lon0_deg_, at.lat_deg, at.lon_deg, x, y);
    return {x + x0_, y + y0_};
  }
  LatLon inverse(PlanePoint p) const override {
    const double x = p.x - x0_, y = p.y - y0_;
    if (!(std::abs(x) <= reach_m_ && std::abs(y) <= far_equator_m_ * (1 + 1e-12))) return {nan, nan};
    LatLon at;
    map_.Reverse(lon0_deg_, x, y, at.lat_deg, at.lon_deg);
    return at;
  }

 private:
  static constexpr double sin_reach = 0.5446390350150271;  // sin(transverse_mercator_reach_deg)
  static_assert(transverse_mercator_reach_deg == 33);

  GeographicLib::TransverseMercator map_;
  double lon0_deg_, reach_m_;  // the reach of the inverse is a little wider, so that all points come back
  double far_equator_m_ = 0;   // northing of the equator beyond the pole: where the plane ends
  double x0_ = 0, y0_ = 0;
};

class WebMercatorPlane final : public Projection {
 public:
  explicit WebMercatorPlane(const CrsDefinition& d) : d_(d) {}
  PlanePoint forward(LatLon at) const override {
    const double east_deg = std::remainder(at.lon_deg - d_.longitude_origin_deg, 360);
    return {d_.false_easting_m + radius() * east_deg * degree,
            d_.false_northing_m + radius() * std::asinh(std::tan(at.lat_deg * degree))};
  }
  LatLon inverse(PlanePoint p) const override {
    const double east_deg = (p.x - d_.false_easting_m) / radius() / degree;
    return {std::atan(std::sinh((p.y - d_.false_northing_m) / radius())) / degree,
            std::remainder(d_.longitude_origin_deg + east_deg, 360)};
  }

 private:
  double radius() const { return d_.ellipsoid.equatorial_radius_m; }
  CrsDefinition d_;
};

class PolarStereographicPlane final : public Projection {
 public:
  explicit PolarStereographicPlane(const CrsDefinition& d)
      : map_(d.ellipsoid.equatorial_radius_m, flattening(d.ellipsoid), d.scale),
        north_(d.latitude_origin_deg > 0),
        lon0_deg_(d.longitude_origin_deg),
        x0_(d.false_easting_m),
        y0_(d.false_northing_m) {
    const double true_lat_deg = north_ ? d.parallel_1_deg : -d.parallel_1_deg;
    if (true_lat_deg != 90) map_.SetScale(true_lat_deg, d.scale);
  }
  PlanePoint forward(LatLon at) const override {
    PlanePoint p;
    double gamma, k;
    map_.Forward(north_, at.lat_deg, std::remainder(at.lon_deg - lon0_deg_, 360), p.x, p.y, gamma, k);
    return {p.x + x0_, p.y + y0_};
  }
  LatLon inverse(PlanePoint p) const override {
    LatLon at;
    double gamma, k;
    map_.Reverse(north_, p.x - x0_, p.y - y0_, at.lat_deg, at.lon_deg, gamma, k);
    at.lon_deg = std::remainder(at.lon_deg + lon0_deg_, 360);
    return at;
  }

 private:
  GeographicLib::PolarStereographic map_;
  bool north_;
  double lon0_deg_, x0_, y0_;
};

/// Lambert, Albers and, with opposite parallels, Mercator. `Map` is GeographicLib's class. Cones with the
/// south pole inside are computed as the mirror image of northern ones: GeographicLib 2.1.2's AlbersEqualArea
/// loses the sign of latitudes in the south (-18, -36 degrees of EPSG:3577 came out 5,000 km off).
template <class Map>
class ConicPlane final : public Projection {
 public:
  ConicPlane(const CrsDefinition& d, double parallel_2_deg)
      : mirror_(d.parallel_1_deg + parallel_2_deg < 0 ? -1 : 1),
        map_(d.ellipsoid.equatorial_radius_m, flattening(d.ellipsoid), mirror_ * d.parallel_1_deg,
             mirror_ * parallel_2_deg, d.scale),
        lon0_deg_(d.longitude_origin_deg) {
    double x, y, gamma, k;
    map_.Forward(0, map_.OriginLatitude(), 90, x, y, gamma, k);
    cone_ = gamma / 90;
    apex_m_ = cone_ == 0 ? 0 : y + x / std::tan(gamma * degree);
    map_.Forward(0, 90, 0, x, north_pole_m_);
    map_.Forward(0, -90, 0, x, south_pole_m_);
    map_.Forward(0, mirror_ * d.latitude_origin_deg, 0, x, y);
    x0_ = d.false_easting_m;
    y0_ = d.false_northing_m - mirror_ * y;
  }
  PlanePoint forward(LatLon at) const override {
    double x, y;
    map_.Forward(lon0_deg_, mirror_ * at.lat_deg, at.lon_deg, x, y);
    return {x + x0_, mirror_ * y + y0_};
  }
  LatLon inverse(PlanePoint p) const override {
    const double x = p.x - x0_, y = mirror_ * (p.y - y0_);
    const double slack_m = 1e-6 + 1e-12 * apex_m_;
    const double radius_m = std::hypot(x, apex_m_ - y);
    const double meridian_m = cone_ == 0 ? y : apex_m_ - radius_m;  // northing there of the point's parallel
    if (!(meridian_m <= north_pole_m_ + slack_m && meridian_m >= south_pole_m_ - slack_m)) return {nan, nan};
    if (cone_ != 0 && radius_m < slack_m) return {mirror_ * 90.0, lon0_deg_};  // the apex has no direction
    LatLon at;
    double gamma, k;
    map_.Reverse(lon0_deg_, x, y, at.lat_deg, at.lon_deg, gamma, k);
    if (std::abs(gamma) > cone_ * 180 * (1 + 1e-12) + 1e-12) return {nan, nan};
    at.lat_deg *= mirror_;
    return at;
  }

 private:
  int mirror_;  // 1, or -1 in the south
  Map map_;
  double lon0_deg_;
  double cone_ = 0;                             // degrees on the plane for a degree of longitude, ≥ 0
  double apex_m_ = 0;                           // northing of the fan's centre
  double north_pole_m_ = 0, south_pole_m_ = 0;  // their northings on the central meridian
  double x0_ = 0, y0_ = 0;
};

class NowherePlane final : public Projection {
 public:
  PlanePoint forward(LatLon) const override { return {nan, nan}; }
  LatLon inverse(PlanePoint) const override { return {nan, nan}; }
};

std::shared_ptr<const Projection> make(const CrsDefinition& d) {
  using Lambert = ConicPlane<GeographicLib::LambertConformalConic>;
  using Albers = ConicPlane<GeographicLib::AlbersEqualArea>;
  switch (d.method) {
    case CrsMethod::transverse_mercator:
      return std::make_shared<TransverseMercatorPlane>(d);
    case CrsMethod::web_mercator:
      return std::make_shared<WebMercatorPlane>(d);
    case CrsMethod::polar_stereographic:
      return std::make_shared<PolarStereographicPlane>(d);
    case CrsMethod::mercator:
      return std::make_shared<Lambert>(d, -d.parallel_1_deg);
    case CrsMethod::lambert_conformal:
      return std::make_shared<Lambert>(d, d.parallel_2_deg);
    case CrsMethod::albers:
      return std::make_shared<Albers>(d, d.parallel_2_deg);
    case CrsMethod::plane:
      return std::make_shared<NowherePlane>();
    case CrsMethod::geographic:
      break;
  }
  CUESTA_CHECK(d.method != CrsMethod::geographic);
  return nullptr;
}

}  // namespace

Result<std::shared_ptr<const Projection>> make_projection(const CrsDefinition& definition) {
  try {
    return make(definition);
  } catch (const std::exception& e) {
    return fail(
        ErrorCode::invalid_input, "", definition.name,
        std::string("the parameters of ") + name(definition.method) + " have no meaning: " + e.what());
  }
}

}  // namespace cuesta
