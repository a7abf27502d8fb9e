#include "terrain/terrain_surface.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "terrain/posting_measure.h"
#include "terrain/terrain_chunk.h"

namespace cuesta {
namespace {

auto order_of(const PostingRef& p) {
  return std::tuple(p.layer, p.row, p.column);
}
bool before(const PostingRef& a, const PostingRef& b) {
  return order_of(a) < order_of(b);
}

}  // namespace

TerrainSurface::TerrainSurface(const Mosaic& mosaic, const Frame& frame, const TerrainOptions& options,
                               PostingStore store)
    : layers_(mosaic.layers()), frame_(frame), options_(options), store_(std::move(store)) {
  for (const MosaicLayer& layer : layers_) positions_.emplace_back(frame, layer.crs, layer.map);
  seams_.assign(mosaic.seams().begin(), mosaic.seams().end());
  const auto square_of = [this](const SeamTriangle& t) {
    return store_.squares().number_at(t[0].layer, t[0].column, t[0].row);
  };
  std::stable_sort(seams_.begin(), seams_.end(),
                   [&](const SeamTriangle& a, const SeamTriangle& b) { return square_of(a) < square_of(b); });
  for (const SeamTriangle& t : seams_) {
    seam_squares_.push_back(square_of(t));
    for (const PostingRef& p : t)
      seam_postings_.push_back(
          place(p.layer, static_cast<std::int64_t>(p.column), static_cast<std::int64_t>(p.row)));
  }
  std::sort(seam_postings_.begin(), seam_postings_.end(), before);
  seam_postings_.erase(std::unique(seam_postings_.begin(), seam_postings_.end()), seam_postings_.end());
}

PostingRef TerrainSurface::place(std::uint32_t layer, std::int64_t column, std::int64_t row) const {
  const MosaicLayer& l = layers_[layer];
  const auto width = static_cast<std::int64_t>(l.width);
  if (l.closes()) column = (column % width + width) % width;
  const bool pole =
      (l.north_pole && row == 0) || (l.south_pole && row + 1 == static_cast<std::int64_t>(l.height));
  return {layer, pole ? 0 : static_cast<std::uint64_t>(column), static_cast<std::uint64_t>(row)};
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

bool TerrainSurface::is_in_seam(const PostingRef& at) const {
  return std::binary_search(seam_postings_.begin(), seam_postings_.end(), at, before);
}

Result<SurfaceChunk> TerrainSurface::chunk(std::uint32_t c) const {
  return TerrainChunk(*this, c).make();
}

Result<void> TerrainSurface::measure(std::span<const std::array<Vec3i, 3>> corners,
                                     std::span<float> distances) const {
  return PostingMeasure(*this).measure(corners, distances);
}

}  // namespace cuesta
