#include "hierarchy/sphere_codec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "hierarchy/fan_cover.h"
#include "hierarchy/replay_mesh.h"
#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr std::uint16_t infinite_radius = 0x7F80;

/// The exponent that a radius gives its offsets' unit.
int exponent(std::uint16_t radius) {
  return radius >> 7;
}

/// The offset of one sphere in the unit of another radius.
std::array<std::int8_t, 3> guessed_offset(SphereCode follows, std::uint16_t radius) {
  const int shift = exponent(follows.radius) - exponent(radius);
  const auto guess = [&](std::int8_t offset) {
    return static_cast<std::int8_t>(
        std::clamp(std::round(std::ldexp(static_cast<double>(offset), shift)), -127.0, 127.0));
  };
  return {guess(follows.offset_x), guess(follows.offset_y), guess(follows.offset_z)};
}

bool cover(const Page& page, std::span<const Vec3i> places, Script& script, const FanSphere& sphere) {
  const auto first_wedge = points_of(page);
  std::vector<std::uint32_t> changed;
  return cover_fans({places, first_wedge, page.triangles, {}}, script, changed, sphere);
}

}  // namespace

std::vector<Plane> pack_spheres(const Page& page, std::span<const Vec3i> places) {
  NumberWriter radii(1);
  std::vector<Plane> offsets(3);
  const auto put = [&](std::size_t fan, SphereCode follows) {
    const SphereCode is = page.script.fans[fan].sphere;
    const auto guess = guessed_offset(follows, is.radius);
    radii.put_signed(0, is.radius - follows.radius);
    offsets[0].push_back(static_cast<std::byte>(is.offset_x - guess[0]));
    offsets[1].push_back(static_cast<std::byte>(is.offset_y - guess[1]));
    offsets[2].push_back(static_cast<std::byte>(is.offset_z - guess[2]));
    return is;
  };
  Script script = page.script;
  if (page.round > 0) CUESTA_CHECK(cover(page, places, script, put));
  auto planes = radii.take();
  std::move(offsets.begin(), offsets.end(), std::back_inserter(planes));
  return planes;
}

bool unpack_spheres(std::span<const Plane> planes, std::span<const Vec3i> places, Page& page) {
  NumberReader radii(planes.first(2));
  const auto offsets = planes.subspan(2);
  const std::size_t count = page.round > 0 ? page.script.fans.size() : 0;
  if (std::any_of(offsets.begin(), offsets.end(), [count](const Plane& p) { return p.size() != count; }))
    return false;
  bool good = true;
  const auto get = [&](std::size_t fan, SphereCode follows) -> SphereCode {
    const std::int64_t radius = follows.radius + radii.get_signed(0);
    if (radius < 0 || radius >= infinite_radius) {
      good = false;
      return follows;
    }
    const auto code = static_cast<std::uint16_t>(radius);
    const auto guess = guessed_offset(follows, code);
    const auto offset = [&](std::size_t k) {
      return static_cast<std::int8_t>(guess[k] + static_cast<int>(offsets[k][fan]));
    };
    return {code, offset(0), offset(1), offset(2)};
  };
  return cover(page, places, page.script, page.round > 0 ? FanSphere(get) : FanSphere()) && good &&
         radii.at_end();
}

}  // namespace cuesta
