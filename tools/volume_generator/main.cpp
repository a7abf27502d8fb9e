/// cuesta-make-volume OUT.vdb --voxels N: a level set with much surface, for tests and benchmarks.
///
/// A gyroid with a rough skin inside a ball that is N voxels wide. Leaf nodes that the surface cannot reach
/// are never made, so time and memory grow with the surface: about N³ / 9 triangles.

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <charconv>
#include <cmath>
#include <exception>
#include <memory>
#include <string_view>
#include <vector>

namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using Leaf = FloatGrid::TreeType::LeafNodeType;

constexpr float band_voxels = 3;
constexpr double period_voxels = 48;
constexpr int leaf_voxels = 8;

/// About a distance in voxels: its gradient is at most 1.6, in the band near 1.
double distance(const Coord& at, double radius) {
  const double k = 2 * 3.14159265358979 / period_voxels;
  const double x = k * at[0], y = k * at[1], z = k * at[2];
  const double gyroid = std::sin(x) * std::cos(y) + std::sin(y) * std::cos(z) + std::sin(z) * std::cos(x);
  const double rough = 0.4 * std::sin(9 * x + 3 * z) * std::sin(7 * y - 4 * x) * std::sin(8 * z + 5 * y);
  const double ball =
      std::sqrt(at[0] * double(at[0]) + at[1] * double(at[1]) + at[2] * double(at[2])) - radius;
  return std::max(gyroid / (1.4 * k) + rough, ball);
}

std::unique_ptr<Leaf> make_leaf(const Coord& origin, double radius) {
  constexpr double reach = 1.6 * 0.8661 * leaf_voxels + band_voxels;
  if (std::abs(distance(origin.offsetBy(leaf_voxels / 2), radius)) > reach) return nullptr;
  auto leaf = std::make_unique<Leaf>(origin, band_voxels, false);
  for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
    const auto d = static_cast<float>(distance(leaf->offsetToGlobalCoord(i), radius));
    if (std::abs(d) < band_voxels) {
      leaf->setValueOn(i, d);
    } else {
      leaf->setValueOff(i, std::copysign(band_voxels, d));
    }
  }
  return leaf->isEmpty() ? nullptr : std::move(leaf);
}

FloatGrid::Ptr make_grid(int voxels) {
  auto grid = FloatGrid::create(band_voxels);
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  const double radius = voxels / 2.0 - band_voxels - 1;
  const int half = (voxels / 2 + leaf_voxels - 1) / leaf_voxels;  // leaves
  const auto side = static_cast<std::size_t>(2 * half);
  std::vector<std::unique_ptr<Leaf>> slab(side * side);
  for (int x = -half; x < half; ++x) {
    tbb::parallel_for(std::size_t{0}, slab.size(), [&](std::size_t i) {
      const int y = static_cast<int>(i / side) - half, z = static_cast<int>(i % side) - half;
      slab[i] = make_leaf(Coord(x * leaf_voxels, y * leaf_voxels, z * leaf_voxels), radius);
    });
    for (auto& leaf : slab)
      if (leaf) grid->tree().addLeaf(leaf.release());
  }
  openvdb::tools::signedFloodFill(grid->tree());
  return grid;
}

bool parse(int argc, char** argv, std::string_view& path, int& voxels) {
  if (argc != 4 || std::string_view(argv[2]) != "--voxels") return false;
  path = argv[1];
  const std::string_view text = argv[3];
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), voxels);
  return error == std::errc{} && end == text.data() + text.size() && voxels >= 32 && voxels <= 65536;
}

}  // namespace

int main(int argc, char** argv) try {
  std::string_view path;
  int voxels = 0;
  if (!parse(argc, argv, path, voxels)) {
    fmt::print(stderr,
               "usage: cuesta-make-volume OUT.vdb --voxels N\nA level set in N³ voxels, 32 to 65536.\n");
    return 1;
  }
  openvdb::initialize();
  const auto grid = make_grid(voxels);
  openvdb::io::File(std::string(path)).write({grid});
  fmt::print("{}: {} leaf nodes, {} active voxels\n", path, grid->tree().leafCount(),
             grid->activeVoxelCount());
  return 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "cuesta-make-volume: {}\n", e.what());
  return 6;
}
