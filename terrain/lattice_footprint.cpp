#include "terrain/lattice_footprint.h"

#include <algorithm>
#include <cmath>

namespace cuesta {
namespace {

/// Postings by which a footprint is larger than the image of the triangle's corners and edges says.
constexpr double footprint_margin = 0.5;
/// Edges are straight on a lattice to within this, in postings, or cut until they are.
constexpr double most_bulge = 0.25;
constexpr int most_cuts = 12;
/// Nearer to a pole than this a footprint goes all around.
constexpr double polar_latitude_deg = 88;
constexpr double most_height_m = 20'000;
constexpr double far = 1e300;

bool is_known(LatticePoint p) {
  return std::isfinite(p.column) && std::isfinite(p.row);
}

double bulge(LatticePoint a, LatticePoint middle, LatticePoint b) {
  return std::max(std::abs(middle.column - (a.column + b.column) / 2),
                  std::abs(middle.row - (a.row + b.row) / 2));
}

/// The first and last whole number within the margin of an interval, cut off at 0 and count.
std::array<std::int64_t, 2> whole_numbers(double least, double most, std::uint64_t count) {
  const double last = static_cast<double>(count) - 1;
  return {static_cast<std::int64_t>(std::clamp(std::ceil(least - footprint_margin), 0.0, last + 1)),
          static_cast<std::int64_t>(std::clamp(std::floor(most + footprint_margin), -1.0, last))};
}

}  // namespace

/// The image of a triangle's edges, in straight pieces.
struct LatticeFootprints::Outline {
  std::vector<std::array<LatticePoint, 2>> edges;
  double top = far, bottom = -far, west = far, east = -far;
  bool is_torn = false;  ///< neighbours on an edge are far apart on the lattice
  bool is_lost = false;  ///< a part of an edge has no place on it

  void add(LatticePoint a, LatticePoint b) {
    edges.push_back({a, b});
    top = std::min({top, a.row, b.row});
    bottom = std::max({bottom, a.row, b.row});
    west = std::min({west, a.column, b.column});
    east = std::max({east, a.column, b.column});
  }
};

LatticeFootprints::LatticeFootprints(const Frame& frame, const MosaicLayer& layer,
                                     const PostingPositions& positions)
    : frame_(frame), layer_(layer), positions_(positions) {
  if (positions.is_straight() || layer.crs.geographic()) return;
  reach_ = find_reach();
  const CrsMethod method = layer.crs.definition().method;
  const bool is_regular =
      method == CrsMethod::transverse_mercator || method == CrsMethod::polar_stereographic;
  for (const double lat_deg : {90.0, -90.0})
    if (!is_regular) torn_poles_m_.push_back(frame.position_m(Geodetic{lat_deg, 0, 0}));
}

/// From a net of postings: no other is farther from one of them than its neighbour in the net.
LatticeFootprints::Sphere LatticeFootprints::find_reach() const {
  constexpr std::size_t n = 9;
  std::vector<Vec3d> net;
  double mesh_m = 0;
  Box3d box;
  for (std::size_t r = 0; r < n; ++r)
    for (std::size_t c = 0; c < n; ++c) {
      const std::array<float, 1> sea{0};
      std::array<Vec3d, 1> at;
      positions_.of(static_cast<std::int64_t>((layer_.width - 1) * c / (n - 1)),
                    static_cast<std::int64_t>((layer_.height - 1) * r / (n - 1)), 1, 1, sea, at);
      net.push_back(at[0]);
      if (!std::isfinite(at[0].x)) return {{}, far};
      box.add(at[0]);
      if (c > 0) mesh_m = std::max(mesh_m, length(at[0] - net[net.size() - 2]));
      if (r > 0) mesh_m = std::max(mesh_m, length(at[0] - net[net.size() - 1 - n]));
    }
  Sphere sphere{(box.lo + box.hi) / 2.0, 0};
  for (const Vec3d& p : net) sphere.radius_m = std::max(sphere.radius_m, length(p - sphere.centre_m));
  sphere.radius_m += mesh_m + most_height_m;
  return sphere;
}

/// A triangle is no farther below the ground than it is wide.
bool LatticeFootprints::may_reach(const std::array<Vec3d, 3>& corners_m) const {
  const Vec3d middle = (corners_m[0] + corners_m[1] + corners_m[2]) / 3.0;
  double radius = 0;
  for (const Vec3d& p : corners_m) radius = std::max(radius, length(p - middle));
  return length(middle - reach_.centre_m) <= reach_.radius_m + 2 * radius;
}

bool LatticeFootprints::covers_a_tear(const std::array<Vec3d, 3>& corners_m) const {
  return std::any_of(torn_poles_m_.begin(), torn_poles_m_.end(), [&](Vec3d pole) {
    const Vec3d up = frame_.up(pole);
    const auto is_left = [&](const Vec3d& a, const Vec3d& b) { return dot(up, cross(b - a, pole - a)) >= 0; };
    return dot(up, cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0])) > 0 &&
           is_left(corners_m[0], corners_m[1]) && is_left(corners_m[1], corners_m[2]) &&
           is_left(corners_m[2], corners_m[0]);
  });
}

/// Both halves have to be straight, too: an edge across the equator bends to one side, then to the other.
void LatticeFootprints::add_edge(Outline& outline, LatticePoint a, Vec3d a_m, LatticePoint b, Vec3d b_m,
                                 int cuts) const {
  const double apart = std::max(std::abs(a.column - b.column), std::abs(a.row - b.row));
  if (positions_.is_straight() || apart <= 2) return outline.add(a, b);
  if (cuts == 0) {
    outline.is_torn = true;
    return outline.add(a, b);
  }
  const Vec3d middle_m = (a_m + b_m) * 0.5;
  const LatticePoint middle = positions_.lattice_point(middle_m, a.column);
  if (!is_known(middle)) {
    outline.is_lost = true;
    return;
  }
  if (bulge(a, middle, b) <= most_bulge) {
    const LatticePoint early = positions_.lattice_point((a_m + middle_m) * 0.5, a.column),
                       late = positions_.lattice_point((middle_m + b_m) * 0.5, middle.column);
    if (bulge(a, early, middle) <= most_bulge && bulge(middle, late, b) <= most_bulge) {
      outline.add(a, early);
      outline.add(early, middle);
      outline.add(middle, late);
      return outline.add(late, b);
    }
  }
  add_edge(outline, a, a_m, middle, middle_m, cuts - 1);
  add_edge(outline, middle, middle_m, b, b_m, cuts - 1);
}

/// Of a geographic lattice.
double LatticeFootprints::latitude_deg(double row) const {
  return layer_.map.y(0, row) * layer_.crs.definition().unit;
}

/// Around a pole, near one, or as wide as half the Earth.
bool LatticeFootprints::is_polar(const Outline& outline, std::span<const LatticePoint, 3> corners) const {
  const double around = positions_.columns_around();
  if (around == 0 || positions_.is_straight()) return false;
  return outline.east - outline.west > around / 2 - 1 ||
         std::any_of(corners.begin(), corners.end(),
                     [&](LatticePoint p) { return std::abs(latitude_deg(p.row)) > polar_latitude_deg; });
}

std::vector<LatticeRun> LatticeFootprints::all_columns(double top, double bottom) const {
  const auto [first, last] = whole_numbers(top, bottom, layer_.height);
  std::vector<LatticeRun> runs;
  for (std::int64_t r = first; r <= last; ++r)
    runs.push_back({static_cast<std::uint64_t>(r), 0, layer_.width - 1});
  return runs;
}

/// The part of each edge that is within the margin of a row, and what is between them.
std::vector<LatticeRun> LatticeFootprints::filled(const Outline& outline) const {
  const auto [first, last] = whole_numbers(outline.top, outline.bottom, layer_.height);
  if (first > last) return {};
  std::vector<std::array<double, 2>> columns(static_cast<std::size_t>(last - first + 1), {far, -far});
  for (const auto& edge : outline.edges) {
    LatticePoint a = edge[0], b = edge[1];
    if (a.row > b.row) std::swap(a, b);
    const double rise = b.row - a.row;
    const auto [r0, r1] = whole_numbers(a.row, b.row, layer_.height);
    for (std::int64_t r = std::max(first, r0); r <= std::min(last, r1); ++r) {
      const auto at = [&](double row) {
        return a.column + std::clamp((row - a.row) / rise, 0.0, 1.0) * (b.column - a.column);
      };
      const double row = static_cast<double>(r);
      const double c0 = rise > 0 ? at(row - footprint_margin) : a.column;
      const double c1 = rise > 0 ? at(row + footprint_margin) : b.column;
      auto& [least, most] = columns[static_cast<std::size_t>(r - first)];
      least = std::min({least, c0, c1});
      most = std::max({most, c0, c1});
    }
  }
  std::vector<LatticeRun> runs;
  // Columns that go around are met wherever the layer has them; it may have both ends of a run, and no
  // middle.
  const double around = positions_.columns_around();
  for (std::size_t i = 0; i < columns.size(); ++i)
    for (int turns = around > 0 ? -1 : 0; turns <= (around > 0 ? 1 : 0); ++turns) {
      const auto [least, most] = columns[i];
      if (least > most) continue;
      const auto [c0, c1] = whole_numbers(least + turns * around, most + turns * around, layer_.width);
      if (c0 <= c1)
        runs.push_back({static_cast<std::uint64_t>(first) + i, static_cast<std::uint64_t>(c0),
                        static_cast<std::uint64_t>(c1)});
    }
  return runs;
}

std::vector<LatticeRun> LatticeFootprints::of(const std::array<Vec3d, 3>& corners_m) const {
  std::array<LatticePoint, 3> at;
  Outline outline;
  for (std::size_t k = 0; k < 3; ++k) {
    at[k] = positions_.lattice_point(corners_m[k], k == 0 ? 0 : at[0].column);
    outline.is_lost |= !is_known(at[k]);
  }
  for (std::size_t k = 0; k < 3 && !outline.is_lost; ++k)
    add_edge(outline, at[k], corners_m[k], at[(k + 1) % 3], corners_m[(k + 1) % 3], most_cuts);
  const auto last_row = static_cast<double>(layer_.height - 1);
  if (outline.is_lost || covers_a_tear(corners_m))
    return may_reach(corners_m) ? all_columns(0, last_row) : std::vector<LatticeRun>{};
  if (is_polar(outline, at)) {  // one that reaches over the equator may be around either pole
    const bool north = latitude_deg(outline.top) > 0, south = latitude_deg(outline.bottom) < 0;
    return all_columns(north ? 0 : outline.top - 1, south ? last_row : outline.bottom + 1);
  }
  return outline.is_torn ? all_columns(outline.top, outline.bottom) : filled(outline);
}

}  // namespace cuesta
