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
constexpr double grid_steps = 0x1p52;  // of the plane's extent: what positions are rounded to

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

  std::span<const std::array<std::uint32_t, 2>> segments() const { return segments_; }
  const PostingRef& posting(std::uint32_t i) const { return postings_[i]; }
  /// In columns and rows of the layer.
  PlanePoint place(std::uint32_t i) const { return places_[i]; }
  bool is_of_layer(std::uint32_t i) const { return postings_[i].layer == part_.layer; }
  double longest_edge_at(std::uint32_t i) const { return longest_[i]; }
  double distance(std::uint32_t i, std::uint32_t j) const {
    const PlanePoint a = places_[i], b = view_.near(places_[j], a);
    return std::hypot(b.x - a.x, b.y - a.y);
  }
  /// In columns and rows of the layer; the columns are some turn's.
  PlanePoint middle(const DelaunayTriangle& face) const {
    const PlanePoint a = places_[face.points[0]], b = view_.near(places_[face.points[1]], a),
                     c = view_.near(places_[face.points[2]], a);
    return {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3};
  }
  /// Where the points are triangulated, with y to the north, seen from above.
  std::vector<GridPoint> grid() const;

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
};

/// Rows from the pole and the angle of longitude: the plane of a layer that goes around the Earth.
PlanePoint GapPlane::around_pole(PlanePoint p, bool is_north) const {
  const MosaicLayer& layer = view_.layer();
  const double pole = (is_north ? 90 : -90) / layer.crs.definition().unit;
  const double rows = std::abs(p.y - (pole - layer.map.y0) / layer.map.y_per_row);
  const double angle = 2 * std::numbers::pi * p.x / double(layer.columns_around);
  return {rows * std::cos(angle), (is_north ? 1 : -1) * rows * std::sin(angle)};
}

std::vector<GridPoint> GapPlane::grid() const {
  std::vector<PlanePoint> plane;
  bool is_north = true;
  if (part_.is_closed) {
    // Seen from the pole that is farther from some point is well: its opposite is a circle there.
    const auto least_rows = [&](bool north) {
      double least = HUGE_VAL;
      for (const PlanePoint p : places_) {
        const PlanePoint q = around_pole(p, north);
        least = std::min(least, std::hypot(q.x, q.y));
      }
      return least;
    };
    is_north = least_rows(false) >= least_rows(true);
  }
  double extent = 1;
  for (const PlanePoint p : places_) {
    plane.push_back(part_.is_closed ? around_pole(p, is_north)
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

bool has_data_at(const LayerPart& part, std::uint64_t around, const PostingRuns& with_data, PlanePoint p) {
  double column = std::round(p.x) - double(part.column);
  if (around != 0) column -= double(around) * std::floor(column / double(around));
  const double row = std::round(p.y);
  if (column < 0 || column >= double(part.width) || row < 0) return false;
  return with_data.contains(static_cast<std::uint64_t>(column), static_cast<std::uint64_t>(row));
}

/// Faces of the gap: short, and between the two sides or over data of the layer; and such short ones as are
/// surrounded by what is kept.
std::vector<bool> choose_faces(const GapPlane& plane, const Faces& faces, const LayerPart& part,
                               std::uint64_t around, const PostingRuns& with_data) {
  const std::vector<bool> outside = faces_outside(faces, plane.segments());
  std::vector<bool> chosen(faces.size());
  std::vector<std::uint32_t> others;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    if (!outside[f]) continue;
    const double length = seam_length(plane, faces[f]);
    if (length > longest_seam_over_data) continue;
    const auto of_layer =
        std::ranges::count_if(faces[f].points, [&](std::uint32_t p) { return plane.is_of_layer(p); });
    const bool joins = of_layer != 0 && of_layer != 3 && length <= longest_seam;
    if (joins || has_data_at(part, around, with_data, plane.middle(faces[f])))
      chosen[f] = true;
    else
      others.push_back(f);
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
std::vector<SeamTriangle> seams_between(const GapPlane& plane, const LayerPart& part, std::uint64_t around,
                                        const PostingRuns& with_data, std::uint64_t& lost_segments) {
  const Triangulation triangulation = triangulate(plane.grid(), plane.segments());
  lost_segments += triangulation.lost_segments;
  const Faces& faces = triangulation.triangles;
  const std::vector<bool> chosen = choose_faces(plane, faces, part, around, with_data);
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
  for (const LayerPart& part : parts_near_others(field.layers())) {
    out.covers.push_back({.part = part});
    if (part.width == 0 || part.height == 0) continue;
    const std::uint64_t around = field.layers()[part.layer].columns_around;
    const LatticeView view = view_of(field, part);
    const std::vector<OutlineEdge> before = surface.edges();
    if (!before.empty()) out.covers.back().covered = covered_postings(before, view, part);
    Outline rest;
    const auto postings = trace(field, part, out.covers.back().covered, rest);
    if (!postings) return fail(postings.error());
    const std::vector<OutlineEdge> edges = rest.edges();
    if (!before.empty() && !edges.empty()) {
      GapPlane plane(view, part);
      plane.add(before);
      plane.add(edges);
      const auto seams = seams_between(plane, part, around, postings->with_data, out.lost_segments);
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
