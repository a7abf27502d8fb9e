#pragma once
/// All tiles of a small file, in memory, with what tests want to know of them.

#include <map>

#include "apps/measure/triangle_tree.h"
#include "apps/tiles/export_tiles.h"
#include "tests/apps/bumpy_sphere.h"
#include "tests/apps/terrain_file.h"
#include "tests/hierarchy/built_file.h"

namespace cuesta::test {

struct MadeTile {
  tiles::TileFacts facts;
  SurfacePart part;
  std::vector<Vec3d> points;  ///< grid units
  std::vector<std::array<std::uint32_t, 3>> triangles;

  measure::TriangleTree tree() const { return {points, triangles}; }
  bool holds(Vec3d p) const {
    return std::all_of(part.borders.begin(), part.borders.end(),
                       [&](const PartBorder& b) { return b.distance(p) >= 0; });
  }
};

inline Vec3d grid_point(const DrawVertex& v) {
  return vec_cast<double>(Vec3i{v.x, v.y, v.z});
}

inline MadeTile made(const tiles::TileProducer& producer, const tiles::TileProducer::Fitted& tile) {
  MadeTile made{tile.facts, producer.tree().part(*producer.tree().range(tile.facts.tile.path)), {}, {}};
  for (const DrawVertex& v : tile.mesh.vertices) made.points.push_back(grid_point(v));
  made.triangles = tile.mesh.triangles;
  return made;
}

/// Parents before children.
inline std::vector<MadeTile> all_tiles(tiles::TileProducer& producer) {
  std::vector<MadeTile> all;
  auto root = producer.root();
  EXPECT_TRUE(root && *root);
  if (!root || !*root) return all;
  all.push_back(made(producer, **root));
  for (std::size_t i = 0; i < all.size(); ++i)
    for (const char digit : producer.digits(all[i].facts.tile)) {
      const tiles::Tile parent = all[i].facts.tile;
      auto below = producer.child(parent, digit);
      EXPECT_TRUE(below) << (below ? "" : below.error().text());
      if (below && *below) all.push_back(made(producer, **below));
    }
  return all;
}

inline std::unique_ptr<tiles::TileProducer> open_tiles(const std::filesystem::path& path,
                                                       const tiles::TileOptions& options) {
  auto producer = tiles::TileProducer::open(path, options);
  EXPECT_TRUE(producer) << (producer ? "" : producer.error().text());
  return producer ? std::move(*producer) : nullptr;
}

/// Files of an export, by name.
class FilesInMemory : public tiles::TileFiles {
 public:
  std::map<std::string, std::string> files;
  bool finished = false;
  Result<void> add(const std::string& name, std::span<const std::byte> bytes) override {
    EXPECT_TRUE(files.try_emplace(name, reinterpret_cast<const char*>(bytes.data()), bytes.size()).second)
        << name;
    return {};
  }
  Result<void> finish() override {
    finished = true;
    return {};
  }
};

inline Result<void> go_on(const tiles::TilesReport&) {
  return {};
}

}  // namespace cuesta::test
