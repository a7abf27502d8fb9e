// cuesta-bench-borders BUILT.cuesta FULL.ply CUT.ply MAP.ply: does cutting into cells show in the errors?
//
// FULL.ply and CUT.ply are exports of BUILT.cuesta, in full and at some error. For each vertex of the
// original the distance to the cut is found; vertices near a border between cells of round 0 are told apart
// from the others. Prints both means as JSON, and writes the original coloured by distance (dark blue 0,
// yellow: four times the mean and more; borders white) for a picture.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdio>
#include <unordered_map>
#include <vector>

#include "apps/measure/triangle_tree.h"
#include "hierarchy/page_positions.h"
#include "ooc/mesh_reader.h"
#include "ooc/mesh_writer.h"

namespace {

using namespace cuesta;

constexpr std::uint64_t build_memory_bytes = std::uint64_t{1} << 34;

template <class T>
T take(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", result.error().text().c_str());
  std::exit(exit_status(result.error().code));
}

struct HashOfPosition {
  std::size_t operator()(const Vec3i& p) const {
    std::uint64_t h = static_cast<std::uint32_t>(p.x);
    for (const std::int32_t c : {p.y, p.z})
      h = (h ^ (h >> 29)) * 0x9E3779B97F4A7C15u + static_cast<std::uint32_t>(c);
    return h ^ (h >> 32);
  }
};

/// Grid positions that more than one page of round 0 has.
std::unordered_map<Vec3i, std::uint32_t, HashOfPosition> pages_by_position(const CuestaFile& file) {
  std::unordered_map<Vec3i, std::uint32_t, HashOfPosition> pages;
  PagePositions positions(file, build_memory_bytes);
  const auto& directory = file.directory();
  for (PageId id = 0; id < directory.pages.size() && directory.pages[id].round == 0; ++id) {
    const auto known = positions.of(id);
    if (!known) continue;
    std::vector<Vec3i> own = known->positions;
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    for (const Vec3i& p : own) ++pages[p];
  }
  return pages;
}

/// Vertices at most `rings` edges from a border.
std::vector<std::uint8_t> near_border(const SurfaceMesh& mesh, std::vector<std::uint8_t> near, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<std::uint8_t> next = near;
    for (const auto& t : mesh.triangles)
      if (near[t[0]] || near[t[1]] || near[t[2]])
        for (std::uint32_t v : t) next[v] = 1;
    near = std::move(next);
  }
  return near;
}

Rgba8 colour_of(double share) {
  // From dark blue over green to yellow.
  const double s = std::clamp(share, 0.0, 1.0);
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::clamp(x, 0.0, 1.0) * 255 + 0.5); };
  return {byte(0.15 + 0.85 * s * s), byte(0.1 + 0.85 * s), byte(0.45 - 0.4 * s), 255};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: cuesta-bench-borders BUILT.cuesta FULL.ply CUT.ply MAP.ply\n");
    return 1;
  }
  constexpr int rings = 4;
  const CuestaFile file = take(CuestaFile::open(argv[1]));
  SurfaceMesh full = take(load_mesh(argv[2], build_memory_bytes));
  const SurfaceMesh cut = take(load_mesh(argv[3], build_memory_bytes));
  const measure::TriangleTree tree(cut.positions, cut.triangles);
  const auto pages = pages_by_position(file);

  std::vector<double> distance(full.positions.size());
  std::vector<std::uint8_t> border(full.positions.size());
  tbb::parallel_for(std::size_t{0}, distance.size(), [&](std::size_t v) {
    distance[v] = std::sqrt(tree.nearest(full.positions[v]).distance_sq);
    const auto found = pages.find(file.directory().grid.snap(full.positions[v]));
    border[v] = found != pages.end() && found->second > 1;
  });
  const auto near = near_border(full, border, rings);
  double sum[2] = {}, worst[2] = {};
  std::uint64_t count[2] = {};
  for (std::size_t v = 0; v < distance.size(); ++v) {
    sum[near[v]] += distance[v];
    worst[near[v]] = std::max(worst[near[v]], distance[v]);
    ++count[near[v]];
  }
  const double mean = (sum[0] + sum[1]) / static_cast<double>(distance.size());
  full.normals.clear();
  full.texcoords.clear();
  full.colours.resize(full.positions.size());
  for (std::size_t v = 0; v < distance.size(); ++v)
    full.colours[v] = border[v] ? Rgba8{255, 255, 255, 255} : colour_of(distance[v] / (4 * mean));
  const auto written = write_mesh(argv[4], full);
  if (!written) {
    std::fprintf(stderr, "%s\n", written.error().text().c_str());
    return exit_status(written.error().code);
  }
  const auto each = [&](int i) {
    return fmt::format("{{\"vertices\": {}, \"mean\": {}, \"max\": {}}}", count[i],
                       count[i] > 0 ? sum[i] / static_cast<double>(count[i]) : 0, worst[i]);
  };
  fmt::print("{{\"near_borders\": {}, \"elsewhere\": {}}}\n", each(1), each(0));
}
