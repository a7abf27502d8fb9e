/// Volumes: the surface is closed, the same whatever the block, where it should be, and turned outwards.

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/ooc/check_grid_mesh.h"
#include "tests/ooc/grid_mesh.h"
#include "tests/ooc/mesh_files.h"

namespace cuesta {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::GridPtrVec;
using openvdb::Vec3f;

constexpr double voxel = 0.25;

std::filesystem::path save(const test::ScratchFolder& folder, const GridPtrVec& grids,
                           const std::string& name = "v.vdb", bool compress = true) {
  openvdb::initialize();
  openvdb::io::File file((folder / name).string());
  file.setCompression(compress ? openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK
                               : openvdb::io::COMPRESS_NONE);
  file.write(grids);
  return folder / name;
}

/// Off the voxels' centres, over several blocks of 16 to 64 and both signs of the coordinates.
template <class Grid = FloatGrid>
typename Grid::Ptr sphere(double radius = 10, openvdb::Vec3d centre = {0.7, 3.1, -2.3}) {
  openvdb::initialize();
  auto grid = openvdb::tools::createLevelSetSphere<Grid>(static_cast<float>(radius), Vec3f(centre), voxel);
  grid->setName("sphere");
  return grid;
}

/// f < 0 inside; a narrow band of three voxels.
template <class Distance>
FloatGrid::Ptr level_set(int half_voxels, const Distance& f) {
  openvdb::initialize();
  const float band = static_cast<float>(3 * voxel);
  auto grid = FloatGrid::create(band);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  auto at = grid->getAccessor();
  Coord c;
  for (c[0] = -half_voxels; c[0] <= half_voxels; ++c[0])
    for (c[1] = -half_voxels; c[1] <= half_voxels; ++c[1])
      for (c[2] = -half_voxels; c[2] <= half_voxels; ++c[2]) {
        const float d = static_cast<float>(f(voxel * c[0], voxel * c[1], voxel * c[2]));
        if (std::abs(d) < band) {
          at.setValueOn(c, d);
        } else if (d < 0) {
          at.setValueOff(c, -band);
        }
      }
  return grid;
}
FloatGrid::Ptr torus() {
  return level_set(40,
                   [](double x, double y, double z) { return std::hypot(std::hypot(x, y) - 6.0, z) - 2.0; });
}
/// Two sheets within one cell, sharp edges, ambiguous faces.
FloatGrid::Ptr gyroid() {
  return level_set(28, [](double x, double y, double z) {
    const double g = std::sin(x) * std::cos(y) + std::sin(y) * std::cos(z) + std::sin(z) * std::cos(x);
    return std::max(0.7 * g, std::hypot(x, y, z) - 6.0);
  });
}
/// Values below what blocks of leaves can separate: noise of one voxel.
FloatGrid::Ptr noise() {
  return level_set(14, [](double x, double y, double z) {
    const double n = std::sin(12.9898 * x + 78.233 * y + 37.719 * z) * 43758.5453;
    return std::max(n - std::floor(n) - 0.5, std::hypot(x, y, z) - 2.6);
  });
}
/// Density 1 in a ball, falling to 0 over four voxels; its inside is pruned to tiles.
FloatGrid::Ptr fog() {
  auto grid = sphere();
  for (auto it = grid->beginValueAll(); it; ++it) {
    const double d = static_cast<double>(*it) / voxel;
    it.setValue(static_cast<float>(std::clamp(0.5 - d / 4, 0.0, 1.0)));
    it.setActiveState(*it > 0);
  }
  grid->tree().root().setBackground(0.0f, true);
  grid->tree().prune();
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->setName("fog");
  return grid;
}

SurfaceMesh load(const std::filesystem::path& path, const VolumeOptions& options = {},
                 std::uint64_t memory = test::test_memory) {
  auto mesh = load_mesh(path, memory, nullptr, {}, {}, options);
  if (mesh) return std::move(*mesh);
  ADD_FAILURE() << mesh.error().text();
  return {};
}
Error error_of(const std::filesystem::path& path, const VolumeOptions& options = {},
               std::uint64_t memory = test::test_memory) {
  auto mesh = load_mesh(path, memory, nullptr, {}, {}, options);
  if (!mesh) return mesh.error();
  ADD_FAILURE() << path << " was read, expected an error";
  return {};
}

/// Vertices of the same bits are one.
SurfaceMesh welded(const SurfaceMesh& mesh) {
  std::map<Vec3d, std::uint32_t> index;
  SurfaceMesh out;
  std::vector<std::uint32_t> to;
  for (const Vec3d& p : mesh.positions) {
    const auto [at, is_new] = index.emplace(p, static_cast<std::uint32_t>(out.positions.size()));
    if (is_new) out.positions.push_back(p);
    to.push_back(at->second);
  }
  for (const auto& t : mesh.triangles) out.triangles.push_back({to[t[0]], to[t[1]], to[t[2]]});
  return out;
}

struct Topology {
  std::size_t open_edges = 0;  ///< directed edges without exactly one opposite
  std::size_t degenerate = 0;
  long euler = 0;
};
Topology topology(const SurfaceMesh& mesh) {
  Topology t;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::set<std::uint32_t> used;
  for (const auto& f : mesh.triangles) {
    t.degenerate += f[0] == f[1] || f[1] == f[2] || f[2] == f[0];
    for (int i = 0; i < 3; ++i) {
      ++edges[{f[i], f[(i + 1) % 3]}];
      used.insert(f[i]);
    }
  }
  for (const auto& [edge, count] : edges) {
    const auto opposite = edges.find({edge.second, edge.first});
    t.open_edges += opposite == edges.end() || opposite->second != count;
  }
  t.euler = static_cast<long>(used.size()) - static_cast<long>(edges.size() / 2) +
            static_cast<long>(mesh.triangles.size());
  return t;
}

double volume(const SurfaceMesh& mesh) {
  double six = 0;
  for (const auto& t : mesh.triangles)
    six += dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]]));
  return six / 6;
}

/// Triangles by position, from their lowest corner on: equal for equal surfaces in any order.
std::vector<std::array<Vec3d, 3>> triangle_set(const SurfaceMesh& mesh) {
  std::vector<std::array<Vec3d, 3>> all;
  for (const auto& t : mesh.triangles) {
    std::array<Vec3d, 3> p{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    std::rotate(p.begin(), std::min_element(p.begin(), p.end()), p.end());
    all.push_back(p);
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(VdbReader, LevelSetSphereIsClosedAndWhereItShouldBe) {
  const test::ScratchFolder folder;
  const auto path = save(folder, {sphere()});
  for (const double adaptivity : {0.0, 0.05, 0.5, 1.0}) {
    const SurfaceMesh mesh = welded(load(path, {.adaptivity = adaptivity, .block_voxels = 32}));
    const Topology t = topology(mesh);
    EXPECT_EQ(t.open_edges, 0u) << adaptivity;
    EXPECT_EQ(t.degenerate, 0u) << adaptivity;
    EXPECT_EQ(t.euler, 2) << adaptivity;
    const double ball = 4.0 / 3 * 3.14159265358979 * 1000;
    EXPECT_NEAR(volume(mesh), ball,
                ball * (adaptivity == 0    ? 0.005
                        : adaptivity < 0.1 ? 0.03
                                           : 0.1))
        << "outside is counter-clockwise";
    const Vec3d centre{0.7, 3.1, -2.3};
    double worst = 0;
    for (const Vec3d& p : mesh.positions) worst = std::max(worst, std::abs(length(p - centre) - 10));
    EXPECT_LT(worst, adaptivity == 0    ? 0.05 * voxel
                     : adaptivity < 0.1 ? 0.3 * voxel
                                        : 2 * voxel)
        << adaptivity;
  }
}

TEST(VdbReader, TheSurfaceIsTheSameWhateverTheBlock) {
  const test::ScratchFolder folder;
  const std::map<std::string, FloatGrid::Ptr> grids{
      {"sphere", sphere()}, {"torus", torus()}, {"gyroid", gyroid()}, {"noise", noise()}, {"fog", fog()}};
  for (const auto& [name, grid] : grids) {
    const auto path = save(folder, {grid}, name + ".vdb");
    for (const double adaptivity : {0.0, 0.1, 1.0}) {
      const auto whole = load(path, {.adaptivity = adaptivity, .block_voxels = 512});
      ASSERT_FALSE(whole.triangles.empty()) << name;
      const auto expected = triangle_set(whole);
      for (const int block : {8, 24, 128}) {
        const auto mesh = load(path, {.adaptivity = adaptivity, .block_voxels = block});
        EXPECT_EQ(triangle_set(mesh), expected)
            << name << ", adaptivity " << adaptivity << ", block " << block;
      }
    }
  }
}

TEST(VdbReader, TopologyOfATorusAndAGyroid) {
  const test::ScratchFolder folder;
  const SurfaceMesh ring = welded(load(save(folder, {torus()}), {.block_voxels = 16}));
  EXPECT_EQ(topology(ring).euler, 0);
  EXPECT_EQ(topology(ring).open_edges, 0u);
  const auto path = save(folder, {gyroid()}, "gyroid.vdb");
  const SurfaceMesh full = welded(load(path, {.block_voxels = 16}));
  EXPECT_EQ(topology(full).open_edges, 0u);
  EXPECT_LT(topology(full).euler, -10);
  const SurfaceMesh merged = welded(load(path, {.adaptivity = 0.1, .block_voxels = 16}));
  EXPECT_EQ(topology(merged).open_edges, 0u);
  EXPECT_EQ(topology(merged).euler, topology(full).euler);
  EXPECT_LT(merged.triangles.size(), full.triangles.size() * 9 / 10);
}

TEST(VdbReader, CleaningFindsAManifoldWithoutBorders) {
  const test::ScratchFolder folder;
  for (const double adaptivity : {0.0, 0.1}) {
    CleanReport report;
    auto mesh = test::clean_mesh(
        load(save(folder, {torus()}), {.adaptivity = adaptivity, .block_voxels = 32}), {}, report);
    ASSERT_TRUE(mesh) << mesh.error().text();
    EXPECT_EQ(test::find_violation(*mesh), "");
    EXPECT_EQ(report.edges_nonmanifold, 0u);
    EXPECT_GT(report.vertices_welded, 0u);
    EXPECT_EQ(report.wedge_groups, 0u);
    SurfaceMesh clean;
    for (const Vec3i& p : mesh->positions) clean.positions.push_back(vec_cast<double>(p));
    clean.triangles = mesh->triangles;
    EXPECT_EQ(topology(clean).open_edges, 0u);
    EXPECT_EQ(topology(clean).euler, 0);
  }
}

TEST(VdbReader, NoiseStaysClosed) {
  const test::ScratchFolder folder;
  const auto path = save(folder, {noise()});
  for (const double adaptivity : {0.0, 0.3})
    EXPECT_EQ(topology(welded(load(path, {.adaptivity = adaptivity, .block_voxels = 8}))).open_edges, 0u);
}

TEST(VdbReader, FogHasASurfaceAtHalfDensityThroughTilesToo) {
  const test::ScratchFolder folder;
  auto grid = fog();
  ASSERT_GT(grid->tree().activeTileCount(), 0u);
  const auto path = save(folder, {grid});
  const SurfaceMesh mesh = welded(load(path, {.block_voxels = 32}));
  EXPECT_EQ(topology(mesh).open_edges, 0u);
  EXPECT_EQ(topology(mesh).euler, 2);
  const double ball = 4.0 / 3 * 3.14159265358979 * 1000;
  EXPECT_NEAR(volume(mesh), ball, 0.01 * ball);
  EXPECT_LT(volume(welded(load(path, {.iso = 0.8}))), 0.98 * ball);

  auto box = FloatGrid::create(0);  // nothing but tiles
  box->setGridClass(openvdb::GRID_FOG_VOLUME);
  box->fill(openvdb::CoordBBox(Coord(-8), Coord(15)), 1.0f);
  ASSERT_EQ(box->tree().leafCount(), 0u);
  const SurfaceMesh tiles = welded(load(save(folder, {box}, "box.vdb"), {.block_voxels = 8}));
  EXPECT_EQ(topology(tiles).open_edges, 0u);
  EXPECT_EQ(topology(tiles).euler, 2);
  EXPECT_NEAR(volume(tiles), 24 * 24 * 24, 100);
}

TEST(VdbReader, TransformsAreApplied) {
  const test::ScratchFolder folder;
  auto grid = sphere(10, {0, 0, 0});
  const double ball = volume(load(save(folder, {grid})));
  openvdb::Mat4d far(openvdb::Mat4d::identity());
  far.setToScale(openvdb::Vec3d(0.25, 0.5, 1.0));
  far.postRotate(openvdb::math::Z_AXIS, 0.3);
  far.postTranslate(openvdb::Vec3d(4.0e6, -5.0e5, 120));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(far));
  const auto path = save(folder, {grid}, "far.vdb");
  SurfaceMesh mesh = welded(load(path, {.block_voxels = 24}));
  EXPECT_EQ(topology(mesh).open_edges, 0u);
  Vec3d low = mesh.positions[0], high = low;
  for (Vec3d& p : mesh.positions) {
    low = min(low, p), high = max(high, p);
    p = p - Vec3d{4.0e6, -5.0e5, 120};
  }
  EXPECT_NEAR((low.x + high.x) / 2, 4.0e6, 1e-6);
  EXPECT_NEAR((low.y + high.y) / 2, -5.0e5, 1e-6);
  EXPECT_NEAR(high.z - low.z, 80, 0.1);
  EXPECT_NEAR(volume(mesh), 8 * ball, 1e-3 * ball);

  openvdb::Mat4d mirror(openvdb::Mat4d::identity());
  mirror.setToScale(openvdb::Vec3d(-0.25, 0.25, 0.25));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(mirror));
  EXPECT_NEAR(volume(load(save(folder, {grid}, "mirror.vdb"))), ball, 1e-6 * ball);

  grid->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd(openvdb::Vec3d(-50), openvdb::Vec3d(50)), 0.5, 1.0));
  const Error error = error_of(save(folder, {grid}, "frustum.vdb"));
  EXPECT_EQ(error.code, ErrorCode::unsupported_version);
  EXPECT_NE(error.message.find("linear"), std::string::npos);
}

TEST(VdbReader, GridsAreChosenByNameAndListed) {
  const test::ScratchFolder folder;
  auto small = sphere(5), half = sphere(6), twin = sphere(7);
  small->setName("small");
  half->setName("half");
  half->setSaveFloatAsHalf(true);
  twin->setName("half");
  auto exact = sphere<openvdb::DoubleGrid>(8);
  exact->setName("exact");
  auto wind = openvdb::Vec3SGrid::create();
  wind->setName("wind");
  wind->tree().setValueOn(Coord(0), Vec3f(1));
  const auto path = save(folder, {wind, small, half, twin, exact});
  const auto radius = [&](const std::string& name) {
    const SurfaceMesh mesh = load(path, {.grid = name});
    double sum = 0;
    for (const Vec3d& p : mesh.positions) sum += length(p - Vec3d{0.7, 3.1, -2.3});
    return sum / static_cast<double>(mesh.positions.size());
  };
  EXPECT_NEAR(radius(""), 5, 0.02);
  EXPECT_NEAR(radius("small"), 5, 0.02);
  EXPECT_NEAR(radius("half"), 6, 0.02);
  EXPECT_NEAR(radius("half[1]"), 7, 0.02);
  EXPECT_NEAR(radius("exact"), 8, 0.02);

  const Error missing = error_of(path, {.grid = "density"});
  EXPECT_EQ(missing.code, ErrorCode::not_found);
  for (const char* word : {"\"wind\" (Tree_vec3s_5_4_3)", "\"half[1]\" (Tree_float_5_4_3)",
                           "\"half[0]\" (Tree_float_5_4_3, half)", "\"exact\" (Tree_double_5_4_3)"})
    EXPECT_NE(missing.message.find(word), std::string::npos) << missing.message;
  const Error vectors = error_of(path, {.grid = "wind"});
  EXPECT_EQ(vectors.code, ErrorCode::invalid_input);
  EXPECT_NE(vectors.message.find("Tree_vec3s_5_4_3"), std::string::npos) << vectors.message;
  EXPECT_EQ(error_of(save(folder, {wind}, "wind.vdb")).code, ErrorCode::invalid_input);
}

TEST(VdbReader, WhatHasNoSurfaceIsAnError) {
  const test::ScratchFolder folder;
  auto empty = FloatGrid::create(1);
  empty->setGridClass(openvdb::GRID_LEVEL_SET);
  EXPECT_NE(error_of(save(folder, {empty})).message.find("empty"), std::string::npos);

  const Error high = error_of(save(folder, {fog()}), {.iso = 2.5});
  EXPECT_EQ(high.code, ErrorCode::invalid_input);
  EXPECT_NE(high.message.find("to 1; "), std::string::npos) << high.message;
  EXPECT_EQ(high.file, folder / "v.vdb");

  auto plain = sphere();
  plain->setGridClass(openvdb::GRID_UNKNOWN);
  const auto path = save(folder, {plain});
  EXPECT_NE(error_of(path).message.find("--iso"), std::string::npos);
  EXPECT_FALSE(load(path, {.iso = 0.1}).triangles.empty());

  for (const VolumeOptions& wrong :
       {VolumeOptions{.adaptivity = -1}, VolumeOptions{.adaptivity = std::nan("")},
        VolumeOptions{.iso = std::nan("")}, VolumeOptions{.block_voxels = 12},
        VolumeOptions{.block_voxels = 0}})
    EXPECT_EQ(error_of(path, wrong).code, ErrorCode::invalid_input);

  auto broken = sphere();
  broken->tree().setValueOn(Coord(43, 12, -9), std::nanf(""));
  broken->tree().setValueOn(Coord(44, 12, -9), std::nanf(""));
  const auto nan = load_mesh(save(folder, {broken}), test::test_memory);
  EXPECT_TRUE(nan || nan.error().code == ErrorCode::corrupt);
}

TEST(VdbReader, BudgetHolds) {
  const test::ScratchFolder folder;
  const auto path = save(folder, {sphere()});
  test::CheckingSink sink;
  for (const std::uint64_t memory : {0ull, 1ull << 12, 1ull << 16, 1ull << 20}) {
    const auto report = read_mesh(path, sink, memory);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::out_of_budget) << report.error().text();
  }
  EXPECT_TRUE(read_mesh(path, sink, 32ull << 20, {}, {}, {.block_voxels = 32}));
  sink.expect_in_range();
}

TEST(VdbReader, SinkAndProgressCanStop) {
  const test::ScratchFolder folder;
  const auto path = save(folder, {sphere()});
  test::CheckingSink few(100);
  const auto stopped = read_mesh(path, few, test::test_memory);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::cancelled);
  test::CheckingSink sink;
  std::uint64_t last = 0;
  ASSERT_TRUE(read_mesh(path, sink, test::test_memory, [&](std::uint64_t done, std::uint64_t total) {
    EXPECT_GE(done, last);
    EXPECT_EQ(total, std::filesystem::file_size(path));
    last = done;
    return true;
  }));
  EXPECT_EQ(last, std::filesystem::file_size(path));
  EXPECT_FALSE(read_mesh(path, sink, test::test_memory, [](std::uint64_t, std::uint64_t) { return false; }));
}

TEST(VdbReader, TruncatedFilesAreRefusedAtEveryLength) {
  const test::ScratchFolder folder;
  const std::string bytes = [&] {
    std::ifstream in(save(folder, {sphere(3), sphere(2)}), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  }();
  for (std::size_t length = 8; length < bytes.size(); length += length < 600 ? 1 : 997) {
    const Error error = test::load_error("cut.vdb", bytes.substr(0, length));
    EXPECT_EQ(error.code, ErrorCode::corrupt) << length << ": " << error.text();
  }
  EXPECT_EQ(test::load_error("empty.vdb", "").code, ErrorCode::corrupt);
}

TEST(VdbReader, OtherVersionsAndCompressedFilesAreNamed) {
  const test::ScratchFolder folder;
  std::ifstream in(save(folder, {sphere(2)}), std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  std::string newer = bytes, stream = bytes;
  newer[8] = '\x7f', newer[9] = 2;
  stream[20] = 0;
  EXPECT_EQ(test::load_error("newer.vdb", newer).code, ErrorCode::unsupported_version);
  EXPECT_EQ(test::load_error("stream.vdb", stream).code, ErrorCode::unsupported_version);
  EXPECT_EQ(test::load_error("text.vdb", "this is no volume").code, ErrorCode::corrupt);
  EXPECT_FALSE(test::load_bytes("no_extension", bytes).triangles.empty());
}

TEST(VdbReader, DamagedValuesAreAnErrorOrAnotherSurface) {
  const test::ScratchFolder folder;
  for (const bool compress : {true, false}) {
    std::ifstream in(save(folder, {sphere(3)}, "d.vdb", compress), std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    std::uint64_t values_byte = 0;
    std::memcpy(&values_byte, bytes.data() + bytes.find("Tree_float_5_4_3") + 16 + 4 + 8, 8);
    ASSERT_LT(values_byte, bytes.size());
    for (std::size_t at = values_byte; at < bytes.size(); at += 701) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
      const auto path = folder.write("damaged.vdb", damaged);
      test::CheckingSink sink;
      const auto report = read_mesh(path, sink, test::test_memory);
      if (report) {
        sink.expect_in_range();
      } else {
        EXPECT_FALSE(report.error().message.empty());
      }
    }
  }
}

}  // namespace
}  // namespace cuesta
