/// What 3D Tiles promise: errors, borders, volumes, contents everywhere, the same bytes.

#include <gtest/gtest.h>
#include <zip.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/tiles/tile_source.h"
#include "ooc/mesh_reader.h"
#include "tests/apps/tiles/made_tiles.h"

namespace cuesta {
namespace {

using tiles::TileOptions;
using tiles::TileProducer;

constexpr double share = 0.25;

/// Hills from the globe, in ECEF.
test::TestTerrain wide_hills() {
  test::TestTerrain terrain;
  terrain.box = {6, 46, 7, 47};
  terrain.columns = terrain.rows = 121;
  terrain.height_m = [](LatLon at) {
    const double x = at.lon_deg * 20, y = at.lat_deg * 20;
    return 1000 + 400 * std::sin(x) * std::cos(1.3 * y) + 60 * std::sin(7 * x + 2 * y) +
           9 * std::sin(41 * x) * std::sin(37 * y);
  };
  return terrain;
}

class Tiles3d : public ::testing::Test {
 protected:
  void SetUp() override {
    test::build_file(test::bumpy_sphere(110, 140), folder_ / "sphere.cuesta");
    test::build_terrain(wide_hills(), Frame::ecef(), folder_ / "hills.cuesta");
  }
  std::vector<std::filesystem::path> files() const {
    return {folder_ / "sphere.cuesta", folder_ / "hills.cuesta"};
  }
  static TileOptions options() { return {1500, share, std::uint64_t{1} << 30}; }

  test::TemporaryFolder folder_;
};

/// In the file's grid units.
std::vector<Vec3d> original_vertices(const std::filesystem::path& path) {
  tiles::TileOptions all{1u << 30, 1, std::uint64_t{1} << 30};
  auto producer = test::open_tiles(path, all);
  auto root = producer->root();
  EXPECT_EQ((*root)->facts.tile.rung, 0);
  std::vector<Vec3d> points;
  for (const DrawVertex& v : (*root)->mesh.vertices) points.push_back(test::grid_point(v));
  return points;
}

TEST_F(Tiles3d, every_tile_has_a_content_no_larger_than_asked_for) {
  for (const auto& file : files()) {
    auto producer = test::open_tiles(file, options());
    const auto all = test::all_tiles(*producer);
    ASSERT_GT(all.size(), 15u);
    for (const auto& tile : all) {
      EXPECT_GT(tile.facts.triangles, 0u) << tile.facts.tile.id();
      EXPECT_LE(tile.facts.triangles, options().triangles) << tile.facts.tile.id();
    }
    EXPECT_GT(all.front().facts.triangles, options().triangles / 4) << "a root that is empty, or nearly";
  }
}

TEST_F(Tiles3d, geometric_errors_bound_the_distance_of_the_files_vertices) {
  for (const auto& file : files()) {
    const auto vertices = original_vertices(file);
    auto producer = test::open_tiles(file, options());
    const double step = producer->directory().grid.step;
    double tightest = 0;
    for (const auto& tile : test::all_tiles(*producer)) {
      const auto tree = tile.tree();
      double worst = 0;
      for (const Vec3d& p : vertices)
        if (tile.holds(p)) worst = std::max(worst, tree.nearest(p).distance_sq);
      EXPECT_LE(std::sqrt(worst) * step, tile.facts.geometric_error) << tile.facts.tile.id();
      tightest = std::max(tightest, std::sqrt(worst) * step / tile.facts.geometric_error);
    }
    EXPECT_GT(tightest, 0.3) << "errors that bound anything bound nothing";
  }
}

TEST_F(Tiles3d, errors_do_not_grow_downwards_and_leaves_are_the_original) {
  for (const auto& file : files()) {
    auto producer = test::open_tiles(file, options());
    std::map<std::string, double> errors;
    for (const auto& tile : test::all_tiles(*producer)) {
      const std::string& path = tile.facts.tile.path;
      errors[path] = tile.facts.geometric_error;
      if (!path.empty()) {
        EXPECT_LE(tile.facts.geometric_error, errors.at(path.substr(0, path.size() - 1)));
      }
      EXPECT_EQ(tile.facts.leaf, tile.facts.tile.rung == 0);
    }
  }
}

/// Whether one path is the other's ancestor, or it itself: a client never draws both.
bool in_line(const std::string& a, const std::string& b) {
  return a.compare(0, std::min(a.size(), b.size()), b, 0, std::min(a.size(), b.size())) == 0;
}

/// The largest distance from what a tile has beyond one of its borders, over `other`, to the content of
/// `other`.
double worst_step(const test::MadeTile& tile, const test::MadeTile& other,
                  const measure::TriangleTree& other_tree) {
  double worst = 0;
  for (const Vec3d& p : tile.points)
    if (other.holds(p)) worst = std::max(worst, other_tree.nearest(p).distance_sq);
  return std::sqrt(worst);
}

TEST_F(Tiles3d, any_levels_meet_at_borders_within_the_stated_bound) {
  for (const auto& file : files()) {
    auto producer = test::open_tiles(file, options());
    const auto all = test::all_tiles(*producer);
    const double step = producer->directory().grid.step;
    std::size_t pairs = 0, mixed = 0, beyond = 0;
    std::vector<measure::TriangleTree> trees;
    for (const auto& tile : all) trees.push_back(tile.tree());
    for (std::size_t a = 0; a < all.size(); ++a)
      for (std::size_t b = 0; b < all.size(); ++b) {
        if (in_line(all[a].facts.tile.path, all[b].facts.tile.path)) continue;
        const double gap = worst_step(all[a], all[b], trees[b]) * step;
        const double bound = share * (all[a].facts.geometric_error + all[b].facts.geometric_error) + 2 * step;
        // The bound is one of the file's vertices; between them a coarse surface may be farther away.
        EXPECT_LE(gap, 2 * bound) << all[a].facts.tile.id() << " beside " << all[b].facts.tile.id();
        pairs += gap > 0;
        mixed += gap > 0 && all[a].facts.tile.rung != all[b].facts.tile.rung;
        beyond += gap > bound;
      }
    EXPECT_GT(pairs, 100u);
    EXPECT_GT(mixed, 50u);
    EXPECT_LE(beyond * 50, pairs);
  }
}

TEST_F(Tiles3d, neighbours_of_one_error_agree_on_the_border) {
  for (const auto& file : files()) {
    auto producer = test::open_tiles(file, options());
    const auto all = test::all_tiles(*producer);
    std::size_t pairs = 0;
    for (const auto& a : all) {
      const auto tree = a.tree();
      for (const auto& b : all) {
        if (a.facts.tile.rung != b.facts.tile.rung || in_line(a.facts.tile.path, b.facts.tile.path)) continue;
        const double gap = worst_step(b, a, tree);
        EXPECT_LE(gap, 2) << a.facts.tile.id() << " beside " << b.facts.tile.id();  // steps: cuts are rounded
        pairs += gap > 0;
      }
    }
    EXPECT_GT(pairs, 10u);
  }
}

TEST_F(Tiles3d, tiles_overlap_so_that_no_vertex_is_lost_between_them) {
  for (const auto& file : files()) {
    const auto vertices = original_vertices(file);
    auto producer = test::open_tiles(file, options());
    std::vector<test::MadeTile> leaves;
    for (auto& tile : test::all_tiles(*producer))
      if (tile.facts.leaf) leaves.push_back(std::move(tile));
    std::vector<measure::TriangleTree> trees;
    for (const auto& tile : leaves) trees.push_back(tile.tree());
    for (const Vec3d& p : vertices) {
      double nearest = 1e30;
      for (std::size_t i = 0; i < leaves.size() && nearest > 0; ++i)
        if (leaves[i].holds(p)) nearest = std::min(nearest, trees[i].nearest(p).distance_sq);
      EXPECT_LE(nearest, 1e-6);
    }
  }
}

TEST_F(Tiles3d, same_bytes_however_tiles_are_asked_for) {
  for (const auto& file : files()) {
    test::FilesInMemory first, second;
    auto producer = test::open_tiles(file, options());
    ASSERT_TRUE(tiles::export_tiles(*producer, first, test::go_on));
    TileOptions small_cache = options();
    small_cache.cache_bytes = 4u << 20;
    auto again = test::open_tiles(file, small_cache);
    ASSERT_TRUE(tiles::export_tiles(*again, second, test::go_on));
    EXPECT_TRUE(first.finished);
    EXPECT_EQ(first.files, second.files);
    // One at a time, by name, the last one first; what comes with it is the same, too.
    auto live = tiles::open_tile_source(file, options(), std::make_shared<tiles::KnownTiles>());
    ASSERT_TRUE(live);
    for (auto it = first.files.rbegin(); it != first.files.rend(); ++it) {
      const auto made = (*live)->make(it->first);
      ASSERT_TRUE(made) << it->first << ": " << made.error().text();
      EXPECT_EQ(made->front().name, it->first);
      for (const tiles::TileFile& f : *made) {
        ASSERT_TRUE(first.files.contains(f.name)) << f.name;
        const auto expected = std::as_bytes(std::span(first.files.at(f.name)));
        EXPECT_TRUE(std::equal(f.bytes.begin(), f.bytes.end(), expected.begin(), expected.end())) << f.name;
      }
    }
  }
}

TEST_F(Tiles3d, names_that_are_no_tiles_are_not_found) {
  auto producer = test::open_tiles(folder_ / "sphere.cuesta", options());
  const auto root = producer->root();
  ASSERT_TRUE(root && *root);
  const std::string good = (*root)->facts.tile.id();
  EXPECT_TRUE(producer->find(good));
  for (const std::string& id :
       {std::string(), std::string("t"), std::string("-"), std::string("t-"), std::string("t-0"),
        "t-0" + good.substr(2), good + " ", "x" + good, std::string("t9-0"), std::string("t8-3"),
        std::string("t-99999999999999999999"), std::string("t--1"), "t" + std::string(100000, '0') + "-0",
        std::string("t../../etc/passwd-0")})
    EXPECT_EQ(producer->find(id).error().code, ErrorCode::not_found) << id.substr(0, 40);
  auto live =
      tiles::open_tile_source(folder_ / "sphere.cuesta", options(), std::make_shared<tiles::KnownTiles>());
  ASSERT_TRUE(live);
  for (const std::string& name : {std::string(), std::string("tileset"), good, good + ".json", good + ".glb2",
                                  std::string(".json"), std::string("layer.json"), std::string("t9-0.json")})
    EXPECT_EQ((*live)->make(name).error().code, ErrorCode::not_found) << name;
}

/// Follows tileset.json and the tilesets that it refers to.
void walk(const test::FilesInMemory& files, const nlohmann::json& tile, std::set<std::string>& contents,
          std::size_t& leaves) {
  const std::string uri = tile["content"]["uri"];
  ASSERT_TRUE(files.files.contains(uri)) << uri;
  EXPECT_EQ(tile["refine"], "REPLACE");
  if (uri.ends_with(".json")) {
    const auto inner = nlohmann::json::parse(files.files.at(uri));
    EXPECT_FALSE(inner["root"].contains("transform"));
    EXPECT_EQ(inner["root"]["geometricError"], tile["geometricError"]);
    return walk(files, inner["root"], contents, leaves);
  }
  EXPECT_TRUE(contents.insert(uri).second) << uri;
  if (!tile.contains("children")) ++leaves;
  for (const auto& child : tile.value("children", nlohmann::json::array()))
    walk(files, child, contents, leaves);
}

TEST_F(Tiles3d, tilesets_lead_to_every_content_once) {
  for (const auto& file : files()) {
    test::FilesInMemory files;
    auto producer = test::open_tiles(file, options());
    const auto report = tiles::export_tiles(*producer, files, test::go_on);
    ASSERT_TRUE(report);
    EXPECT_GT(report->tilesets, 3u);
    std::set<std::string> contents;
    std::size_t leaves = 0;
    walk(files, nlohmann::json::parse(files.files.at("tileset.json"))["root"], contents, leaves);
    EXPECT_EQ(contents.size(), report->tiles);
    EXPECT_EQ(leaves, report->leaves);
    EXPECT_EQ(contents.size() + report->tilesets, files.files.size());
  }
}

TEST_F(Tiles3d, regions_hold_the_contents_of_all_below) {
  auto producer = test::open_tiles(folder_ / "hills.cuesta", options());
  const auto all = test::all_tiles(*producer);
  for (const auto& above : all) {
    const auto& r = above.facts.volume.numbers;
    ASSERT_TRUE(above.facts.volume.is_region);
    for (const auto& below : all) {
      if (below.facts.tile.path.compare(0, above.facts.tile.path.size(), above.facts.tile.path) != 0)
        continue;
      for (const Vec3d& p : below.points) {
        const Geodetic at = producer->placement().geodetic(vec_cast<std::int32_t>(p));
        const double rad = 3.14159265358979323846 / 180;
        const bool inside = at.lon_deg * rad >= r[0] && at.lat_deg * rad >= r[1] &&
                            at.lon_deg * rad <= r[2] && at.lat_deg * rad <= r[3] && at.h_m >= r[4] &&
                            at.h_m <= r[5];
        ASSERT_TRUE(inside) << below.facts.tile.id() << " in " << above.facts.tile.id();
      }
    }
  }
}

TEST_F(Tiles3d, contents_are_gltf_at_their_place) {
  for (const auto& file : files()) {
    auto producer = test::open_tiles(file, options());
    auto root = producer->root();
    ASSERT_TRUE(root && *root);
    std::vector<Vec3d> expected;
    for (const DrawVertex& v : (*root)->mesh.vertices)
      expected.push_back(producer->placement().local({v.x, v.y, v.z}));
    const std::size_t triangles = (*root)->mesh.triangles.size();
    const double rounding = (*root)->facts.geometric_error;
    const auto bytes = producer->content(std::move(**root));
    test::put_bytes(folder_ / "root.glb", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const auto mesh = load_mesh(folder_ / "root.glb", std::uint64_t{1} << 30);
    ASSERT_TRUE(mesh) << mesh.error().text();
    EXPECT_EQ(mesh->triangles.size(), triangles);
    ASSERT_EQ(mesh->positions.size(), expected.size());
    EXPECT_EQ(mesh->normals.size(), expected.size());
    Box3d want, got;
    for (const Vec3d& p : expected) want.add(p);
    for (const Vec3d& p : mesh->positions) got.add(Vec3d{p.x, -p.z, p.y});  // y up to z up
    EXPECT_LE(length(want.lo - got.lo) + length(want.hi - got.hi), rounding);
  }
}

/// tileset transform · local = ECEF of the place.
TEST_F(Tiles3d, transforms_place_local_frames_on_the_earth) {
  const auto local = Frame::enu({46.5, 6.5, 300});
  ASSERT_TRUE(local);
  test::build_terrain(wide_hills(), *local, folder_ / "local.cuesta");
  const auto utm = Frame::projected(*Crs::from_epsg(32632));
  ASSERT_TRUE(utm);
  test::build_terrain(wide_hills(), *utm, folder_ / "utm.cuesta");
  for (const char* name : {"hills.cuesta", "local.cuesta", "utm.cuesta"}) {
    auto producer = test::open_tiles(folder_ / name, options());
    const auto root = producer->root();
    ASSERT_TRUE(root && *root);
    const auto& m = producer->placement().transform();
    double worst = 0;
    for (const DrawVertex& v : (*root)->mesh.vertices) {
      const Vec3d p = producer->placement().local({v.x, v.y, v.z});
      const Vec3d q{m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12],
                    m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
                    m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]};
      worst = std::max(worst,
                       length(q - Frame::ecef().position_m(producer->placement().geodetic({v.x, v.y, v.z}))));
    }
    EXPECT_LE(worst, producer->placement().bends() ? producer->placement().step() : 1e-4) << name;
  }
}

TEST_F(Tiles3d, archives_hold_what_folders_do_and_an_index) {
  auto producer = test::open_tiles(folder_ / "sphere.cuesta", options());
  test::FilesInMemory files;
  ASSERT_TRUE(tiles::export_tiles(*producer, files, test::go_on));
  for (const char* name : {"sphere.3tz", "sphere-tiles"}) {
    auto out = tiles::tile_files(folder_ / name);
    ASSERT_TRUE(out);
    ASSERT_TRUE(tiles::export_tiles(*producer, **out, test::go_on));
  }
  for (const auto& [name, bytes] : files.files)
    EXPECT_EQ(test::bytes_of(folder_ / "sphere-tiles" / name), bytes) << name;
  const std::string archive = test::bytes_of(folder_ / "sphere.3tz");
  int code = 0;
  zip_t* zip = zip_open((folder_ / "sphere.3tz").c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &code);
  ASSERT_NE(zip, nullptr) << code;
  const auto read = [&](const std::string& name) {
    zip_stat_t stat;
    EXPECT_EQ(zip_stat(zip, name.c_str(), 0, &stat), 0) << name;
    std::string bytes(stat.size, '\0');
    zip_file_t* entry = zip_fopen(zip, name.c_str(), 0);
    EXPECT_EQ(zip_fread(entry, bytes.data(), bytes.size()), static_cast<zip_int64_t>(bytes.size()));
    zip_fclose(entry);
    return bytes;
  };
  for (const auto& [name, bytes] : files.files) EXPECT_EQ(read(name), bytes) << name;
  ASSERT_EQ(static_cast<std::size_t>(zip_get_num_entries(zip, 0)), files.files.size() + 1);
  EXPECT_STREQ(zip_get_name(zip, files.files.size(), 0), "@3dtilesIndex1@");
  const std::string index = read("@3dtilesIndex1@");
  ASSERT_EQ(index.size(), files.files.size() * 24);
  std::array<std::uint64_t, 2> last{};
  for (std::size_t i = 0; i < files.files.size(); ++i) {
    std::array<std::uint64_t, 3> row{};
    std::memcpy(row.data(), index.data() + i * 24, 24);
    const std::array<std::uint64_t, 2> digest{row[0], row[1]};
    EXPECT_GT(digest, last);
    last = digest;
    ASSERT_LT(row[2] + 30, archive.size());
    EXPECT_EQ(archive.substr(row[2], 4), "PK\3\4");
    const std::size_t name_bytes = static_cast<std::uint8_t>(archive[row[2] + 26]);
    EXPECT_TRUE(files.files.contains(archive.substr(row[2] + 30, name_bytes)));
  }
  zip_close(zip);
}

TEST_F(Tiles3d, exports_that_end_early_leave_nothing) {
  auto producer = test::open_tiles(folder_ / "sphere.cuesta", options());
  for (const char* name : {"stopped.3tz", "stopped"}) {
    {
      auto out = tiles::tile_files(folder_ / name);
      ASSERT_TRUE(out);
      const auto stop = [](const tiles::TilesReport& r) -> Result<void> {
        if (r.tiles < 3) return {};
        return fail(ErrorCode::cancelled, "", "", "stopped");
      };
      EXPECT_EQ(tiles::export_tiles(*producer, **out, stop).error().code, ErrorCode::cancelled);
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / name));
    EXPECT_FALSE(std::filesystem::exists(folder_ / (std::string(name) + ".part")));
  }
}

}  // namespace
}  // namespace cuesta
