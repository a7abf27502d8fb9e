#pragma once
/// Small terrains made for one test: a grid of postings with a known height, in any frame.

#include <functional>
#include <nlohmann/json.hpp>

#include "terrain/terrain_metadata.h"
#include "tests/hierarchy/built_file.h"

namespace cuesta::test {

/// Postings from north to south and west to east, both ends included.
struct TestTerrain {
  GeoBox box{7, 46, 7.1, 46.05};
  int columns = 61, rows = 41;
  std::function<double(LatLon)> height_m = [](LatLon) { return 0.0; };  ///< NaN: no data

  LatLon place(int column, int row) const {
    return {box.north_deg - (box.north_deg - box.south_deg) * row / (rows - 1),
            box.west_deg + (box.east_deg - box.west_deg) * column / (columns - 1)};
  }
};

/// Counter-clockwise from above. Quads with a corner without data are left out.
inline SurfaceMesh surface_of(const TestTerrain& terrain, const Frame& frame) {
  SurfaceMesh mesh;
  std::vector<std::uint8_t> there;
  for (int row = 0; row < terrain.rows; ++row) {
    for (int column = 0; column < terrain.columns; ++column) {
      const LatLon at = terrain.place(column, row);
      const double h_m = terrain.height_m(at);
      there.push_back(!std::isnan(h_m));
      mesh.positions.push_back(frame.position_m(Geodetic{at.lat_deg, at.lon_deg, std::isnan(h_m) ? 0 : h_m}));
    }
  }
  for (int row = 0; row + 1 < terrain.rows; ++row) {
    for (int column = 0; column + 1 < terrain.columns; ++column) {
      const auto a = static_cast<std::uint32_t>(row * terrain.columns + column), b = a + 1,
                 c = a + static_cast<std::uint32_t>(terrain.columns), d = c + 1;
      if (!(there[a] && there[b] && there[c] && there[d])) continue;
      mesh.triangles.push_back({a, c, d});
      mesh.triangles.push_back({a, d, b});
    }
  }
  return mesh;
}

inline TerrainFacts facts_of(const TestTerrain& terrain, const Frame& frame) {
  TerrainFacts facts;
  facts.frame = frame;
  facts.heights = VerticalDatum::ellipsoidal;
  facts.geoid = "egm96-15";
  facts.bounds = terrain.box;
  facts.least_m = 1e9;
  facts.most_m = -1e9;
  for (int row = 0; row < terrain.rows; ++row)
    for (int column = 0; column < terrain.columns; ++column) {
      const double h_m = terrain.height_m(terrain.place(column, row));
      if (std::isnan(h_m)) continue;
      facts.least_m = std::min(facts.least_m, h_m);
      facts.most_m = std::max(facts.most_m, h_m);
      ++facts.postings;
    }
  return facts;
}

/// @param step_m  of the grid; 0 chooses what a mesh gets
inline void build_terrain(const TestTerrain& terrain, const Frame& frame, const std::filesystem::path& path,
                          double step_m = 0) {
  BuildOptions options = small_cells();
  nlohmann::ordered_json metadata;
  metadata["terrain"] = nlohmann::ordered_json::parse(terrain_json(facts_of(terrain, frame)));
  options.metadata = metadata.dump();
  BuildWith with;
  with.step = step_m;
  build_file(surface_of(terrain, frame), path, options, with);
}

/// Hills of 150 m on a slope, around 1000 m, with a hole of no data in the middle.
inline TestTerrain hills() {
  TestTerrain terrain;
  terrain.height_m = [](LatLon at) {
    const double x = (at.lon_deg - 7) * 10, y = (at.lat_deg - 46) * 20;
    if (std::hypot(x - 0.5, y - 0.5) < 0.08) return std::numeric_limits<double>::quiet_NaN();
    return 1000 + 300 * y + 150 * std::sin(9 * x) * std::cos(7 * y);
  };
  return terrain;
}

}  // namespace cuesta::test
