#include "hierarchy/build_hierarchy.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "hierarchy/bounding_sphere.h"
#include "hierarchy/directory.h"
#include "hierarchy/page_order.h"
#include "hierarchy/round_surface.h"
#include "hierarchy/simplify_cell.h"
#include "ooc/check.h"
#include "ooc/oct_normal.h"

namespace cuesta {
namespace {

/// What one cell's task gives: a page ready to be written, and what goes to the next round.
struct CellOutput {
  PageEntry entry;
  std::vector<std::byte> bytes;
  PageStreamBytes stream_bytes{};
  CellSurvivors survivors;                       // corners in global numbers
  std::vector<std::uint32_t> survivor_vertices;  // global
  std::uint64_t fans = 0, substitutions = 0;
};

OwnedVertices owned_attributes(const GridMesh& mesh, const Page& page,
                               std::span<const std::uint32_t> vertices) {
  OwnedVertices out;
  const auto owned = owned_vertices(page);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!owned[i]) continue;
    const std::uint32_t v = vertices[i];
    out.positions.push_back(mesh.positions[v]);
    if (!mesh.normals.empty()) out.normals.push_back(encode_oct(mesh.normals[v], normal_bits));
    if (!mesh.colours.empty()) out.colours.push_back(mesh.colours[v]);
    if (!mesh.texcoords.empty()) {
      const auto fixed = [](float f) {
        return static_cast<std::int32_t>(std::lround(std::clamp(f, -32767.0f, 32767.0f) * 65536.0));
      };
      out.texcoords.push_back({fixed(mesh.texcoords[v][0]), fixed(mesh.texcoords[v][1])});
    }
  }
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

CellOutput run_cell(Cell cell, const GridMesh& mesh, std::uint32_t round, bool base,
                    const BuildOptions& options) {
  Page page;
  page.round = round;
  page.base = base;
  page.vertex_count = static_cast<std::uint32_t>(cell.vertices.size());
  page.triangles = cell.mesh.triangles;
  page.sources = std::move(cell.sources);
  for (std::uint32_t v = 0; v < page.vertex_count; ++v)
    if (cell.mesh.wedge_group[v] != v) page.wedge_tails.push_back(v);
  const std::vector<Vec3i> positions = cell.mesh.positions;
  SimplifyOptions simplify;
  simplify.target_triangles =
      base ? 0
           : static_cast<std::uint32_t>(static_cast<double>(page.triangles.size()) / options.round_reduction);
  SimplifyResult simplified = simplify_cell(std::move(cell.mesh), simplify);
  page.script = std::move(simplified.script);
  if (!base) page.orphans = orphans_of(page, simplified.survivors);
  page.owned = owned_attributes(mesh, page, cell.vertices);

  CellOutput out;
  out.entry = describe(page, simplified.survivors, positions);
  out.bytes = encode_page(page, &out.stream_bytes);
  out.fans = page.script.fans.size();
  out.substitutions = page.script.children.size();
  if (base) return out;
  out.survivors = std::move(simplified.survivors);
  const auto owned = owned_vertices(page);
  for (std::uint32_t v = 0; v < page.vertex_count; ++v)
    if (!owned[v]) out.survivor_vertices.push_back(cell.vertices[v]);
  for (auto& t : out.survivors.corners) t = {cell.vertices[t[0]], cell.vertices[t[1]], cell.vertices[t[2]]};
  return out;
}

/// Moves a page's survivors to the end of the next round's surface.
void append_survivors(RoundSurface& next, CellOutput& out, PageId page) {
  const auto base = static_cast<std::uint32_t>(next.samples.points.size());
  if (next.samples.begin.empty()) next.samples.begin.push_back(0);
  const CellSurvivors& s = out.survivors;
  next.triangles.insert(next.triangles.end(), s.corners.begin(), s.corners.end());
  next.births.insert(next.births.end(), s.births.begin(), s.births.end());
  next.samples.points.insert(next.samples.points.end(), s.samples.points.begin(), s.samples.points.end());
  for (std::uint32_t i = 0; i < s.triangles.size(); ++i) {
    next.samples.begin.push_back(base + s.samples.begin[i + 1]);
    next.origins.push_back({page, i});
  }
  next.survivor_vertices.push_back(std::move(out.survivor_vertices));
  out.survivors = {};
}

/// Cells keep positions as floats about their own corner: exact up to this extent.
constexpr std::int64_t largest_extent = 1 << 24;
/// Rounds that may pass without losing a tenth of the triangles.
constexpr std::uint32_t patience = 2;

std::string extent_problem(const GridMesh& mesh) {
  Box3<std::int32_t> box;
  for (const Vec3i& p : mesh.positions) box.add(p);
  const Vec3<std::int64_t> e = vec_cast<std::int64_t>(box.hi) - vec_cast<std::int64_t>(box.lo);
  if (std::max({e.x, e.y, e.z}) < largest_extent) return "";
  return "the surface is " + std::to_string(std::max({e.x, e.y, e.z})) +
         " grid steps wide, at most 2^24 are possible; give a larger --step";
}

class HierarchyBuilder {
 public:
  HierarchyBuilder(GridMesh mesh, const BuildOptions& options, const BuildProgress& progress,
                   ContainerWriter writer)
      : mesh_(std::move(mesh)), options_(options), progress_(progress), writer_(std::move(writer)) {
    total_ = mesh_.triangles.size();
  }

  Result<BuildReport> run() {
    RoundSurface surface;
    Partition first_cells = order_for_pages(mesh_, options_.cell_triangles);
    surface.triangles = std::move(mesh_.triangles);
    std::uint32_t rounds_without_progress = 0;
    for (bool base = false; !base;) {
      // A surface that no longer gets smaller (thousands of knots, say) becomes a large base page.
      base = surface.triangles.size() <= options_.cell_triangles ||
             (rounds_without_progress >= patience && surface.triangles.size() <= max_page_elements / 4);
      if (rounds_without_progress > 2 * patience)
        return fail(ErrorCode::invalid_input, "", "round " + std::to_string(surface.round),
                    std::to_string(surface.triangles.size()) +
                        " triangles cannot be simplified any further: " + "more than fit a base page");
      auto next =
          run_round(surface, base, surface.round == 0 ? std::move(first_cells) : cells_of(surface, base));
      if (!next) return fail(next.error());
      const bool progress = next->triangles.size() <= surface.triangles.size() / 10 * 9;
      rounds_without_progress = progress ? 0 : rounds_without_progress + 1;
      surface = std::move(*next);
      ++report_.rounds;
    }
    if (auto r = finish(); !r) return fail(r.error());
    return report_;
  }

 private:
  Partition cells_of(const RoundSurface& surface, bool base) const {
    const auto all = static_cast<std::uint32_t>(surface.triangles.size());
    return partition_cells(triangle_centres(surface.triangles, mesh_), base ? all : options_.cell_triangles,
                           surface.round);
  }

  Result<RoundSurface> run_round(const RoundSurface& surface, bool base, Partition partition) {
    const RoundCells cells(surface, mesh_, std::move(partition));
    RoundSurface next;
    next.round = surface.round + 1;
    next.first_page = static_cast<PageId>(directory_.pages.size());
    // Batches bound what waits to be written; within one, cells are independent.
    constexpr std::uint32_t batch = 32;
    for (std::uint32_t first = 0; first < cells.cell_count(); first += batch) {
      const std::uint32_t last = std::min(first + batch, cells.cell_count());
      std::vector<CellOutput> outputs(last - first);
      tbb::parallel_for(first, last, [&](std::uint32_t c) {
        outputs[c - first] = run_cell(cells.cell(c), mesh_, surface.round, base, options_);
      });
      for (CellOutput& out : outputs) {
        if (auto r = write_page(out); !r) return fail(r.error());
        if (!base) append_survivors(next, out, static_cast<PageId>(directory_.pages.size() - 1));
      }
      if (auto r = report_progress(surface.round); !r) return fail(r.error());
    }
    link_sources(cells, next.first_page);
    return next;
  }

  /// A page's coarser pages are those that name it as a source.
  void link_sources(const RoundCells& cells, PageId first_page) {
    for (std::uint32_t c = 0; c < cells.cell_count(); ++c)
      for (PageId source : cells.source_pages(c)) directory_.pages[source].coarser.push_back(first_page + c);
  }

  Result<void> write_page(CellOutput& out) {
    auto ref = writer_.append(out.bytes);
    if (!ref) return fail(ref.error());
    out.entry.block = *ref;
    done_ += out.entry.owned_triangles;
    directory_.pages.push_back(std::move(out.entry));
    report_.fans += out.fans;
    report_.substitutions += out.substitutions;
    for (std::size_t s = 0; s < page_stream_count; ++s) report_.stream_bytes[s] += out.stream_bytes[s];
    out.bytes = {};
    return {};
  }

  Result<void> report_progress(std::uint32_t round) {
    if (progress_ && !progress_("round " + std::to_string(round), done_, total_))
      return fail(ErrorCode::cancelled, "", "", "stopped; nothing was written");
    return {};
  }

  /// A page is never wanted without the pages it leans on: their error and bound cover its own.
  void saturate_pages() {
    std::vector<std::vector<Sphere>> balls(directory_.pages.size());
    for (PageId id = 0; id < directory_.pages.size(); ++id) {
      PageEntry& e = directory_.pages[id];
      if (!balls[id].empty()) {
        balls[id].push_back(e.bound);
        const Vec3i at = vec_cast<std::int32_t>(e.bound.centre);
        e.bound = decode_sphere(enclose(balls[id], at), at);
      }
      for (PageId c : e.coarser) {
        PageEntry& coarser = directory_.pages[c];
        coarser.largest_error = std::max(coarser.largest_error, e.largest_error);
        balls[c].push_back(e.bound);
      }
    }
  }

  Result<void> finish() {
    saturate_pages();
    directory_.grid = mesh_.grid;
    Box3<std::int32_t> box;
    for (const Vec3i& p : mesh_.positions) box.add(p);
    directory_.lo = box.lo;
    directory_.hi = box.hi;
    directory_.vertices = mesh_.positions.size();
    directory_.triangles = total_;
    directory_.has_normals = !mesh_.normals.empty();
    directory_.has_colours = !mesh_.colours.empty();
    directory_.has_texcoords = !mesh_.texcoords.empty();
    directory_.metadata = options_.metadata;
    const auto bytes = encode_directory(directory_);
    if (auto r = writer_.finish(bytes); !r) return r;
    report_.pages = static_cast<std::uint32_t>(directory_.pages.size());
    report_.file_bytes = writer_.bytes_written();
    return {};
  }

  GridMesh mesh_;
  const BuildOptions& options_;
  const BuildProgress& progress_;
  ContainerWriter writer_;
  Directory directory_;
  BuildReport report_;
  std::uint64_t done_ = 0, total_ = 0;
};

}  // namespace

Result<BuildReport> build_hierarchy(GridMesh mesh, const std::filesystem::path& path,
                                    const BuildOptions& options, const BuildProgress& progress) {
  CUESTA_CHECK(!mesh.triangles.empty());
  CUESTA_CHECK(options.round_reduction > 1, options.round_reduction);
  if (auto problem = extent_problem(mesh); !problem.empty())
    return fail(ErrorCode::invalid_input, path.string(), "", std::move(problem));
  auto writer = ContainerWriter::create(path);
  if (!writer) return fail(writer.error());
  return HierarchyBuilder(std::move(mesh), options, progress, std::move(*writer)).run();
}

}  // namespace cuesta
