#include "apps/tiles/height_tint.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ooc/srgb.h"

namespace cuesta::tiles {
namespace {

struct Stop {
  double at;  // 0: the least height on land, 1: the most
  Vec3d linear;
};

// As the shader of Shading::relief has them.
constexpr std::array<Stop, 8> land{{{0.00, {0.120, 0.230, 0.090}},
                                    {0.10, {0.195, 0.315, 0.125}},
                                    {0.24, {0.430, 0.450, 0.205}},
                                    {0.40, {0.480, 0.345, 0.150}},
                                    {0.56, {0.325, 0.200, 0.105}},
                                    {0.72, {0.300, 0.255, 0.225}},
                                    {0.86, {0.660, 0.660, 0.680}},
                                    {1.00, {0.920, 0.935, 0.960}}}};
constexpr std::array<Stop, 3> sea{
    {{0.0, {0.270, 0.500, 0.640}}, {0.5, {0.070, 0.235, 0.450}}, {1.0, {0.012, 0.060, 0.190}}}};

template <std::size_t count>
Vec3d mixed(const std::array<Stop, count>& stops, double at) {
  std::size_t i = 1;
  while (i + 1 < count && at > stops[i].at) ++i;
  const double t = std::clamp((at - stops[i - 1].at) / (stops[i].at - stops[i - 1].at), 0.0, 1.0);
  return stops[i - 1].linear * (1 - t) + stops[i].linear * t;
}

std::uint8_t srgb_byte(double linear) {
  return static_cast<std::uint8_t>(std::lround(srgb_from_linear(linear) * 255));
}

}  // namespace

HeightTint::HeightTint(const TerrainFacts& facts, const Grid& grid)
    : frame_(facts.frame), grid_(grid), sea_level_m_(facts.sea_level_m) {
  const double least = facts.least_m - sea_level_m_, most = facts.most_m - sea_level_m_;
  shore_m_ = std::max(std::min(grid.step, most / 2), 0.0);  // vertices of a flat sea are on the grid, too
  sea_floor_m_ = std::min(least, -1.0);
  land_least_m_ = std::max(least, 0.0);
  land_most_m_ = std::max({most, least + 1, 1.0});
}

Rgba8 HeightTint::colour(double height_m) const {
  const double above = height_m - sea_level_m_;
  const Vec3d c = above <= shore_m_
                      ? mixed(sea, std::sqrt(std::clamp(above / sea_floor_m_, 0.0, 1.0)))  // shelves show
                      : mixed(land, (above - land_least_m_) / (land_most_m_ - land_least_m_));
  return {srgb_byte(c.x), srgb_byte(c.y), srgb_byte(c.z), 255};
}

/// In a projection heights are z.
double HeightTint::height_m(const DrawVertex& v) const {
  const Vec3d p = grid_.world({v.x, v.y, v.z});
  return frame_.kind() == FrameKind::projected ? p.z : frame_.geodetic(p).h_m;
}

void HeightTint::put(TileMesh& mesh) const {
  for (DrawVertex& v : mesh.vertices) v.colour = colour(height_m(v));
}

}  // namespace cuesta::tiles
