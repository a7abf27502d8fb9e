#include "apps/sample/height_sampler.h"

#include <cmath>

namespace cuesta::sample {
namespace {

/// Below the least and above the greatest height: chords of triangles 100 km long are 200 m below the
/// ellipsoid.
constexpr double reach_m = 1000;

}  // namespace

Result<std::unique_ptr<HeightSampler>> HeightSampler::open(const std::filesystem::path& path) {
  auto file = CuestaFile::open(path);
  if (!file) return fail(file.error());
  auto facts = terrain_facts(file->directory().metadata);
  if (!facts) {
    Error error = facts.error();
    error.file = path.string();
    return fail(std::move(error));
  }
  if (!*facts)
    return fail(
        ErrorCode::invalid_input, path.string(), "",
        "is no terrain: its surface has no frame that places could be found in; build it from heights");
  return std::unique_ptr<HeightSampler>(new HeightSampler(std::move(*file), std::move(**facts)));
}

Result<std::optional<HeightSample>> HeightSampler::at(LatLon place) {
  const auto point = [&](double h_m) {
    return facts_.frame.position_m(Geodetic{place.lat_deg, place.lon_deg, h_m});
  };
  return between(point(facts_.least_m - reach_m), point(facts_.most_m + reach_m));
}

Result<std::optional<HeightSample>> HeightSampler::at(const Crs& crs, PlanePoint p) {
  return between(facts_.frame.position_m(crs, p, facts_.least_m - reach_m),
                 facts_.frame.position_m(crs, p, facts_.most_m + reach_m));
}

Result<std::optional<HeightSample>> HeightSampler::between(Vec3d low, Vec3d high) {
  if (!std::isfinite(length(low)) || !std::isfinite(length(high))) return std::optional<HeightSample>();
  const auto hit = surface_.meet(low, high);
  if (!hit) return fail(hit.error());
  if (!*hit) return std::optional<HeightSample>();
  return std::optional<HeightSample>(HeightSample{**hit, facts_.frame.geodetic(**hit)});
}

}  // namespace cuesta::sample
