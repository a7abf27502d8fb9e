#include "tests/ooc/grid_mesh.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "ooc/oct_normal.h"

namespace cuesta::test {
namespace {

constexpr std::size_t block_elements = 1u << 16;

template <class T>
std::span<const T> run(const std::vector<T>& values, std::size_t first) {
  if (values.empty()) return {};
  return std::span(values).subspan(first, std::min(block_elements, values.size() - first));
}

/// A new folder, in memory where there is such a file system: hundreds of small builds.
std::filesystem::path scratch_path() {
  static int count = 0;
  const std::filesystem::path memory = "/dev/shm";
  const auto parent = std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
  return parent / ("cuesta-test-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
}

}  // namespace

Result<std::vector<ReadReport>> feed(const SurfaceMesh& mesh, RawSurface& sink) {
  sink.begin_input();
  for (std::size_t v = 0; v < mesh.positions.size(); v += block_elements)
    if (auto r = sink.vertices(
            {run(mesh.positions, v), run(mesh.normals, v), run(mesh.colours, v), run(mesh.texcoords, v)});
        !r)
      return fail(r.error());
  std::vector<std::array<std::uint64_t, 3>> block;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += block_elements) {
    block.clear();
    for (const auto& [a, b, c] : run(mesh.triangles, t)) block.push_back({a, b, c});
    if (auto r = sink.triangles(block); !r) return fail(r.error());
  }
  return std::vector<ReadReport>(1);
}

GridMesh put_together(const InputSurface& surface) {
  GridMesh out;
  out.grid = surface.grid;
  std::vector<SurfaceChunk> chunks;
  std::map<VertexId, std::pair<const SurfaceChunk*, std::size_t>> vertices;  // and where it is
  for (std::uint32_t c = 0; c < surface.chunk_count(); ++c) chunks.push_back(surface.chunk(c).value());
  for (const SurfaceChunk& chunk : chunks)
    for (std::size_t v = 0; v < chunk.ids.size(); ++v) vertices.try_emplace(chunk.ids[v], &chunk, v);
  std::map<VertexId, std::uint32_t> number;
  for (const auto& [id, at] : vertices) {
    const auto& [chunk, v] = at;
    const auto n = static_cast<std::uint32_t>(out.positions.size());
    number[id] = n;
    out.wedge_group.push_back(n - chunk->wedge[v]);
    out.positions.push_back(chunk->vertices.positions[v]);
    if (!chunk->vertices.normals.empty())
      out.normals.push_back(decode_oct(chunk->vertices.normals[v], normal_bits));
    if (!chunk->vertices.colours.empty()) out.colours.push_back(chunk->vertices.colours[v]);
    if (!chunk->vertices.texcoords.empty())
      out.texcoords.push_back({static_cast<float>(chunk->vertices.texcoords[v][0]) / 65536,
                               static_cast<float>(chunk->vertices.texcoords[v][1]) / 65536});
  }
  for (const SurfaceChunk& chunk : chunks)
    for (const Triangle& t : chunk.triangles)
      out.triangles.push_back(
          {number.at(chunk.ids[t[0]]), number.at(chunk.ids[t[1]]), number.at(chunk.ids[t[2]])});
  sort_by_lowest_vertex(out.triangles, out.positions.size());
  return out;
}

Result<GridMesh> clean_mesh(const SurfaceMesh& mesh, const CleanOptions& options, CleanReport& report) {
  const auto path = scratch_path();
  auto folder = WorkFolder::open(path, "test");
  if (!folder) return fail(folder.error());
  MemoryBudget memory(std::uint64_t{1} << 30);
  auto surface = ingest(*folder,
                        {options.step, options.make_normals, options.chunk_triangles, options.block_vertices,
                         options.weld_tolerance},
                        memory, [&](RawSurface& sink) { return feed(mesh, sink); });
  Result<GridMesh> out;
  if (surface) {
    report = surface->report;
    out = put_together(*surface);
  } else {
    out = fail(surface.error());
  }
  folder->remove();
  return out;
}

}  // namespace cuesta::test
