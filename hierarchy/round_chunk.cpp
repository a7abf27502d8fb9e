#include "hierarchy/round_chunk.h"

#include <algorithm>

#include "hierarchy/substitution_kernel.h"

namespace cuesta {
namespace {

/// The vertices of some triangles in ascending order, and their numbers among them.
class VertexSubset {
 public:
  VertexSubset(const RoundChunk& chunk, std::span<const std::uint32_t> triangles)
      : number_(chunk.ids.size(), none) {
    for (std::uint32_t t : triangles)
      for (std::uint32_t v : chunk.triangles[t]) number_[v] = 0;
    for (std::uint32_t v = 0; v < number_.size(); ++v) {
      if (number_[v] == none) continue;
      number_[v] = static_cast<std::uint32_t>(vertices_.size());
      vertices_.push_back(v);
    }
  }
  std::uint32_t number(std::uint32_t v) const { return number_[v]; }
  std::vector<std::uint32_t> take() { return std::move(vertices_); }
  const std::vector<std::uint32_t>& vertices() const { return vertices_; }

 private:
  std::vector<std::uint32_t> number_;
  std::vector<std::uint32_t> vertices_;
};

std::vector<std::uint32_t> groups_of(const RoundChunk& chunk) {
  std::vector<std::uint32_t> group(chunk.ids.size());
  for (std::uint32_t v = 0; v < group.size(); ++v)
    group[v] = v > 0 && chunk.group_id(v) == chunk.group_id(v - 1) ? group[v - 1] : v;
  return group;
}

/// Groups that triangles of other chunks, or of two cells, use.
std::vector<std::uint8_t> locked_groups(const RoundChunk& chunk, std::span<const std::uint32_t> group,
                                        const Partition& partition) {
  std::vector<std::uint8_t> locked(group.size(), 0);
  for (std::uint32_t v = 0; v < group.size(); ++v) locked[group[v]] |= chunk.locked[v];
  std::vector<std::uint32_t> user(group.size(), none);
  for (std::uint32_t c = 0; c < partition.cell_count(); ++c)
    for (std::uint32_t t : partition.cell(c))
      for (std::uint32_t v : chunk.triangles[t]) {
        const std::uint32_t g = group[v];
        if (user[g] == none)
          user[g] = c;
        else if (user[g] != c)
          locked[g] = 1;
      }
  return locked;
}

}  // namespace

std::vector<Vec3f> triangle_centres(std::span<const Triangle> triangles, std::span<const Vec3i> positions) {
  std::vector<Vec3f> centres;
  centres.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const Vec3d sum = vec_cast<double>(positions[t[0]]) + vec_cast<double>(positions[t[1]]) +
                      vec_cast<double>(positions[t[2]]);
    centres.push_back(vec_cast<float>(sum / 3.0));
  }
  return centres;
}

RoundCells::RoundCells(const RoundChunk& chunk, Partition partition)
    : chunk_(chunk),
      partition_(std::move(partition)),
      group_(groups_of(chunk)),
      locked_(locked_groups(chunk, group_, partition_)) {}

Cell RoundCells::cell(std::uint32_t c) const {
  const auto triangles = partition_.cell(c);
  VertexSubset subset(chunk_, triangles);
  Cell out;
  CellMesh& cell = out.mesh;
  const std::size_t vertices = subset.vertices().size();
  cell.positions.reserve(vertices);
  cell.wedge_group.reserve(vertices);
  cell.locked.reserve(vertices);
  std::uint32_t group = none, first_of_group = 0;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    const std::uint32_t v = subset.vertices()[i];
    if (group_[v] != group) {
      group = group_[v];
      first_of_group = i;
    }
    cell.positions.push_back(chunk_.vertices.positions[v]);
    cell.wedge_group.push_back(first_of_group);
    cell.locked.push_back(locked_[group]);
  }
  const bool first_round = chunk_.births.empty();
  if (!first_round) cell.samples.begin.push_back(0);
  cell.triangles.reserve(triangles.size());
  for (std::uint32_t t : triangles) {
    const Triangle& g = chunk_.triangles[t];
    cell.triangles.push_back(smallest_first({subset.number(g[0]), subset.number(g[1]), subset.number(g[2])}));
    if (first_round) continue;
    cell.births.push_back(chunk_.births[t]);
    const auto samples = chunk_.samples.points.begin();
    cell.samples.points.insert(cell.samples.points.end(), samples + chunk_.samples.begin[t],
                               samples + chunk_.samples.begin[t + 1]);
    cell.samples.begin.push_back(static_cast<std::uint32_t>(cell.samples.points.size()));
  }
  out.vertices = subset.take();
  if (first_round)
    cell.births.resize(triangles.size());
  else
    out.sources = sources_of(triangles, out.vertices);
  return out;
}

std::vector<PageSource> RoundCells::sources_of(std::span<const std::uint32_t> triangles,
                                               std::span<const std::uint32_t> vertices) const {
  std::vector<PageSource> sources;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const TriangleOrigin origin = chunk_.origins[triangles[i]];
    if (sources.empty() || sources.back().page != origin.page)
      sources.push_back({origin.page, i, {}, {}, {}});
    sources.back().triangles.push_back(origin.survivor);
  }
  auto survivors = chunk_.sources.begin();
  for (PageSource& s : sources) {
    while (survivors->page != s.page) ++survivors;
    std::uint32_t local = 0;
    for (std::uint32_t i = 0; i < survivors->ids.size(); ++i) {
      while (local < vertices.size() && chunk_.ids[vertices[local]] < survivors->ids[i]) ++local;
      if (local == vertices.size()) break;
      if (chunk_.ids[vertices[local]] != survivors->ids[i]) continue;
      s.vertices.push_back(i);
      s.local_vertices.push_back(local);
    }
  }
  return sources;
}

}  // namespace cuesta
