/// quantized-mesh, decoded here by the format's own words and compared with heights.

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "apps/tiles/tile_source.h"
#include "tests/apps/tiles/made_tiles.h"

namespace cuesta {
namespace {

using tiles::TerrainPyramid;
using tiles::TerrainTileId;

test::TestTerrain ridges() {
  test::TestTerrain terrain;
  terrain.box = {6, 46, 7, 47};
  terrain.columns = terrain.rows = 121;
  terrain.height_m = [](LatLon at) {
    const double x = at.lon_deg * 20, y = at.lat_deg * 20;
    return 1000 + 400 * std::sin(x) * std::cos(1.3 * y) + 60 * std::sin(7 * x + 2 * y);
  };
  return terrain;
}

std::string gunzip(std::span<const std::byte> bytes) {
  z_stream z{};
  inflateInit2(&z, 15 + 16);
  std::string out(1 << 24, '\0'), in(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  z.next_in = reinterpret_cast<Bytef*>(in.data());
  z.avail_in = static_cast<uInt>(in.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(inflate(&z, Z_FINISH), Z_STREAM_END);
  out.resize(z.total_out);
  inflateEnd(&z);
  return out;
}

struct Decoded {
  std::vector<int> u, v;
  std::vector<double> h_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::array<std::vector<std::uint32_t>, 4> edges;  // west, south, east, north
  std::array<double, 11> header{};                  // centre, sphere, horizon point
  std::string rest;
};

Decoded decode(const std::string& bytes) {
  Decoded d;
  std::size_t at = 0;
  const auto take = [&]<class T>(T& value) {
    ASSERT_LE(at + sizeof(T), bytes.size());
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    at += sizeof(T);
  };
  float least = 0, most = 0;
  for (std::size_t i = 0; i < 3; ++i) take(d.header[i]);
  take(least);
  take(most);
  for (std::size_t i = 3; i < 10; ++i) take(d.header[i]);
  std::uint32_t vertices = 0, count = 0;
  take(vertices);
  std::vector<int> h;
  for (std::vector<int>* column : {&d.u, &d.v, &h}) {
    int value = 0;
    for (std::uint32_t i = 0; i < vertices; ++i) {
      std::uint16_t code = 0;
      take(code);
      value += (code >> 1) ^ -(code & 1);
      column->push_back(value);
    }
  }
  for (const int step : h)
    d.h_m.push_back(static_cast<double>(least) +
                    (static_cast<double>(most) - static_cast<double>(least)) * step / 32767);
  EXPECT_LE(vertices, 65536u);
  at = (at + 1) / 2 * 2;
  take(count);
  std::uint32_t highest = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<std::uint32_t, 3> t{};
    for (auto& corner : t) {
      std::uint16_t code = 0;
      take(code);
      corner = highest - code;
      if (code == 0) ++highest;
    }
    d.triangles.push_back(t);
  }
  EXPECT_EQ(highest, vertices);
  for (auto& edge : d.edges) {
    take(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      std::uint16_t index = 0;
      take(index);
      edge.push_back(index);
    }
  }
  d.rest = bytes.substr(at);
  return d;
}

/// Height at a point of the tile, linear on its triangles; NaN where there is none.
double height_at(const Decoded& d, double u, double v) {
  for (const auto& t : d.triangles) {
    const double ax = d.u[t[0]], ay = d.v[t[0]], bx = d.u[t[1]] - ax, by = d.v[t[1]] - ay,
                 cx = d.u[t[2]] - ax, cy = d.v[t[2]] - ay, area = bx * cy - cx * by;
    const double s = ((u - ax) * cy - cx * (v - ay)) / area, r = (bx * (v - ay) - (u - ax) * by) / area;
    if (area > 0 && s >= -1e-9 && r >= -1e-9 && s + r <= 1 + 1e-9)
      return d.h_m[t[0]] * (1 - s - r) + d.h_m[t[1]] * s + d.h_m[t[2]] * r;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

class QuantizedMesh : public ::testing::Test {
 protected:
  static constexpr double step_m = 0.25;

  void SetUp() override {
    test::build_terrain(ridges(), Frame::ecef(), folder_ / "globe.cuesta", step_m);
    const auto utm = Frame::projected(*Crs::from_epsg(32632));
    test::build_terrain(ridges(), *utm, folder_ / "utm.cuesta", step_m);
  }
  std::unique_ptr<TerrainPyramid> open(const char* name, double error = 0) const {
    auto pyramid = TerrainPyramid::open(folder_ / name, {error, std::uint64_t{1} << 30});
    EXPECT_TRUE(pyramid) << (pyramid ? "" : pyramid.error().text());
    return std::move(*pyramid);
  }
  static Decoded decoded(TerrainPyramid& pyramid, const TerrainTileId& id) {
    const auto mesh = pyramid.mesh(id);
    EXPECT_TRUE(mesh);
    return decode(gunzip(*TerrainPyramid::encode(*mesh)));
  }

  test::TemporaryFolder folder_;
};

TEST_F(QuantizedMesh, heights_of_the_last_level_are_the_files) {
  const test::TestTerrain terrain = ridges();
  for (const char* name : {"globe.cuesta", "utm.cuesta"}) {
    for (const double error : {0.0, 10.0}) {
      auto pyramid = open(name, error);
      std::size_t compared = 0;
      for (const TerrainTileId& id : pyramid->tiles(pyramid->last_level())) {
        const GeoBox box = TerrainPyramid::box(id);
        const Decoded d = decoded(*pyramid, id);
        for (int row = 1; row < terrain.rows - 1; row += 3)
          for (int column = 1; column < terrain.columns - 1; column += 3) {
            const LatLon at = terrain.place(column, row);
            const double u = (at.lon_deg - box.west_deg) / (box.east_deg - box.west_deg),
                         v = (at.lat_deg - box.south_deg) / (box.north_deg - box.south_deg);
            if (u < 0 || v < 0 || u > 1 || v > 1) continue;
            // The error, the curve of the Earth that stays within it, steps of heights and of places.
            EXPECT_NEAR(height_at(d, u * 32767, v * 32767), terrain.height_m(at), 2 * error + 1.0) << name;
            ++compared;
          }
      }
      EXPECT_GE(compared, 1500u);
    }
  }
}

TEST_F(QuantizedMesh, tiles_cover_their_rectangles_and_lists_of_edges_are_the_edges) {
  auto pyramid = open("globe.cuesta");
  for (std::uint32_t level = 0; level <= pyramid->last_level(); ++level)
    for (const TerrainTileId& id : pyramid->tiles(level)) {
      const Decoded d = decoded(*pyramid, id);
      double area = 0;
      for (const auto& t : d.triangles)
        area += 0.5 * (static_cast<double>(d.u[t[1]] - d.u[t[0]]) * (d.v[t[2]] - d.v[t[0]]) -
                       static_cast<double>(d.u[t[2]] - d.u[t[0]]) * (d.v[t[1]] - d.v[t[0]]));
      EXPECT_NEAR(area / (32767.0 * 32767), 1, 1e-3) << id.z << "/" << id.x << "/" << id.y;
      for (std::size_t e = 0; e < 4; ++e) {
        EXPECT_GE(d.edges[e].size(), 2u);
        for (const std::uint32_t i : d.edges[e]) EXPECT_EQ((e % 2 == 0 ? d.u : d.v)[i], e < 2 ? 0 : 32767);
      }
      ASSERT_GT(d.rest.size(), 5u);
      EXPECT_EQ(d.rest[0], 1);
      EXPECT_EQ(d.rest.size(), 5 + 2 * d.u.size());
    }
}

/// Places along an edge and heights there.
std::map<int, double> edge_of(const Decoded& d, std::size_t edge) {
  std::map<int, double> heights;
  for (const std::uint32_t i : d.edges[edge]) heights[(edge % 2 == 0 ? d.v : d.u)[i]] = d.h_m[i];
  return heights;
}

TEST_F(QuantizedMesh, neighbours_have_the_same_vertices_on_their_border) {
  for (const char* name : {"globe.cuesta", "utm.cuesta"}) {
    auto pyramid = open(name);
    std::size_t compared = 0;
    for (std::uint32_t level = 3; level <= pyramid->last_level(); ++level)
      for (const TerrainTileId& id : pyramid->tiles(level)) {
        const TerrainTileId east{id.z, id.x + 1, id.y}, north{id.z, id.x, id.y + 1};
        const Decoded here = decoded(*pyramid, id);
        for (const auto& [other, mine, theirs] : {std::tuple{east, 2, 0}, std::tuple{north, 3, 1}}) {
          if (!pyramid->has(other)) continue;
          const auto a = edge_of(here, static_cast<std::size_t>(mine)),
                     b = edge_of(decoded(*pyramid, other), static_cast<std::size_t>(theirs));
          ASSERT_EQ(a.size(), b.size()) << name << " " << id.z << "/" << id.x << "/" << id.y;
          for (auto i = a.begin(), k = b.begin(); i != a.end(); ++i, ++k) {
            EXPECT_EQ(i->first, k->first);
            EXPECT_NEAR(i->second, k->second, 0.06);  // half a step of either tile's heights
            ++compared;
          }
        }
      }
    EXPECT_GT(compared, 100u);
  }
}

TEST_F(QuantizedMesh, layer_json_lists_the_tiles_that_are_written) {
  auto pyramid = open("globe.cuesta");
  test::FilesInMemory files, again;
  const auto report = tiles::export_terrain(*pyramid, files, test::go_on);
  ASSERT_TRUE(report);
  ASSERT_TRUE(tiles::export_terrain(*pyramid, again, test::go_on));
  EXPECT_EQ(files.files, again.files);
  const auto live = tiles::open_terrain_source(folder_ / "globe.cuesta", {0, std::uint64_t{1} << 30});
  ASSERT_TRUE(live);
  for (auto it = files.files.rbegin(); it != files.files.rend(); ++it) {
    const auto made = (*live)->make(it->first);
    ASSERT_TRUE(made) << it->first;
    EXPECT_EQ(
        std::string(reinterpret_cast<const char*>(made->front().bytes.data()), made->front().bytes.size()),
        it->second);
  }
  for (const char* name : {"", "0/0/0", "0/00/0.terrain", "00/0/0.terrain", "0/0/1.terrain", "99/0/0.terrain",
                           "4294967296/0/0.terrain", "-1/0/0.terrain", "0/0/0.terrain.gz", "0/0.terrain"})
    EXPECT_EQ((*live)->make(name).error().code, ErrorCode::not_found) << name;
  const auto layer = nlohmann::json::parse(files.files.at("layer.json"));
  std::size_t listed = 0;
  for (std::size_t z = 0; z < layer["available"].size(); ++z)
    for (const auto& run : layer["available"][z])
      for (int x = run["startX"]; x <= run["endX"]; ++x)
        for (int y = run["startY"]; y <= run["endY"]; ++y) {
          ++listed;
          EXPECT_TRUE(files.files.contains(std::to_string(z) + "/" + std::to_string(x) + "/" +
                                           std::to_string(y) + ".terrain"));
        }
  EXPECT_EQ(listed, report->tiles);
  EXPECT_EQ(listed + 1, files.files.size());
  EXPECT_EQ(layer["available"][0][0]["endX"], 1);
}

TEST_F(QuantizedMesh, surfaces_that_are_nowhere_are_refused) {
  test::build_file(test::bumpy_sphere(20, 20), folder_ / "sphere.cuesta");
  EXPECT_EQ(TerrainPyramid::open(folder_ / "sphere.cuesta", {}).error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace cuesta
