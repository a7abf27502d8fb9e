#include "terrain/mosaic_seams.h"

#include <numbers>
#include <queue>
#include <unordered_map>

#include "ooc/read_job.h"
#include "terrain/constrained_delaunay.h"
#include "terrain/mosaic_cover.h"

namespace cuesta {
namespace {

constexpr double box_margin = 16;      // around a part, in spacings: what of the surface so far is looked at
constexpr double grid_steps = 0x1p48;  // of the plane's extent: what positions are rounded to

using Faces = std::vector<DelaunayTriangle>;
constexpr std::uint32_t none = DelaunayTriangle::none;

/// The vertices of a gap, and the segments between them, in the plane of one layer.
class GapPlane {
 public:
  GapPlane(const LatticeView& view, const LayerPart& part) : view_(view), part_(part) {}

  /// Edges with an end near the part; those at a pole have no length.
  void add(std::span<const OutlineEdge> edges) {
    for (const OutlineEdge& edge : edges) {
      const PlanePoint a = view_.at(edge.from), b = view_.near(view_.at(edge.to), a);
      if (is_at_pole(edge.from) || is_at_pole(edge.to) || !(is_near(a) || is_near(b))) continue;
      const std::uint32_t from = number_of(edge.from, a), to = number_of(edge.to, b);
      segments_.push_back({from, to});
      const double length = std::hypot(b.x - a.x, b.y - a.y);
      for (const std::uint32_t end : {from, to}) longest_[end] = std::max(longest_[end], length);
    }
  }

  void add(std::span<const PostingRef> postings) {
    for (const PostingRef& posting : postings) {
      if (!is_at_pole(posting)) number_of(posting, view_.at(posting));
    }
  }

  std::span<const std::array<std::uint32_t, 2>> segments() const { return segments_; }
  const PostingRef& posting(std::uint32_t i) const { return postings_[i]; }
  /// In columns and rows of the layer.
  PlanePoint place(std::uint32_t i) const { return places_[i]; }
  bool is_of_layer(std::uint32_t i) const { return postings_[i].layer == part_.layer; }
  double longest_edge_at(std::uint32_t i) const { return longest_[i]; }
  /// In spacings of the layer. Around a pole, where columns lie close together, in spacings of rows.
  double distance(std::uint32_t i, std::uint32_t j) const {
    const PlanePoint a = places_[i], b = view_.near(places_[j], a);
    const double distance = std::hypot(b.x - a.x, b.y - a.y);
    if (!part_.is_closed) return distance;
    const PlanePoint p = around_pole(a, is_north_), q = around_pole(b, is_north_);
    return std::min(distance, std::hypot(q.x - p.x, q.y - p.y));
  }
  /// In columns and rows of the layer; the columns are some turn's.
  PlanePoint middle(const DelaunayTriangle& face) const {
    const PlanePoint a = places_[face.points[0]], b = view_.near(places_[face.points[1]], a),
                     c = view_.near(places_[face.points[2]], a);
    return {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3};
  }
  /// When all edges are there: places the points where they are triangulated, seen from above.
  std::vector<GridPoint> grid();

 private:
  bool is_at_pole(const PostingRef& p) const {
    if (p.layer != part_.layer) return false;
    const MosaicLayer& layer = view_.layer();
    return (layer.north_pole && p.row == 0) || (layer.south_pole && p.row + 1 == layer.height);
  }
  bool is_near(PlanePoint p) const {
    const double west = double(part_.column), north = double(part_.row);
    return (part_.is_closed ||
            (p.x >= west - box_margin && p.x <= west + double(part_.width) + box_margin)) &&
           p.y >= north - box_margin && p.y <= north + double(part_.height) + box_margin;
  }
  std::uint32_t number_of(const PostingRef& posting, PlanePoint place) {
    const auto [at, is_new] = numbers_.try_emplace(posting, static_cast<std::uint32_t>(postings_.size()));
    if (is_new) {
      postings_.push_back(posting);
      places_.push_back(place);
      longest_.push_back(1);
    }
    return at->second;
  }
  PlanePoint around_pole(PlanePoint p, bool is_north) const;
  bool is_better_seen_from_north() const;

  struct Hash {
    std::size_t operator()(const PostingRef& p) const {
      return (p.row * 0x9e3779b97f4a7c15ull + p.column) * 0xbf58476d1ce4e5b9ull + p.layer;
    }
  };

  const LatticeView& view_;
  LayerPart part_;
  std::unordered_map<PostingRef, std::uint32_t, Hash> numbers_;
  std::vector<PostingRef> postings_;
  std::vector<PlanePoint> places_;
  std::vector<double> longest_;  // edge of the outline at each, at least 1
  std::vector<std::array<std::uint32_t, 2>> segments_;
  bool is_north_ = true;  // which pole the plane is around, if it is
};

/// Rows from the pole and the angle of longitude: the plane of a layer that goes around the Earth.
PlanePoint GapPlane::around_pole(PlanePoint p, bool is_north) const {
  const MosaicLayer& layer = view_.layer();
  const double pole = (is_north ? 90 : -90) / layer.crs.definition().unit;
  const double rows = std::abs(p.y - (pole - layer.map.y0) / layer.map.y_per_row);
  const double angle = 2 * std::numbers::pi * p.x / double(layer.columns_around);
  return {rows * std::cos(angle), (is_north ? 1 : -1) * rows * std::sin(angle)};
}

/// The other pole is a circle in the plane: nothing should be near it.
bool GapPlane::is_better_seen_from_north() const {
  double north = HUGE_VAL, south = HUGE_VAL;
  for (const PlanePoint p : places_) {
    const PlanePoint from_north = around_pole(p, true), from_south = around_pole(p, false);
    north = std::min(north, std::hypot(from_north.x, from_north.y));
    south = std::min(south, std::hypot(from_south.x, from_south.y));
  }
  return south >= north;
}

std::vector<GridPoint> GapPlane::grid() {
  std::vector<PlanePoint> plane;
  is_north_ = part_.is_closed && is_better_seen_from_north();
  double extent = 1;
  for (const PlanePoint p : places_) {
    plane.push_back(part_.is_closed ? around_pole(p, is_north_)
                                    : PlanePoint{p.x - double(part_.column), double(part_.row) - p.y});
    extent = std::max({extent, std::abs(plane.back().x), std::abs(plane.back().y)});
  }
  const double scale = std::exp2(std::floor(std::log2(grid_steps / extent)));
  std::vector<GridPoint> out;
  for (const PlanePoint p : plane) out.push_back({std::llround(p.x * scale), std::llround(p.y * scale)});
  return out;
}

/// Which faces lie outside of both surfaces: told from the segments' sides, the nearest first, as outlines
/// may leave the part.
std::vector<bool> faces_outside(const Faces& faces, std::span<const std::array<std::uint32_t, 2>> segments) {
  const auto key = [](std::uint64_t from, std::uint64_t to) { return from << 32 | to; };
  std::unordered_set<std::uint64_t> directed;
  for (const auto& [from, to] : segments) directed.insert(key(from, to));
  std::vector<char> side(faces.size(), 0);  // 1 inside, 2 outside
  std::queue<std::uint32_t> next;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    for (std::size_t i = 0; i < 3 && side[f] == 0; ++i) {
      if (!faces[f].is_segment[i]) continue;
      side[f] = directed.contains(key(faces[f].points[(i + 1) % 3], faces[f].points[(i + 2) % 3])) ? 1 : 2;
      next.push(f);
    }
  }
  for (; !next.empty(); next.pop()) {
    const DelaunayTriangle& face = faces[next.front()];
    for (std::size_t i = 0; i < 3; ++i) {
      if (face.is_segment[i] || face.across[i] == none || side[face.across[i]] != 0) continue;
      side[face.across[i]] = side[next.front()];
      next.push(face.across[i]);
    }
  }
  std::vector<bool> outside(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) outside[f] = side[f] == 2;
  return outside;
}

/// Longest edge of a face that is no segment, in spacings of the layer or in the outline's edges there.
double seam_length(const GapPlane& plane, const DelaunayTriangle& face) {
  double scale = 1, longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    scale =
        std::max(scale, plane.longest_edge_at(face.points[i]) / std::numbers::sqrt2);  // it may be a diagonal
    if (!face.is_segment[i])
      longest = std::max(longest, plane.distance(face.points[(i + 1) % 3], face.points[(i + 2) % 3]));
  }
  return longest / scale;
}

/// What is under the middle of a face.
class Ground {
 public:
  Ground(const LayerPart& part, std::uint64_t around, const PostingRuns& with_data,
         const PostingRuns& covered)
      : part_(part), around_(double(around)), with_data_(with_data), covered_(covered) {}

  /// The nearest posting has data.
  bool has_data(PlanePoint p) const { return is_in(with_data_, std::round(p.x), std::round(p.y)); }
  /// One of the postings around is covered.
  bool is_covered(PlanePoint p) const {
    const double c = std::floor(p.x), r = std::floor(p.y);
    return is_in(covered_, c, r) || is_in(covered_, c + 1, r) || is_in(covered_, c, r + 1) ||
           is_in(covered_, c + 1, r + 1);
  }

 private:
  bool is_in(const PostingRuns& runs, double column, double row) const {
    column -= double(part_.column);
    if (around_ != 0) column -= around_ * std::floor(column / around_);
    return column >= 0 && column < double(part_.width) && row >= 0 &&
           runs.contains(static_cast<std::uint64_t>(column), static_cast<std::uint64_t>(row));
  }

  LayerPart part_;
  double around_;
  const PostingRuns &with_data_, &covered_;
};

/// Whether a face in the gap is seam: one that joins both sides if it is short; others where the layer has
/// data that it does not show.
bool is_seam(const GapPlane& plane, const DelaunayTriangle& face, const Ground& ground) {
  const double length = seam_length(plane, face);
  const auto of_layer =
      std::ranges::count_if(face.points, [&](std::uint32_t p) { return plane.is_of_layer(p); });
  if (of_layer != 0 && of_layer != 3 && length <= longest_seam) return true;
  if (length > longest_seam_over_data) return false;
  const PlanePoint middle = plane.middle(face);
  return ground.has_data(middle) && (of_layer != 3 || ground.is_covered(middle));
}

/// Seams, and short faces that are surrounded by them.
std::vector<bool> choose_faces(const GapPlane& plane, const Faces& faces, const Ground& ground) {
  const std::vector<bool> outside = faces_outside(faces, plane.segments());
  std::vector<bool> chosen(faces.size());
  std::vector<std::uint32_t> others;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    if (!outside[f]) continue;
    chosen[f] = is_seam(plane, faces[f], ground);
    if (!chosen[f] && seam_length(plane, faces[f]) <= longest_seam_over_data) others.push_back(f);
  }
  const auto is_solid = [&](std::uint32_t f, std::size_t i) {
    const std::uint32_t beyond = faces[f].across[i];
    return faces[f].is_segment[i] || (beyond != none && chosen[beyond]);
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::uint32_t f : others) {
      if (chosen[f] || !is_solid(f, 0) || !is_solid(f, 1) || !is_solid(f, 2)) continue;
      chosen[f] = changed = true;
    }
  }
  return chosen;
}

LatticeView view_of(const MosaicField& field, const LayerPart& part) {
  const auto around = double(field.layers()[part.layer].columns_around);
  return LatticeView(field.layers(), part.layer,
                     double(part.column) - std::max(0.0, 0.5 * (around - double(part.width))));
}

/// Triangles between the surface so far and the layer, in the order of the triangulation.
std::vector<SeamTriangle> seams_between(GapPlane& plane, const Ground& ground, std::uint64_t& lost_segments) {
  const Triangulation triangulation = triangulate(plane.grid(), plane.segments());
  lost_segments += triangulation.lost_segments;
  const Faces& faces = triangulation.triangles;
  const std::vector<bool> chosen = choose_faces(plane, faces, ground);
  std::vector<SeamTriangle> out;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!chosen[f]) continue;
    const auto& p = faces[f].points;
    out.push_back({plane.posting(p[0]), plane.posting(p[1]), plane.posting(p[2])});
  }
  return out;
}

}  // namespace

Result<MosaicSeams> join_layers(const MosaicField& field) {
  MosaicSeams out;
  Outline surface;
  for (const LayerPart& part : parts_near_others(field.placed(), std::max(2u, field.fill_reach()))) {
    out.covers.push_back({.part = part});
    const LatticeView view = view_of(field, part);
    const std::vector<OutlineEdge> before = surface.edges();
    if (!before.empty()) out.covers.back().covered = covered_postings(before, view, part);
    Outline rest;
    const auto postings = trace(field, part, out.covers.back().covered, rest);
    if (!postings) return fail(postings.error());
    const std::vector<OutlineEdge> edges = rest.edges();
    if (!before.empty() && !(edges.empty() && postings->loose.empty())) {
      GapPlane plane(view, part);
      plane.add(before);
      plane.add(edges);
      plane.add(postings->loose);
      const Ground ground(part, field.layers()[part.layer].columns_around, postings->with_data,
                          out.covers.back().covered);
      const auto seams = seams_between(plane, ground, out.lost_segments);
      for (const SeamTriangle& t : seams) {
        for (std::size_t i = 0; i < 3; ++i) surface.add({t[i], t[(i + 1) % 3]});
      }
      out.seams.insert(out.seams.end(), seams.begin(), seams.end());
    }
    for (const OutlineEdge& edge : edges) surface.add(edge);
  }
  return out;
}

}  // namespace cuesta
