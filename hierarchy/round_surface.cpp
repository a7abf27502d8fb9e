#include "hierarchy/round_surface.h"

#include <algorithm>

#include "hierarchy/substitution_kernel.h"
#include "ooc/triangle_order.h"

namespace cuesta {
namespace {

std::vector<std::uint8_t> shared_groups(const RoundSurface& surface, const GridMesh& mesh,
                                        const Partition& partition) {
  std::vector<std::uint32_t> user(mesh.positions.size(), none);
  std::vector<std::uint8_t> shared(mesh.positions.size(), 0);
  for (std::uint32_t c = 0; c < partition.cell_count(); ++c)
    for (std::uint32_t t : partition.cell(c))
      for (std::uint32_t v : surface.triangles[t]) {
        const std::uint32_t g = mesh.wedge_group[v];
        if (user[g] == none)
          user[g] = c;
        else if (user[g] != c)
          shared[g] = 1;
      }
  return shared;
}

std::vector<std::uint32_t> vertices_of(const RoundSurface& surface,
                                       std::span<const std::uint32_t> triangles) {
  std::vector<std::uint32_t> v;
  v.reserve(triangles.size() * 3);
  for (std::uint32_t t : triangles)
    v.insert(v.end(), surface.triangles[t].begin(), surface.triangles[t].end());
  std::sort(v.begin(), v.end());
  v.erase(std::unique(v.begin(), v.end()), v.end());
  return v;
}

std::uint32_t local_number(std::span<const std::uint32_t> vertices, std::uint32_t global) {
  return static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), global) -
                                    vertices.begin());
}

}  // namespace

std::vector<Vec3f> triangle_centres(std::span<const std::array<std::uint32_t, 3>> triangles,
                                    const GridMesh& mesh) {
  std::vector<Vec3f> centres;
  centres.reserve(triangles.size());
  for (const auto& t : triangles) {
    const Vec3d sum = vec_cast<double>(mesh.positions[t[0]]) + vec_cast<double>(mesh.positions[t[1]]) +
                      vec_cast<double>(mesh.positions[t[2]]);
    centres.push_back(vec_cast<float>(sum / 3.0));
  }
  return centres;
}

RoundCells::RoundCells(const RoundSurface& surface, const GridMesh& mesh, Partition partition)
    : surface_(surface),
      mesh_(mesh),
      partition_(std::move(partition)),
      shared_(shared_groups(surface, mesh, partition_)) {}

Cell RoundCells::cell(std::uint32_t c) const {
  const auto triangles = partition_.cell(c);
  Cell out;
  out.vertices = vertices_of(surface_, triangles);
  CellMesh& cell = out.mesh;
  std::uint32_t group = none, first_of_group = 0;
  for (std::uint32_t i = 0; i < out.vertices.size(); ++i) {
    const std::uint32_t v = out.vertices[i];
    if (mesh_.wedge_group[v] != group) {
      group = mesh_.wedge_group[v];
      first_of_group = i;
    }
    cell.positions.push_back(mesh_.positions[v]);
    cell.wedge_group.push_back(first_of_group);
    cell.locked.push_back(shared_[group]);
  }
  const bool first_round = surface_.births.empty();
  if (!first_round) cell.samples.begin.push_back(0);
  for (std::uint32_t t : triangles) {
    const auto& g = surface_.triangles[t];
    cell.triangles.push_back(
        smallest_first({local_number(out.vertices, g[0]), local_number(out.vertices, g[1]),
                        local_number(out.vertices, g[2])}));
    if (first_round) continue;
    cell.births.push_back(surface_.births[t]);
    const auto samples = surface_.samples.points.begin();
    cell.samples.points.insert(cell.samples.points.end(), samples + surface_.samples.begin[t],
                               samples + surface_.samples.begin[t + 1]);
    cell.samples.begin.push_back(static_cast<std::uint32_t>(cell.samples.points.size()));
  }
  if (first_round)
    cell.births.resize(triangles.size());
  else
    out.sources = sources_of(triangles, out.vertices);
  return out;
}

std::vector<PageId> RoundCells::source_pages(std::uint32_t c) const {
  std::vector<PageId> pages;
  if (surface_.origins.empty()) return pages;
  for (std::uint32_t t : partition_.cell(c))
    if (pages.empty() || pages.back() != surface_.origins[t].page) pages.push_back(surface_.origins[t].page);
  return pages;
}

std::vector<PageSource> RoundCells::sources_of(std::span<const std::uint32_t> triangles,
                                               std::span<const std::uint32_t> vertices) const {
  std::vector<PageSource> sources;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const TriangleOrigin origin = surface_.origins[triangles[i]];
    if (sources.empty() || sources.back().page != origin.page)
      sources.push_back({origin.page, i, {}, {}, {}});
    sources.back().triangles.push_back(origin.survivor);
  }
  for (PageSource& s : sources) {
    const auto& survivors = surface_.survivor_vertices[s.page - surface_.first_page];
    std::uint32_t local = 0;
    for (std::uint32_t i = 0; i < survivors.size(); ++i) {
      while (local < vertices.size() && vertices[local] < survivors[i]) ++local;
      if (local == vertices.size()) break;
      if (vertices[local] != survivors[i]) continue;
      s.vertices.push_back(i);
      s.local_vertices.push_back(local);
    }
  }
  return sources;
}

}  // namespace cuesta
