#include "apps/cuesta/terrain_settings.h"

namespace cuesta::app {

using terrain_view::TerrainLook;

Result<std::optional<TerrainLook>> look_of(const Directory& directory, const std::filesystem::path& path,
                                           std::optional<Shading> shading, double exaggeration) {
  auto look = terrain_view::terrain_look(directory, path);
  if (!look) return look;
  if (*look) {
    (*look)->relief.exaggeration = exaggeration;
    return look;
  }
  if (shading == Shading::relief || exaggeration != 1)
    return fail(ErrorCode::invalid_input, path.string(),
                shading == Shading::relief ? "--shading" : "--exaggerate",
                "is no terrain: there is no height in it; leave the option out");
  return look;
}

Shading shading_of(std::optional<Shading> given, const std::optional<TerrainLook>& look) {
  return given.value_or(look ? Shading::relief : Shading::lit);
}

View camera_view(const CameraText& camera, View view, bool up_given, const std::optional<TerrainLook>& look) {
  if (look && !up_given) view.up = look->relief.up(camera.eye);
  view.eye = camera.eye;
  view.target = camera.target;
  view.up = camera.up.value_or(view.up);
  return view;
}

View orbit_view(std::span<const Vec3d> points, View view, bool up_given,
                const std::optional<TerrainLook>& look) {
  if (look && !up_given) view.up = terrain_view::first_view(*look, points, view).up;
  return view;
}

}  // namespace cuesta::app
