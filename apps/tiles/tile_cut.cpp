#include "apps/tiles/tile_cut.h"

#include <algorithm>
#include <limits>
#include <string>

namespace cuesta::tiles {
namespace {

constexpr std::uint32_t not_used = std::numeric_limits<std::uint32_t>::max();

}  // namespace

Result<std::unique_ptr<TileCut>> TileCut::open(const std::filesystem::path& file, std::uint64_t cache_bytes) {
  auto opened = CuestaFile::open(file);
  if (!opened) return fail(opened.error());
  auto cut = Cut::open(std::move(*opened), cache_bytes, [] { return 0.0; });
  if (!cut) return fail(cut.error());
  return std::unique_ptr<TileCut>(new TileCut(std::move(*cut)));
}

Result<TileMesh> TileCut::around(const SurfacePart& part, double error, double border_share) {
  const ErrorScale scale = ErrorScale::part(directory().grid, part, border_share);
  AdaptReport report;
  do report = cut_->adapt(scale, error, {});
  while (!report.settled && report.bound_by != Binding::resident_bytes && cut_->cache().errors().empty());
  if (const auto errors = cut_->cache().errors(); !errors.empty()) return fail(errors.front());
  if (report.bound_by == Binding::resident_bytes)
    return fail(ErrorCode::out_of_budget, "", "",
                "a tile does not fit the page cache of " + std::to_string(cut_->cache().budget_bytes()) +
                    " bytes; give more with --cache, or ask for smaller tiles");
  TileMesh mesh = drawn(part);
  if (!directory().has_normals) {
    sort(mesh);
    add_normals(mesh);
  }
  return mesh;
}

Result<TilePiece> TileCut::piece(const SurfacePart& part, double error, double border_share) {
  auto mesh = around(part, error, border_share);
  if (!mesh) return fail(mesh.error());
  TilePiece piece{std::move(*mesh)};
  // A vertex of the file at the border is near to a point of the mesh that is this far outside at most.
  const Grid& grid = directory().grid;
  const double least = (error * border_share + grid.snap_error()) / grid.step;
  piece.margin = least;
  for (const PartBorder& b : part.borders) {
    const double margin = least + bow(piece.mesh, b);
    piece.margin = std::max(piece.margin, margin);
    clip(piece.mesh, b, margin);
  }
  piece.margin += 1;  // new vertices are on the grid
  sort(piece.mesh);
  return piece;
}

/// The triangles of all pages that reach into the part.
TileMesh TileCut::drawn(const SurfacePart& part) {
  const DrawList list = cut_->draw_list();
  number_.resize(list.vertices.size(), not_used);
  TileMesh mesh;
  std::vector<std::uint32_t> slots;
  const auto vertex = [&](std::uint32_t slot) {
    if (number_[slot] == not_used) {
      number_[slot] = static_cast<std::uint32_t>(slots.size());
      slots.push_back(slot);
      mesh.vertices.push_back(list.vertices[slot]);
    }
    return number_[slot];
  };
  for (std::size_t i = 0; i < list.draws.size(); ++i) {
    if (part.place(directory().pages[list.draw_pages[i]].bound) == SurfacePart::Place::outside) continue;
    const auto run = list.indices.subspan(list.draws[i].first, list.draws[i].count);
    for (std::size_t k = 0; k + 2 < run.size(); k += 3)
      mesh.triangles.push_back({vertex(run[k]), vertex(run[k + 1]), vertex(run[k + 2])});
  }
  for (const std::uint32_t slot : slots) number_[slot] = not_used;
  return mesh;
}

}  // namespace cuesta::tiles
