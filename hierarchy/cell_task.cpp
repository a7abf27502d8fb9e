#include "hierarchy/cell_task.h"

#include <algorithm>

#include "hierarchy/bounding_sphere.h"
#include "hierarchy/exact_errors.h"
#include "hierarchy/simplify_cell.h"

namespace cuesta {
namespace {

VertexTable owned_vertices_of(const Page& page, std::span<const std::uint8_t> owned, const RoundChunk& chunk,
                              std::span<const std::uint32_t> vertices) {
  VertexTable out;
  out.reserve(page.script.children.size() + page.orphans.size(), chunk.vertices.attributes());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (owned[i]) out.append(chunk.vertices, vertices[i]);
  return out;
}

/// Ball around all fans and all vertices of the page.
Sphere page_bound(const Page& page, std::span<const Vec3i> positions) {
  std::vector<Sphere> balls;
  Box3<float> box;
  for (const Vec3i& p : positions) box.add(vec_cast<float>(p));
  const Vec3f centre = (box.lo + box.hi) * 0.5f;
  balls.push_back({centre, length(box.hi - box.lo) * 0.5f * (1 + 1e-6f)});
  for (const Fan& fan : page.script.fans) balls.push_back(decode_sphere(fan.sphere, positions[fan.centre]));
  // Few distinct balls matter; the directory keeps the ball decoded.
  const Vec3i at = vec_cast<std::int32_t>(centre);
  return decode_sphere(enclose(balls, at), at);
}

PageEntry describe(const Page& page, const CellSurvivors& survivors, std::span<const Vec3i> positions) {
  PageEntry e;
  e.round = page.round;
  e.vertices = page.vertex_count;
  e.triangles = static_cast<std::uint32_t>(page.triangles.size());
  e.owned_vertices = static_cast<std::uint32_t>(page.owned.positions.size());
  e.owned_triangles =
      page.base ? e.triangles : e.triangles - static_cast<std::uint32_t>(survivors.triangles.size());
  e.bound = page_bound(page, positions);
  if (page.script.children.empty()) return e;
  const auto [least, largest] =
      std::minmax_element(page.script.children.begin(), page.script.children.end(),
                          [](const Child& a, const Child& b) { return a.error < b.error; });
  e.least_error = least->error;
  e.largest_error = largest->error;
  return e;
}

/// Local numbers of the vertices that no surviving triangle uses and no substitution removed.
std::vector<std::uint32_t> orphans_of(const Page& page, const CellSurvivors& survivors) {
  std::vector<std::uint8_t> kept(page.vertex_count, 0);
  for (const Child& c : page.script.children) kept[c.vertex] = 1;
  for (const auto& t : survivors.corners)
    for (std::uint32_t v : t) kept[v] = 1;
  std::vector<std::uint32_t> orphans;
  for (std::uint32_t v = 0; v < page.vertex_count; ++v)
    if (!kept[v]) orphans.push_back(v);
  return orphans;
}

PageSurvivors survivors_of(CellSurvivors left, std::span<const std::uint8_t> owned, const RoundChunk& chunk,
                           std::span<const std::uint32_t> vertices) {
  PageSurvivors out;
  std::vector<std::uint32_t> number(vertices.size());
  out.vertices.reserve(vertices.size(), chunk.vertices.attributes());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (owned[v]) continue;
    number[v] = static_cast<std::uint32_t>(out.ids.size());
    out.ids.push_back(chunk.ids[vertices[v]]);
    out.wedge.push_back(chunk.wedge[vertices[v]]);
    out.vertices.append(chunk.vertices, vertices[v]);
  }
  out.triangles = std::move(left.corners);
  for (Triangle& t : out.triangles) t = {number[t[0]], number[t[1]], number[t[2]]};
  out.births = std::move(left.births);
  out.samples = std::move(left.samples);
  return out;
}

/// What planning the next round needs of the survivors.
void describe_survivors(const PageSurvivors& survivors, std::uint32_t next_round, CellFacts& facts) {
  facts.survivor_triangles = static_cast<std::uint32_t>(survivors.triangles.size());
  const Axes axes = axes_of(next_round);
  for (const Vec3i& p : survivors.vertices.positions) facts.survivor_box.add(turn(axes, vec_cast<float>(p)));
  // Chunks own triangles by their centres, which rounding can put a little outside the box of the corners.
  const auto centres = triangle_centres(survivors.triangles, survivors.vertices.positions);
  for (const Vec3f& c : centres) facts.survivor_box.add(turn(axes, c));
  for (std::size_t t = 0; t < centres.size(); t += centre_stride) facts.centres.push_back(centres[t]);
}

}  // namespace

Result<CellOutput> run_cell_task(Cell cell, const RoundChunk& chunk, const InputSurface& surface,
                                 const CellOptions& options) {
  Page page;
  page.round = options.round;
  page.base = options.base;
  page.vertex_count = static_cast<std::uint32_t>(cell.vertices.size());
  page.triangles = cell.mesh.triangles;
  page.sources = std::move(cell.sources);
  for (std::uint32_t v = 0; v < page.vertex_count; ++v)
    if (cell.mesh.wedge_group[v] != v) page.wedge_tails.push_back(v);
  const std::vector<Vec3i> positions = cell.mesh.positions;
  cell.mesh.vertical = surface.vertical;
  CellMesh before;
  if (surface.vertical) before = cell.mesh;
  SimplifyOptions simplify;
  if (!options.base)
    simplify.target_triangles =
        static_cast<std::uint32_t>(static_cast<double>(page.triangles.size()) / options.round_reduction);
  SimplifyResult simplified = options.cache ? options.cache->simplify(std::move(cell.mesh), simplify)
                                            : simplify_cell(std::move(cell.mesh), simplify);
  page.script = std::move(simplified.script);
  if (simplified.errors_are_estimates && surface.vertical)
    if (auto r = make_errors_exact(surface, before, page, simplified.survivors); !r) return fail(r.error());
  if (!options.base) page.orphans = orphans_of(page, simplified.survivors);
  const auto owned = owned_vertices(page);
  page.owned = owned_vertices_of(page, owned, chunk, cell.vertices);
  for (std::uint32_t v = 0; v < page.vertex_count; ++v)
    if (!owned[v]) page.survivors.push_back(positions[v]);

  CellOutput out;
  out.facts.entry = describe(page, simplified.survivors, positions);
  out.page = encode_page(page, &out.facts.stream_bytes);
  for (const PageSource& s : page.sources) out.facts.sources.push_back(s.page);
  out.facts.fans = page.script.fans.size();
  out.facts.substitutions = page.script.children.size();
  if (options.base) return out;
  const PageSurvivors survivors = survivors_of(std::move(simplified.survivors), owned, chunk, cell.vertices);
  describe_survivors(survivors, options.round + 1, out.facts);
  out.survivors = encode_survivors(survivors);
  return out;
}

}  // namespace cuesta
