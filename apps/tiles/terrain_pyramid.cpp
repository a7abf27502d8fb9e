#include "apps/tiles/terrain_pyramid.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "apps/tiles/globe_borders.h"
#include "apps/tiles/terrain_fill.h"
#include "ooc/oct_normal.h"

namespace cuesta::tiles {
namespace {

using Json = nlohmann::ordered_json;

constexpr double level_0_error_m = 77067.34 / 8;  // CesiumJS's estimate for the level, and an eighth of it
constexpr double degree_m = 111'195;
constexpr double postings_across = 128;
constexpr std::uint32_t most_levels = 22;
constexpr int samples = 8;  // along each side of a tile, to find it in a projection

double tile_degrees(std::uint32_t level) {
  return 180.0 / static_cast<double>(1u << level);
}

struct Corner {
  double lon_deg, lat_deg, h_m;
  Vec3f normal;
};

auto order(const Corner& c) {
  return std::tie(c.lon_deg, c.lat_deg, c.h_m);
}

Vec3f mixed(Vec3f a, Vec3f b, double t) {
  const Vec3f n = a * static_cast<float>(1 - t) + b * static_cast<float>(t);
  return dot(n, n) > 0 ? normalized(n) : a;
}

/// Where the way between two corners meets a meridian (axis 0) or parallel (1); the same from either end.
Corner crossing(const Corner* a, const Corner* b, int axis, double at) {
  if (order(*b) < order(*a)) std::swap(a, b);
  const double from = axis == 0 ? a->lon_deg : a->lat_deg, to = axis == 0 ? b->lon_deg : b->lat_deg;
  const double t = (at - from) / (to - from);
  Corner c{std::lerp(a->lon_deg, b->lon_deg, t), std::lerp(a->lat_deg, b->lat_deg, t),
           std::lerp(a->h_m, b->h_m, t), mixed(a->normal, b->normal, t)};
  (axis == 0 ? c.lon_deg : c.lat_deg) = at;
  return c;
}

/// What of a convex polygon is on one side of a line. sign 1: at least `at`; -1: at most.
void clip(std::vector<Corner>& polygon, int axis, double at, double sign) {
  std::vector<Corner> kept;
  const auto inside = [&](const Corner& c) { return sign * ((axis == 0 ? c.lon_deg : c.lat_deg) - at) >= 0; };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (inside(a)) kept.push_back(a);
    if (inside(a) != inside(b)) kept.push_back(crossing(&a, &b, axis, at));
  }
  polygon = std::move(kept);
}

/// Corners onto the tile's lattice, each place and height once.
class TileCorners {
 public:
  TileCorners(TerrainTileMesh& tile, double border_step_m) : tile_(tile), border_step_m_(border_step_m) {}

  void add(const std::vector<Corner>& polygon) {
    std::vector<std::uint32_t> corners;
    for (const Corner& c : polygon) corners.push_back(vertex(c));
    for (std::size_t i = 2; i < corners.size(); ++i) add({corners[0], corners[i - 1], corners[i]});
  }

 private:
  void add(const std::array<std::uint32_t, 3>& t) {
    const TerrainVertex &a = tile_.vertices[t[0]], &b = tile_.vertices[t[1]], &c = tile_.vertices[t[2]];
    const std::int64_t area = std::int64_t{b.u - a.u} * (c.v - a.v) - std::int64_t{c.u - a.u} * (b.v - a.v);
    if (area > 0) tile_.triangles.push_back(t);
  }

  std::uint32_t vertex(const Corner& c) {
    const GeoBox& b = tile_.box;
    const auto step = [](double at, double lo, double hi) {
      return static_cast<std::int32_t>(std::lround((at - lo) / (hi - lo) * terrain_steps));
    };
    TerrainVertex v{step(c.lon_deg, b.west_deg, b.east_deg), step(c.lat_deg, b.south_deg, b.north_deg), c.h_m,
                    c.normal};
    if (v.u == 0 || v.v == 0 || v.u == terrain_steps || v.v == terrain_steps)
      v.h_m = std::round(v.h_m / border_step_m_) * border_step_m_;
    const auto [at, is_new] =
        numbers_.try_emplace({v.u, v.v}, static_cast<std::uint32_t>(tile_.vertices.size()));
    if (is_new) tile_.vertices.push_back(v);
    return at->second;
  }

  TerrainTileMesh& tile_;
  double border_step_m_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::uint32_t> numbers_;
};

Result<std::vector<std::byte>> gzip(const std::vector<std::byte>& bytes) {
  z_stream z{};
  constexpr int with_gzip_header = 15 + 16;
  if (deflateInit2(&z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, with_gzip_header, 9, Z_DEFAULT_STRATEGY) != Z_OK)
    return fail(ErrorCode::out_of_budget, "", "", "no memory to compress a tile");
  std::vector<std::byte> out(deflateBound(&z, bytes.size()));
  std::vector<std::byte> in = bytes;
  z.next_in = reinterpret_cast<Bytef*>(in.data());  // zlib's own view of bytes
  z.avail_in = static_cast<uInt>(in.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

bool is_placed(const Directory& directory, const std::optional<TerrainFacts>& facts) {
  return facts && facts->bounds && TilePlacement(directory, facts).on_earth();
}

}  // namespace

bool TerrainPyramid::is_possible(const Directory& directory) {
  const auto facts = terrain_facts(directory.metadata);
  return facts && is_placed(directory, *facts);
}

Result<std::unique_ptr<TerrainPyramid>> TerrainPyramid::open(const std::filesystem::path& file,
                                                             const TerrainOptions& options) {
  auto cut = TileCut::open(file, options.cache_bytes);
  if (!cut) return fail(cut.error());
  auto facts = terrain_facts((*cut)->directory().metadata);
  if (!facts) return fail(facts.error().code, file.string(), facts.error().place, facts.error().message);
  if (!is_placed((*cut)->directory(), *facts))
    return fail(ErrorCode::invalid_input, file.string(), "",
                "quantized-mesh needs a terrain whose place on the Earth is known; export it as 3dtiles");
  const GeoBox bounds = *(*facts)->bounds;
  return std::unique_ptr<TerrainPyramid>(
      new TerrainPyramid(std::move(*cut), std::move(**facts), bounds, options));
}

TerrainPyramid::TerrainPyramid(std::unique_ptr<TileCut> cut, TerrainFacts facts, GeoBox bounds,
                               const TerrainOptions& options)
    : cut_(std::move(cut)),
      facts_(std::move(facts)),
      bounds_(bounds),
      options_(options),
      placement_(cut_->directory(), facts_) {
  const double area = (bounds_.east_deg - bounds_.west_deg) * (bounds_.north_deg - bounds_.south_deg);
  const double spacing_deg =
      facts_.spacing_m > 0
          ? facts_.spacing_m / degree_m
          : std::sqrt(area / static_cast<double>(std::max<std::uint64_t>(facts_.postings, 1)));
  while (last_level_ < most_levels && tile_degrees(last_level_) > postings_across * spacing_deg)
    ++last_level_;
  const double range_m = std::max(facts_.most_m - facts_.least_m, 1.0);
  border_step_m_ = std::exp2(std::floor(std::log2(range_m / terrain_steps)));
}

double TerrainPyramid::error_of(std::uint32_t level) const {
  const double error = std::ldexp(level_0_error_m, -static_cast<int>(level));
  return level == last_level_ ? std::min(options_.finest_error, error)
                              : std::max(options_.finest_error, error);
}

GeoBox TerrainPyramid::box(const TerrainTileId& id) {
  const double size = tile_degrees(id.z);
  return {-180 + id.x * size, -90 + id.y * size, -180 + (id.x + 1) * size, -90 + (id.y + 1) * size};
}

/// The first may be followed by others across the antimeridian: modulo the level's.
TerrainPyramid::Columns TerrainPyramid::columns(std::uint32_t level) const {
  const std::uint32_t all = 2u << level;
  if (level == 0) return {0, all};
  const double size = tile_degrees(level);
  const double first = std::floor((bounds_.west_deg + 180) / size),
               end = std::ceil((bounds_.east_deg + 180) / size);
  const double count = std::clamp(end - first, 1.0, static_cast<double>(all));
  return {static_cast<std::uint32_t>(std::fmod(first + 2.0 * all, all)), static_cast<std::uint32_t>(count)};
}

TerrainPyramid::Columns TerrainPyramid::rows(std::uint32_t level) const {
  const double size = tile_degrees(level), all = static_cast<double>(1u << level);
  const double first = std::clamp(std::floor((bounds_.south_deg + 90) / size), 0.0, all - 1);
  const double end = std::clamp(std::ceil((bounds_.north_deg + 90) / size), first + 1, all);
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end - first)};
}

std::vector<TerrainTileId> TerrainPyramid::tiles(std::uint32_t level) const {
  const Columns x = columns(level), y = rows(level);
  std::vector<TerrainTileId> all;
  for (std::uint32_t i = 0; i < x.count; ++i)
    for (std::uint32_t k = 0; k < y.count; ++k)
      all.push_back({level, (x.first + i) % (2u << level), y.first + k});
  return all;
}

bool TerrainPyramid::has(const TerrainTileId& id) const {
  if (id.z > last_level_ || id.x >= 2u << id.z || id.y >= 1u << id.z) return false;
  const Columns x = columns(id.z), y = rows(id.z);
  const std::uint32_t all = 2u << id.z;
  return (id.x + all - x.first) % all < x.count && id.y >= y.first && id.y - y.first < y.count;
}

/// In a projection, a rectangle around the tile.
SurfacePart TerrainPyramid::part(const GeoBox& box) const {
  const Grid& grid = cut_->directory().grid;
  SurfacePart part;
  if (facts_.frame.kind() != FrameKind::projected) {
    if (box.west_deg > -180 || box.east_deg < 180) {
      part.borders.push_back(globe_border(facts_.frame, grid, Side::west, box.west_deg));
      part.borders.push_back(globe_border(facts_.frame, grid, Side::east, box.east_deg));
    }
    if (box.south_deg > -90)
      part.borders.push_back(globe_border(facts_.frame, grid, Side::south, box.south_deg));
    if (box.north_deg < 90)
      part.borders.push_back(globe_border(facts_.frame, grid, Side::north, box.north_deg));
    return part;
  }
  Box3d around;
  for (int i = 0; i <= samples; ++i)
    for (int k = 0; k <= samples; ++k) {
      const Geodetic at{std::lerp(box.south_deg, box.north_deg, i / double{samples}),
                        std::lerp(box.west_deg, box.east_deg, k / double{samples}), 0};
      const Vec3d p = (facts_.frame.position_m(at) - grid.origin) / grid.step;
      if (!std::isfinite(p.x) || !std::isfinite(p.y)) return {};  // beyond the projection: all of the terrain
      around.add(p);
    }
  const Vec3d pad = (around.hi - around.lo) * (1.0 / samples);  // sides bend less than that between samples
  const Vec3d lo = around.lo - pad, hi = around.hi + pad;
  part.borders = {{lo, {1, 0, 0}}, {lo, {0, 1, 0}}, {hi, {-1, 0, 0}}, {hi, {0, -1, 0}}};
  return part;
}

Result<TerrainTileMesh> TerrainPyramid::mesh(const TerrainTileId& id) {
  TerrainTileMesh tile{box(id), {}, {}};
  auto found = cut_->around(part(tile.box), error_of(id.z), 1);
  if (!found) return fail(found.error());
  sort(*found);
  const auto& m = placement_.transform();
  const double middle = (tile.box.west_deg + tile.box.east_deg) / 2;
  std::vector<Corner> corners;
  for (const DrawVertex& v : found->vertices) {
    const Geodetic at = placement_.geodetic({v.x, v.y, v.z});
    const Vec3d n = vec_cast<double>(decode_oct({v.normal_u, v.normal_v}, 16));
    const Vec3d ecef{m[0] * n.x + m[4] * n.y + m[8] * n.z, m[1] * n.x + m[5] * n.y + m[9] * n.z,
                     m[2] * n.x + m[6] * n.y + m[10] * n.z};
    const double lon = at.lon_deg + 360 * std::round((middle - at.lon_deg) / 360);
    const Vec3d up = Frame::ecef().up(Frame::ecef().position_m(Geodetic{at.lat_deg, lon, 0}));
    corners.push_back(
        {lon, at.lat_deg, at.h_m, vec_cast<float>(dot(ecef, ecef) > 0 ? normalized(ecef) : up)});
  }
  TileCorners made(tile, border_step_m_);
  std::vector<Corner> polygon;
  for (const auto& t : found->triangles) {
    polygon = {corners[t[0]], corners[t[1]], corners[t[2]]};
    const auto [low, high] = std::minmax({polygon[0].lon_deg, polygon[1].lon_deg, polygon[2].lon_deg});
    if (high - low > 180) continue;  // on the other side of the globe, where longitudes begin
    clip(polygon, 0, tile.box.west_deg, 1);
    clip(polygon, 0, tile.box.east_deg, -1);
    clip(polygon, 1, tile.box.south_deg, 1);
    clip(polygon, 1, tile.box.north_deg, -1);
    if (polygon.size() > 2) made.add(polygon);
  }
  const Vec3d centre = Frame::ecef().position_m(Geodetic{(tile.box.south_deg + tile.box.north_deg) / 2,
                                                         (tile.box.west_deg + tile.box.east_deg) / 2, 0});
  fill_around(tile, 0, vec_cast<float>(Frame::ecef().up(centre)));
  return tile;
}

Result<std::vector<std::byte>> TerrainPyramid::encode(const TerrainTileMesh& tile) {
  return gzip(encode_quantized_mesh(tile));
}

std::string TerrainPyramid::layer_json() const {
  Json available = Json::array();
  for (std::uint32_t z = 0; z <= last_level_; ++z) {
    const Columns x = columns(z), y = rows(z);
    const std::uint32_t all = 2u << z, first_run = std::min(x.count, all - x.first);
    Json rows_json = Json::array();
    const auto add = [&](std::uint32_t first, std::uint32_t count) {
      if (count > 0)
        rows_json.push_back({{"startX", first},
                             {"startY", y.first},
                             {"endX", first + count - 1},
                             {"endY", y.first + y.count - 1}});
    };
    add(x.first, first_run);
    add(0, x.count - first_run);
    available.push_back(std::move(rows_json));
  }
  Json json{{"tilejson", "2.1.0"},
            {"name", "cuesta"},
            {"version", "1.0.0"},
            {"format", "quantized-mesh-1.0"},
            {"scheme", "tms"},
            {"projection", "EPSG:4326"},
            {"tiles", {"{z}/{x}/{y}.terrain"}},
            {"extensions", {"octvertexnormals"}},
            {"bounds", {-180, -90, 180, 90}},
            {"minzoom", 0},
            {"maxzoom", last_level_},
            {"available", std::move(available)}};
  return json.dump() + "\n";
}

}  // namespace cuesta::tiles
