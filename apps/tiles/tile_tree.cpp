#include "apps/tiles/tile_tree.h"

#include <cmath>
#include <numbers>

#include "apps/tiles/globe_borders.h"

namespace cuesta::tiles {
namespace {

/// Sides of at least this share of the longest are halved, too.
constexpr double long_side = 0.6;

/// Ranges smaller than that are not halved.
constexpr double least_steps = 16, least_degrees = 1e-6;

/// A range that may reach around the globe: then its ends are borders as any other.
constexpr double half_turn_deg = 180;

}  // namespace

TileTree::TileTree(const Directory& d, const std::optional<TerrainFacts>& facts)
    : grid_(d.grid), axes_(facts ? 2 : 3) {
  if (facts && facts->frame.kind() != FrameKind::projected && facts->bounds) {
    frame_ = facts->frame;
    const GeoBox& b = *facts->bounds;
    root_.lo = {b.west_deg, b.south_deg, 0};
    root_.hi = {std::min(b.east_deg, b.west_deg + 2 * half_turn_deg), b.north_deg, 0};
    return;
  }
  const Vec3d lo = vec_cast<double>(d.lo), hi = vec_cast<double>(d.hi);
  root_.lo = {lo.x, lo.y, lo.z};
  root_.hi = {hi.x, hi.y, hi.z};
}

unsigned TileTree::halved(const TileRange& range) const {
  std::array<double, 3> size{};
  for (std::size_t a = 0; a < axes_; ++a) size[a] = range.size(a);
  if (on_globe()) {
    const double middle = (range.lo[1] + range.hi[1]) / 2 * std::numbers::pi / 180;
    size[0] *= std::max(std::cos(middle), 1e-3);
  }
  const double longest = std::max({size[0], size[1], size[2]});
  if (longest < (on_globe() ? least_degrees : least_steps)) return 0;
  unsigned axes = 0;
  for (std::size_t a = 0; a < axes_; ++a)
    if (size[a] >= long_side * longest) axes |= 1u << a;
  // Between borders more than half a turn apart there would be nothing.
  if (on_globe() && range.size(0) > half_turn_deg) axes |= 1u;
  return axes;
}

TileRange TileTree::half(TileRange range, unsigned halved, unsigned upper) const {
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!(halved >> a & 1u)) continue;
    const double middle = range.lo[a] + range.size(a) / 2;
    (upper >> a & 1u ? range.lo : range.hi)[a] = middle;
  }
  return range;
}

std::vector<char> TileTree::children(const TileRange& range) const {
  const unsigned axes = halved(range);
  std::vector<char> digits;
  for (unsigned upper = 0; axes != 0 && upper < 8; ++upper)
    if ((upper & ~axes) == 0) digits.push_back(static_cast<char>('0' + upper));
  return digits;
}

std::optional<TileRange> TileTree::range(const std::string& path) const {
  TileRange range = root_;
  for (const char digit : path) {
    const unsigned axes = halved(range), upper = static_cast<unsigned>(digit - '0');
    if (digit < '0' || digit > '7' || axes == 0 || (upper & ~axes) != 0) return std::nullopt;
    range = half(range, axes, upper);
  }
  return range;
}

PartBorder TileTree::border(std::size_t axis, bool upper, double at) const {
  if (on_globe()) {
    constexpr Side sides[2][2] = {{Side::west, Side::east}, {Side::south, Side::north}};
    return globe_border(*frame_, grid_, sides[axis][upper], at);
  }
  PartBorder plane;
  plane.apex[static_cast<int>(axis)] = at;
  plane.inward[static_cast<int>(axis)] = upper ? -1 : 1;
  return plane;
}

SurfacePart TileTree::part(const TileRange& range) const {
  SurfacePart part;
  for (std::size_t a = 0; a < axes_; ++a) {
    const bool around =
        on_globe() && a == 0 && root_.size(0) > half_turn_deg && range.size(0) <= half_turn_deg;
    if (around || range.lo[a] != root_.lo[a]) part.borders.push_back(border(a, false, range.lo[a]));
    if (around || range.hi[a] != root_.hi[a]) part.borders.push_back(border(a, true, range.hi[a]));
  }
  return part;
}

}  // namespace cuesta::tiles
