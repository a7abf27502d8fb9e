#include "terrain/terrain_chunk.h"

#include <algorithm>

#include "ooc/oct_normal.h"

namespace cuesta {
namespace {

/// Of the triangles that LatticePatch makes around a posting, weighted by area; up where there are none.
Vec3f normal_at(const PostingWindow& window, std::int64_t x, std::int64_t y, Vec3d up) {
  struct Offset {
    std::int64_t x, y;
  };
  constexpr Offset east{1, 0}, north{0, -1}, west{-1, 0}, south{0, 1};
  constexpr std::array<std::array<Offset, 3>, 4> quarters{
      {{east, {1, -1}, north}, {north, {-1, -1}, west}, {west, {-1, 1}, south}, {south, {1, 1}, east}}};
  const Vec3d centre = window.positions_m[window.index(x, y)];
  Vec3d sum;
  for (std::size_t q = 0; q < quarters.size(); ++q) {
    std::array<std::size_t, 3> at{};
    for (std::size_t k = 0; k < 3; ++k) at[k] = window.index(x + quarters[q][k].x, y + quarters[q][k].y);
    // Diagonals run from the north-east to the south-west.
    const bool diagonal_here = q % 2 == 0 || !window.has_height[at[0]] || !window.has_height[at[2]];
    const Vec3d* before = nullptr;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!window.has_height[at[k]] || (k == 1 && !diagonal_here)) continue;
      const Vec3d& next = window.positions_m[at[k]];
      if (before) sum = sum + cross(*before - centre, next - centre);
      before = &next;
    }
  }
  return vec_cast<float>(normalized(dot(sum, sum) > 0 ? sum : up));
}

}  // namespace

Result<PostingWindow> read_postings(const PostingStore& store, const PostingPositions& positions,
                                    const LatticeSquare& square) {
  PostingWindow w;
  w.square = square;
  w.width = std::uint64_t{square.width} + 3;
  w.height = std::uint64_t{square.height} + 3;
  const auto column = static_cast<std::int64_t>(square.column) - 1,
             row = static_cast<std::int64_t>(square.row) - 1;
  const std::size_t count = w.width * w.height;
  w.heights_m.resize(count);
  if (auto r = store.read(square.layer, column, row, w.width, w.height, w.heights_m); !r)
    return fail(r.error());
  w.positions_m.resize(count);
  positions.of(column, row, w.width, w.height, w.heights_m, w.positions_m);
  w.has_height.resize(count);
  for (std::size_t i = 0; i < count; ++i) w.has_height[i] = is_finite(w.positions_m[i]);
  return w;
}

TerrainChunk::TerrainChunk(const TerrainSurface& surface, std::uint32_t chunk)
    : surface_(surface), chunk_(chunk), seams_(surface.seams_of(chunk)) {}

Result<void> TerrainChunk::read() {
  const LatticeSquare square = surface_.store_.squares().square(surface_.store_.square_of(chunk_));
  auto window = read_postings(surface_.store_, surface_.positions_[square.layer], square);
  if (!window) return fail(window.error());
  window_ = std::move(*window);
  return {};
}

PostingRef TerrainChunk::place(const LatticePatch::Corner& corner) const {
  const LatticeSquare& s = window_.square;
  return surface_.place(s.layer, static_cast<std::int64_t>(s.column + corner.x),
                        static_cast<std::int64_t>(s.row + corner.y));
}

TerrainChunk::Key TerrainChunk::key_of(const LatticePatch::Corner& corner) const {
  return (corner.y * (window_.square.width + 1) + corner.x) * LatticePatch::most_fans + corner.fan;
}

LatticePatch TerrainChunk::patch() const {
  const LatticeSquare& s = window_.square;
  return LatticePatch(s.width, s.height, window_.has_height,
                      surface_.pole_rows(s.layer, static_cast<std::int64_t>(s.row)));
}

void TerrainChunk::collect(const LatticePatch& patch) {
  const LatticeSquare& s = window_.square;
  const SeamFans& seam_fans = surface_.seam_fans_;
  triangles_.clear();
  triangles_.reserve(std::size_t{2} * s.width * s.height);
  patch.for_triangles([&](std::array<LatticePatch::Corner, 3> corners) {
    for (LatticePatch::Corner& c : corners)
      if (surface_.is_pole(s.layer, s.row + c.y))
        c.fan = 0;
      else if (c.fan > 0 && seam_fans.contains(place(c)))
        c.fan = seam_fans.of_cells(place(c), c.fan);
    triangles_.push_back(corners);
  });
}

std::vector<TerrainChunk::Vertex> TerrainChunk::vertices() const {
  const LatticeSquare& s = window_.square;
  std::vector<std::uint8_t> used(std::size_t{s.width + 1} * (s.height + 1) * LatticePatch::most_fans, 0);
  for (const auto& t : triangles_)
    for (const LatticePatch::Corner& c : t) used[key_of(c)] = 1;
  std::vector<Vertex> own, others;  // by id; to be sorted
  own.reserve(std::size_t{s.width} * s.height);
  for (std::uint32_t y = 0; y <= s.height; ++y)
    for (std::uint32_t x = 0; x <= s.width; ++x)
      for (std::uint32_t fan = 0; fan < LatticePatch::most_fans; ++fan) {
        const LatticePatch::Corner c{x, y, fan};
        if (!used[key_of(c)]) continue;
        const Vertex v{surface_.id_of(place(c), fan), c, nullptr};
        const bool in_order = own.empty() || own.back().id < v.id;
        (in_order && fan == 0 && x < s.width && y < s.height ? own : others).push_back(v);
      }
  for (const SeamTriangle& t : seams_)
    for (std::size_t k = 0; k < 3; ++k)
      others.push_back({surface_.id_of(t[k], surface_.seam_vertex_fan(t, k)), {}, &t[k]});
  const auto by_id = [](const Vertex& a, const Vertex& b) { return a.id < b.id; };
  std::stable_sort(others.begin(), others.end(), by_id);
  std::vector<Vertex> all(own.size() + others.size());
  std::merge(own.begin(), own.end(), others.begin(), others.end(), all.begin(), by_id);
  all.erase(
      std::unique(all.begin(), all.end(), [](const Vertex& a, const Vertex& b) { return a.id == b.id; }),
      all.end());
  return all;
}

/// Postings at the square's northern and western edges are corners of other squares' cells.
bool TerrainChunk::is_locked(const Vertex& v) const {
  const LatticeSquare& s = window_.square;
  if (v.elsewhere || v.at.x == 0 || v.at.y == 0 || v.at.x == s.width || v.at.y == s.height) return true;
  const PostingRef at = place(v.at);
  return surface_.is_pole(at.layer, at.row) || surface_.seam_fans_.contains(at);
}

Result<void> TerrainChunk::add(const Vertex& v, SurfaceChunk& out) const {
  const PostingWindow* window = &window_;
  Result<PostingWindow> around;
  std::int64_t x = v.at.x, y = v.at.y;
  if (v.elsewhere) {
    const PostingRef& p = *v.elsewhere;
    around = read_postings(surface_.store_, surface_.positions_[p.layer], {p.layer, p.column, p.row, 1, 1});
    if (!around) return fail(around.error());
    window = &*around;
    x = y = 0;
  }
  const Vec3i position = surface_.grid.snap(window->positions_m[window->index(x, y)]);
  out.ids.push_back(v.id);
  out.locked.push_back(is_locked(v));
  out.vertices.positions.push_back(position);
  if (surface_.attributes.normals) {
    const PostingRef at = v.elsewhere ? *v.elsewhere : place(v.at);
    const Vec3d up = surface_.vertical->direction(vec_cast<double>(position));
    const Vec3f normal =
        surface_.is_pole(at.layer, at.row) ? vec_cast<float>(up) : normal_at(*window, x, y, up);
    out.vertices.normals.push_back(encode_oct(normal, normal_bits));
  }
  return {};
}

Result<void> TerrainChunk::add_colours(std::span<const Vertex> all, SurfaceChunk& out) const {
  std::vector<LatLon> places;
  places.reserve(all.size());
  for (const Vertex& v : all) {
    const PostingRef at = v.elsewhere ? *v.elsewhere : place(v.at);
    const MosaicLayer& layer = surface_.layers_[at.layer];
    const double column = static_cast<double>(at.column), row = static_cast<double>(at.row);
    places.push_back(layer.crs.lat_lon({layer.map.x(column, row), layer.map.y(column, row)}));
  }
  out.vertices.colours.resize(all.size());
  return surface_.options_.drape->sample(places, out.vertices.colours);
}

Result<SurfaceChunk> TerrainChunk::make() {
  if (auto r = read(); !r) return fail(r.error());
  collect(patch());
  const auto all = vertices();
  SurfaceChunk out;
  out.ids.reserve(all.size());
  out.locked.reserve(all.size());
  out.vertices.reserve(all.size(), surface_.attributes);
  for (const Vertex& v : all)
    if (auto r = add(v, out); !r) return fail(r.error());
  if (surface_.attributes.colours)
    if (auto r = add_colours(all, out); !r) return fail(r.error());
  out.wedge.assign(all.size(), 0);
  const std::uint64_t side = surface_.store_.squares().side();
  out.first_free = vertex_id(chunk_, static_cast<std::uint32_t>(LatticePatch::most_fans * side * side));

  const auto number_of = [&](VertexId id) {
    return static_cast<std::uint32_t>(std::lower_bound(out.ids.begin(), out.ids.end(), id) - out.ids.begin());
  };
  std::vector<std::uint32_t> number(std::size_t{window_.square.width + 1} * (window_.square.height + 1) *
                                    LatticePatch::most_fans);
  for (std::uint32_t i = 0; i < all.size(); ++i)
    if (!all[i].elsewhere) number[key_of(all[i].at)] = i + 1;
  const auto corner_number = [&](const LatticePatch::Corner& c) {
    const std::uint32_t known = number[key_of(c)];  // 0: a pole, under another corner's name
    return known > 0 ? known - 1 : number_of(surface_.id_of(place(c), c.fan));
  };
  out.triangles.reserve(triangles_.size() + seams_.size());
  for (const auto& t : triangles_)
    out.triangles.push_back({corner_number(t[0]), corner_number(t[1]), corner_number(t[2])});
  for (const SeamTriangle& t : seams_) {
    Triangle corners{};
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = number_of(surface_.id_of(t[k], surface_.seam_vertex_fan(t, k)));
    out.triangles.push_back(corners);
  }
  return out;
}

Result<TerrainChunk::Facts> TerrainChunk::facts() {
  if (auto r = read(); !r) return fail(r.error());
  const LatticePatch lattice = patch();
  collect(lattice);
  Facts facts;
  facts.triangles = triangles_.size() + seams_.size();
  const LatticeSquare& s = window_.square;
  for (std::uint32_t y = 0; y < s.height; ++y)
    for (std::uint32_t x = 0; x < s.width; ++x) {
      const std::size_t i = window_.index(x, y);
      if (!window_.has_height[i]) continue;
      const PostingRef at{s.layer, s.column + x, s.row + y};
      std::uint32_t fans = 0;
      if (surface_.is_pole(s.layer, at.row))
        fans = surface_.is_pole_vertex(at) ? 1 : 0;
      else
        fans = surface_.seam_fans_.contains(at) ? surface_.seam_fans_.count(at) : lattice.fans(x, y);
      facts.vertices += fans;
      if (fans > 0) facts.box_m.add(window_.positions_m[i]);
    }
  return facts;
}

}  // namespace cuesta
