#include "apps/web/web_surface.h"

#include <nlohmann/json.hpp>

#include "apps/overview/file_facts.h"
#include "apps/overview/sketch.h"
#include "apps/view/surface_ray.h"
#include "apps/web/words.h"
#include "runtime/draw/upload_ranges.h"
#include "runtime/view_fit.h"

namespace cuesta::web {
namespace {

using nlohmann::json;

/// How much coarser what is outside the picture may be, as of the other programs.
constexpr double outside_factor = 4;
constexpr std::uint32_t gap_bytes = 2048;  // between changes, rather copied than told apart
constexpr std::size_t most_ranges = 512;

json list(Vec3d v) {
  return {v.x, v.y, v.z};
}

json relief_json(const terrain_view::TerrainLook& look) {
  const Relief& r = look.relief;
  return {{"origin", list(r.origin)},
          {"axes", {list(r.axes[0]), list(r.axes[1]), list(r.axes[2])}},
          {"equatorialRadius", r.equatorial_radius},
          {"polarRadius", r.polar_radius},
          {"least", look.facts.least_m},
          {"most", look.facts.most_m},
          {"seaLevel", look.facts.sea_level_m},
          {"vertexColours", look.has_colours}};
}

/// Vertices in the middle of a blend, neighbours together.
std::vector<Range> slots_of(std::span<const MorphedVertex> morphed) {
  std::vector<Range> ranges;
  for (const MorphedVertex& m : morphed) {
    if (!ranges.empty() && ranges.back().first + ranges.back().count == m.slot)
      ++ranges.back().count;
    else
      ranges.push_back({m.slot, 1});
  }
  return ranges;
}

}  // namespace

Result<std::optional<ByteRange>> WebSurface::open(std::uint64_t cache_bytes) {
  auto file = CuestaFile::open(bytes_);
  if (!file && bytes_->missing()) return bytes_->missing();
  if (!file) return fail(file.error());
  const BlockRef& base = file->directory().pages[file->directory().base()].block;
  if (!bytes_->has({base.offset, base.bytes})) return std::optional(ByteRange{base.offset, base.bytes});
  auto look = terrain_view::terrain_look(file->directory(), bytes_->path());
  if (!look) return fail(look.error());
  auto cut = Cut::open(std::move(*file), cache_bytes, clock_, [&](const CuestaFile& f, GeometryPool& pool) {
    auto loader = std::make_unique<DeliveredLoader>(f, pool, *bytes_);
    loader_ = loader.get();
    return loader;
  });
  if (!cut) return fail(cut.error());
  bytes_->forget();
  cut_ = std::move(*cut);
  look_ = std::move(*look);
  sketch_ = app::sketch_points(*cut_);
  return std::optional<ByteRange>();
}

std::optional<terrain_view::TerrainLook> WebSurface::look(double exaggeration) const {
  auto look = look_;
  if (look) look->relief.exaggeration = exaggeration;
  return look;
}

std::string WebSurface::facts() const {
  const Directory& d = cut_->directory();
  const Box3d box = app::world_box(d);
  json rounds = json::array();
  for (const PageEntry& e : d.pages) rounds.push_back(e.round);
  json facts{{"vertices", d.vertices},
             {"triangles", d.triangles},
             {"bytes", bytes_->size()},
             {"box", {list(box.lo), list(box.hi)}},
             {"grid", {{"origin", list(d.grid.origin)}, {"step", d.grid.step}}},
             {"normals", d.has_normals},
             {"colours", d.has_colours},
             {"rounds", std::move(rounds)}};
  if (look_) facts["relief"] = relief_json(*look_);
  return facts.dump();
}

View WebSurface::first_view(const View& view, double exaggeration) const {
  if (const auto terrain = look(exaggeration)) return terrain_view::first_view(*terrain, sketch_, view);
  return fit_view(sketch_, three_quarter_direction(view.up), view);
}

WebSurface::Step WebSurface::step(const Aim& aim) {
  const Grid& grid = cut_->directory().grid;
  auto scale = ErrorScale::perspective(grid, aim.view, outside_factor);
  if (const auto terrain = look(aim.exaggeration)) scale = scale.exaggerated(grid, terrain->relief);
  cut_->set_geomorph_ms(aim.geomorph_ms);
  const AdaptReport report = cut_->adapt(scale, aim.tau_px, aim.budgets);
  const bool first = words_.empty();
  drawn_ = cut_->draw_list();
  tell_changes(first);
  return {report, words_};
}

void WebSurface::tell_changes(bool whole) {
  const DrawList& all = drawn_;
  std::vector<Range> vertices{{0, static_cast<std::uint32_t>(all.vertices.size())}};
  std::vector<Range> indices{{0, static_cast<std::uint32_t>(all.indices.size())}};
  if (!whole) {
    vertices = coalesce(all.changed_vertices, gap_bytes / sizeof(DrawVertex), most_ranges);
    indices = coalesce(all.changed_indices, gap_bytes / sizeof(std::uint32_t), most_ranges);
  }
  const auto morphed = slots_of(all.morphed);
  Words out(words_);
  for (const std::size_t n : {vertices.size() + morphed.size(), indices.size(), all.draws.size(),
                              all.vertices.size(), all.indices.size()})
    out.put(n);
  for (const std::span<const Range> ranges :
       {std::span<const Range>(vertices), std::span<const Range>(morphed), std::span<const Range>(indices),
        all.draws})
    out.put(ranges);
  out.put_elements(all.draw_pages);
  out.put_elements(all.vertices, vertices);
  for (const MorphedVertex& m : all.morphed) out.put_elements(std::span(&m.vertex, 1));
  out.put_elements(all.indices, indices);
}

std::optional<double> WebSurface::distance_along(Vec3d origin, Vec3d direction, double exaggeration) const {
  const auto terrain = look(exaggeration);
  return view::distance_along(drawn_, cut_->directory(), origin, direction,
                              terrain ? std::optional(terrain->relief) : std::nullopt);
}

std::string WebSurface::place(Vec3d p, double exaggeration) const {
  const auto terrain = look(exaggeration);
  return terrain ? terrain_view::place_text(*terrain, terrain->relief.lowered(p)) : std::string();
}

}  // namespace cuesta::web
