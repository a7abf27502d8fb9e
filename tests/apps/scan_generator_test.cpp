#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "measure_shapes.h"
#include "tools/scan_generator/make_scan.h"
#include "tools/scan_generator/subdivide.h"
#include "tools/scan_generator/surface_noise.h"

namespace cuesta::tools {
namespace {

SurfaceMesh tetrahedron() {
  SurfaceMesh mesh;
  mesh.positions = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

struct Topology {
  std::int64_t euler = 0, border_edges = 0, bad_edges = 0;
};

/// Counted with ordered sets: nothing in common with the generator.
Topology topology(const SurfaceMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, int>> edges;
  std::set<std::uint32_t> vertices;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      auto& uses = edges[{std::min(a, b), std::max(a, b)}];
      ++(a < b ? uses.first : uses.second);
      vertices.insert(a);
    }
  }
  Topology result;
  result.euler =
      std::int64_t(vertices.size()) - std::int64_t(edges.size()) + std::int64_t(mesh.triangles.size());
  for (const auto& [edge, uses] : edges) {
    if (uses.first + uses.second == 1) ++result.border_edges;
    if (uses.first > 1 || uses.second > 1) ++result.bad_edges;
  }
  return result;
}

std::string bytes_of(const SurfaceMesh& mesh, ScanOrder order) {
  const auto path =
      std::filesystem::temp_directory_path() /
      ("cuesta_scan_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  EXPECT_TRUE(write_scan(path, mesh, order, 5));
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  std::filesystem::remove(path);
  return bytes;
}

TEST(SubdivideLoop, TetrahedronByHand) {
  const auto fine = subdivide_loop(tetrahedron());
  ASSERT_TRUE(fine);
  EXPECT_EQ(fine->positions.size(), 10u);
  EXPECT_EQ(fine->triangles.size(), 16u);
  // Valence 3: beta = 3/16, so (1, 1, 1) · 7/16 + (−1, −1, −1) · 3/16.
  EXPECT_NEAR(fine->positions[0].x, 0.25, 1e-15);
  // Edge 0–1: 3/8 of (0, 0, 2) and 1/8 of (0, 0, −2).
  EXPECT_NEAR(fine->positions[4].z, 0.5, 1e-15);
}

TEST(SubdivideLoop, BordersKeepToThemselves) {
  SurfaceMesh mesh = test::square(3, 0);
  mesh.positions[5].z = 9;  // an inner vertex
  const auto fine = subdivide_loop(mesh);
  ASSERT_TRUE(fine);
  for (std::uint32_t v = 0; v < 4; ++v) EXPECT_EQ(fine->positions[v].z, 0) << v;
  EXPECT_NEAR(fine->positions[1].x, 1.0 / 3, 1e-15);
  EXPECT_GT(fine->positions[5].z, 1);
}

TEST(SubdivideLoop, RefusesWhatIsNotManifold) {
  SurfaceMesh fan = test::square(1, 0);
  fan.positions.push_back({0.5, 0.5, 1});
  fan.triangles.push_back({0, 3, 4});
  EXPECT_EQ(subdivide_loop(fan).error().code, ErrorCode::invalid_input);
  SurfaceMesh twice = test::square(1, 0);
  twice.triangles[0][1] = twice.triangles[0][0];
  EXPECT_EQ(subdivide_loop(twice).error().code, ErrorCode::invalid_input);
}

TEST(MakeScan, KeepsEulerCharacteristicAndBorders) {
  const auto closed = make_scan(tetrahedron(), {.triangles = 10'000});
  ASSERT_TRUE(closed);
  EXPECT_EQ(closed->triangles.size(), 16'384u);
  const Topology sphere = topology(*closed);
  EXPECT_EQ(sphere.euler, 2);
  EXPECT_EQ(sphere.border_edges, 0);
  EXPECT_EQ(sphere.bad_edges, 0);
  SurfaceMesh ring = test::square(3, 0);
  ring.triangles.erase(ring.triangles.begin() + 8, ring.triangles.begin() + 10);  // a hole in the middle
  const auto open = make_scan(ring, {.triangles = 2000});
  ASSERT_TRUE(open);
  EXPECT_EQ(topology(*open).euler, topology(ring).euler);
  EXPECT_EQ(topology(*open).euler, 0);
  EXPECT_EQ(topology(*open).border_edges, 16 * 16);
}

TEST(MakeScan, RefusesNothingAndSoup) {
  EXPECT_EQ(make_scan({}, {}).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(make_scan(test::random_soup(1, 20), {}).error().code, ErrorCode::invalid_input);
}

TEST(MakeScan, RoughByTheAskedShare) {
  const auto smooth = make_scan(tetrahedron(), {.triangles = 60'000, .roughness = 0});
  const auto rough = make_scan(tetrahedron(), {.triangles = 60'000});
  ASSERT_TRUE(smooth && rough);
  double largest = 0;
  for (std::size_t v = 0; v < smooth->positions.size(); ++v) {
    largest = std::max(largest, length(smooth->positions[v] - rough->positions[v]));
  }
  Box3d box;
  for (const Vec3d& p : smooth->positions) box.add(p);
  const double diagonal = length(box.hi - box.lo);
  EXPECT_GT(largest, 0.001 * diagonal);
  EXPECT_LT(largest, 0.003 * diagonal);
}

TEST(MakeScan, SameBytesOnTwoRunsAndAnyNumberOfThreads) {
  const auto made = [](int threads, std::uint64_t seed) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return make_scan(tetrahedron(), {.triangles = 60'000, .seed = seed}); });
  };
  const auto one = made(1, 1), four = made(4, 1), other = made(1, 2);
  ASSERT_TRUE(one && four && other);
  const std::string bytes = bytes_of(*one, ScanOrder::permuted);
  EXPECT_EQ(bytes, bytes_of(*four, ScanOrder::permuted));
  EXPECT_NE(bytes, bytes_of(*other, ScanOrder::permuted));
  EXPECT_NE(bytes, bytes_of(*one, ScanOrder::first_use));
}

// Corner positions of all faces, sorted: what a permutation must keep.
std::multiset<std::array<std::array<float, 3>, 3>> faces_of(const std::string& bytes, std::size_t vertices) {
  const char* records = bytes.data() + bytes.find("end_header\n") + 11;
  const char* faces = records + vertices * 24;
  std::multiset<std::array<std::array<float, 3>, 3>> all;
  for (; faces < bytes.data() + bytes.size(); faces += 13) {
    EXPECT_EQ(faces[0], 3);
    std::array<std::array<float, 3>, 3> face;
    for (std::size_t i = 0; i < 3; ++i) {
      std::int32_t v;
      std::memcpy(&v, faces + 1 + 4 * i, 4);
      std::memcpy(&face[i], records + v * 24, 12);
    }
    all.insert(face);
  }
  return all;
}

TEST(WriteScan, PermutationKeepsTheSurface) {
  SurfaceMesh mesh = *make_scan(tetrahedron(), {.triangles = 1000});
  const std::size_t used = mesh.positions.size();
  mesh.positions.push_back({9, 9, 9});  // no triangle uses it
  mesh.normals.push_back({});
  const std::string plain = bytes_of(mesh, ScanOrder::first_use), mixed = bytes_of(mesh, ScanOrder::permuted);
  EXPECT_EQ(plain.size(), mixed.size());
  EXPECT_NE(plain, mixed);
  EXPECT_EQ(faces_of(plain, used), faces_of(mixed, used));
  EXPECT_EQ(plain.size(), plain.find("end_header\n") + 11 + used * 24 + mesh.triangles.size() * 13);
}

TEST(ScanOctaves, DoubleUpToTheTotal) {
  const auto octaves = scan_octaves(0.01, 0.0375);
  ASSERT_EQ(octaves.size(), 4u);
  EXPECT_NEAR(octaves[0].amplitude, 0.0025, 1e-12);
  EXPECT_NEAR(octaves[3].amplitude, 0.02, 1e-12);
  EXPECT_NEAR(octaves[3].wavelength, 0.32, 1e-12);
  EXPECT_TRUE(scan_octaves(0, 1).empty());
}

TEST(GradientNoise, SmoothBoundedAndZeroOnTheLattice) {
  EXPECT_EQ(gradient_noise({3, -5, 7}, 1), 0);
  double largest = 0;
  for (int i = 0; i < 10'000; ++i) {
    const Vec3d p{i * 0.317 - 1000, i * 0.119, i * -0.223};
    const double here = gradient_noise(p, 1);
    largest = std::max(largest, std::abs(here));
    EXPECT_NEAR(gradient_noise(p + Vec3d{1e-6, 0, 0}, 1), here, 1e-5);
  }
  EXPECT_GT(largest, 0.6);
  EXPECT_LE(largest, 1.1);
}

}  // namespace
}  // namespace cuesta::tools
