#include "terrain/terrain_surface.h"

#include <algorithm>
#include <cmath>

#include "ooc/ordered_tasks.h"
#include "terrain/posting_measure.h"
#include "terrain/terrain_chunk.h"

namespace cuesta {
namespace {

std::vector<SeamTriangle> by_square(std::span<const SeamTriangle> seams, const LatticeSquares& squares) {
  const auto square_of = [&](const SeamTriangle& t) {
    return squares.number_at(t[0].layer, t[0].column, t[0].row);
  };
  std::vector<SeamTriangle> out(seams.begin(), seams.end());
  std::stable_sort(out.begin(), out.end(),
                   [&](const SeamTriangle& a, const SeamTriangle& b) { return square_of(a) < square_of(b); });
  return out;
}

}  // namespace

TerrainSurface::TerrainSurface(const Mosaic& mosaic, const Frame& frame, const TerrainOptions& options,
                               PostingStore store)
    : layers_(mosaic.layers()),
      frame_(frame),
      options_(options),
      store_(std::move(store)),
      pole_fans_(layers_.size()),
      seams_(by_square(mosaic.seams(), store_.squares())),
      seam_fans_(seams_) {
  for (const MosaicLayer& layer : layers_) positions_.emplace_back(frame, layer.crs, layer.map);
  for (const SeamTriangle& t : seams_)
    seam_squares_.push_back(store_.squares().number_at(t[0].layer, t[0].column, t[0].row));
}

PostingRef TerrainSurface::place(std::uint32_t layer, std::int64_t column, std::int64_t row) const {
  const MosaicLayer& l = layers_[layer];
  const auto width = static_cast<std::int64_t>(l.width);
  if (l.closes()) column = (column % width + width) % width;
  PostingRef at{layer, static_cast<std::uint64_t>(column), static_cast<std::uint64_t>(row)};
  if (!is_pole(layer, at.row)) return at;
  const auto& fans = pole_fans_at(at);
  const auto after = std::upper_bound(fans.begin(), fans.end(), at.column);
  // Around the Earth the last fan goes on in the first cells.
  at.column = fans.empty() ? 0 : after == fans.begin() ? fans.back() : *std::prev(after);
  return at;
}

bool TerrainSurface::is_pole(std::uint32_t layer, std::uint64_t row) const {
  const MosaicLayer& l = layers_[layer];
  return (l.north_pole && row == 0) || (l.south_pole && row + 1 == l.height);
}

bool TerrainSurface::is_pole_vertex(const PostingRef& at) const {
  const auto& fans = pole_fans_at(at);
  return std::binary_search(fans.begin(), fans.end(), at.column);
}

Result<void> TerrainSurface::find_pole_fans() {
  for (std::uint32_t l = 0; l < layers_.size(); ++l) {
    const auto find = [&](bool is_there, std::uint64_t row,
                          std::vector<std::uint64_t>& fans) -> Result<void> {
      if (!is_there || layers_[l].height < 2) return {};
      auto found = pole_fans(l, row);
      if (!found) return fail(found.error());
      fans = std::move(*found);
      return {};
    };
    if (auto r = find(layers_[l].north_pole, 0, pole_fans_[l].north); !r) return r;
    if (auto r = find(layers_[l].south_pole, layers_[l].height - 1, pole_fans_[l].south); !r) return r;
  }
  return {};
}

Result<std::vector<std::uint64_t>> TerrainSurface::pole_fans(std::uint32_t l, std::uint64_t pole_row) const {
  const MosaicLayer& layer = layers_[l];
  const auto pole = static_cast<std::int64_t>(pole_row);
  std::vector<float> at_pole(layer.width + 1), beside(layer.width + 1);
  if (auto r = store_.read(l, 0, pole, layer.width + 1, 1, at_pole); !r) return fail(r.error());
  if (auto r = store_.read(l, 0, pole == 0 ? 1 : pole - 1, layer.width + 1, 1, beside); !r)
    return fail(r.error());
  const auto is_in = [&](std::uint64_t cell) {
    return std::isfinite(beside[cell]) && std::isfinite(beside[cell + 1]) &&
           (std::isfinite(at_pole[cell]) || std::isfinite(at_pole[cell + 1]));
  };
  std::vector<std::uint64_t> fans;
  bool any = false;
  for (std::uint64_t cell = 0; cell < layer.width; ++cell) {
    if (!is_in(cell)) continue;
    any = true;
    const bool joins = cell > 0 ? is_in(cell - 1) : layer.closes() && is_in(layer.width - 1);
    if (!joins) fans.push_back(cell);
  }
  if (any && fans.empty()) fans.push_back(0);
  return fans;
}

VertexId TerrainSurface::id_of(const PostingRef& at, std::uint32_t fan) const {
  const std::uint64_t side = store_.squares().side();
  const std::uint32_t chunk = store_.chunk_of(store_.squares().number_at(at.layer, at.column, at.row));
  const std::uint32_t column = store_.squares().column_within(at.layer, at.column),
                      row = store_.squares().row_within(at.layer, at.row);
  return vertex_id(chunk, static_cast<std::uint32_t>((fan * side + row) * side + column));
}

std::span<const SeamTriangle> TerrainSurface::seams_of(std::uint32_t chunk) const {
  const auto [first, last] =
      std::equal_range(seam_squares_.begin(), seam_squares_.end(), store_.square_of(chunk));
  return std::span(seams_).subspan(static_cast<std::size_t>(first - seam_squares_.begin()),
                                   static_cast<std::size_t>(last - first));
}

PoleRows TerrainSurface::pole_rows(std::uint32_t layer, std::int64_t first_row) const {
  const MosaicLayer& l = layers_[layer];
  PoleRows poles;
  if (l.north_pole && first_row <= 1) poles.north = -first_row;
  if (l.south_pole) poles.south = static_cast<std::int64_t>(l.height) - 1 - first_row;
  return poles;
}

/// From the four cells around a posting.
Result<CellFans> TerrainSurface::cell_fans(const PostingRef& at) const {
  const auto column = static_cast<std::int64_t>(at.column) - 1, row = static_cast<std::int64_t>(at.row) - 1;
  const LatticeSquare around{at.layer, static_cast<std::uint64_t>(column), static_cast<std::uint64_t>(row), 2,
                             2};
  const auto window = read_postings(store_, positions_[at.layer], around);
  if (!window) return fail(window.error());
  CellFans fans;
  LatticePatch(2, 2, window->has_height, pole_rows(at.layer, row))
      .for_triangles([&](const std::array<LatticePatch::Corner, 3>& corners) {
        for (std::size_t k = 0; k < 3; ++k) {
          if (corners[k].x != 1 || corners[k].y != 1) continue;
          for (const LatticePatch::Corner& c : {corners[(k + 1) % 3], corners[(k + 2) % 3]})
            fans.others[corners[k].fan].push_back(place(at.layer, column + c.x, row + c.y));
        }
      });
  return fans;
}

Result<void> TerrainSurface::find_seam_fans() {
  const auto postings = seam_fans_.postings();
  std::vector<SeamFans::Split> splits(postings.size());
  const auto found = run_all(postings.size(), arena_threads(), [&](std::uint64_t i) -> Result<void> {
    const auto cells = cell_fans(postings[i]);
    if (!cells) return fail(cells.error());
    splits[i] = seam_fans_.split(i, *cells, seams_);
    return {};
  });
  if (!found) return found;
  seam_fans_.keep(std::move(splits));
  return {};
}

Result<SurfaceChunk> TerrainSurface::chunk(std::uint32_t c) const {
  return TerrainChunk(*this, c).make();
}

Result<void> TerrainSurface::measure(std::span<const std::array<Vec3i, 3>> corners,
                                     std::span<float> distances) const {
  return PostingMeasure(*this).measure(corners, distances);
}

Result<std::vector<std::optional<std::vector<Vec3i>>>> TerrainSurface::postings_over(
    std::span<const std::array<Vec3i, 3>> corners, std::size_t most) const {
  return PostingMeasure(*this).postings_over(corners, most);
}

}  // namespace cuesta
