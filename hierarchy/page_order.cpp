#include "hierarchy/page_order.h"

#include <meshoptimizer.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "hierarchy/round_surface.h"

namespace cuesta {
namespace {

using Corners = std::array<std::uint32_t, 3>;

/// A cell's triangles in strip order.
void put_into_strips(std::span<Corners> cell) {
  std::vector<std::uint32_t> vertices;
  vertices.reserve(cell.size() * 3);
  for (const Corners& t : cell) vertices.insert(vertices.end(), t.begin(), t.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<std::uint32_t> local;
  local.reserve(cell.size() * 3);
  for (const Corners& t : cell)
    for (std::uint32_t v : t)
      local.push_back(static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) -
                                                 vertices.begin()));
  std::vector<std::uint32_t> ordered(local.size());
  meshopt_optimizeVertexCacheStrip(ordered.data(), local.data(), local.size(), vertices.size());
  for (std::size_t i = 0; i < cell.size(); ++i)
    cell[i] = {vertices[ordered[i * 3]], vertices[ordered[i * 3 + 1]], vertices[ordered[i * 3 + 2]]};
}

/// Old number of each new vertex: by first use, the vertices of a group together.
std::vector<std::uint32_t> by_first_use(const GridMesh& mesh) {
  std::vector<std::uint32_t> order;
  order.reserve(mesh.positions.size());
  std::vector<std::uint8_t> known(mesh.positions.size(), 0);
  for (const Corners& t : mesh.triangles)
    for (std::uint32_t v : t) {
      const std::uint32_t group = mesh.wedge_group[v];
      if (known[group]) continue;
      known[group] = 1;
      for (std::uint32_t w = group; w < mesh.wedge_group.size() && mesh.wedge_group[w] == group; ++w)
        order.push_back(w);
    }
  return order;
}

template <class T>
void permute(std::vector<T>& values, std::span<const std::uint32_t> order) {
  if (values.empty()) return;
  std::vector<T> out;
  out.reserve(order.size());
  for (std::uint32_t old : order) out.push_back(values[old]);
  values = std::move(out);
}

void renumber(GridMesh& mesh) {
  const auto order = by_first_use(mesh);
  std::vector<std::uint32_t> now(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) now[order[i]] = i;
  permute(mesh.positions, order);
  permute(mesh.normals, order);
  permute(mesh.colours, order);
  permute(mesh.texcoords, order);
  permute(mesh.wedge_group, order);
  for (std::uint32_t& g : mesh.wedge_group) g = now[g];
  for (Corners& t : mesh.triangles) t = {now[t[0]], now[t[1]], now[t[2]]};
}

}  // namespace

Partition order_for_pages(GridMesh& mesh, std::uint32_t cell_triangles) {
  Partition cells = partition_cells(triangle_centres(mesh.triangles, mesh), cell_triangles, 0);
  std::vector<Corners> ordered;
  ordered.reserve(mesh.triangles.size());
  for (std::uint32_t t : cells.order) ordered.push_back(mesh.triangles[t]);
  mesh.triangles = std::move(ordered);
  std::iota(cells.order.begin(), cells.order.end(), 0u);
  tbb::parallel_for(0u, cells.cell_count(), [&](std::uint32_t c) {
    put_into_strips(std::span(mesh.triangles).subspan(cells.begin[c], cells.begin[c + 1] - cells.begin[c]));
  });
  renumber(mesh);
  return cells;
}

}  // namespace cuesta
