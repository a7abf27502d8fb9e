#include "apps/tiles/tile_producer.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "apps/tiles/tile_glb.h"
#include "ooc/check.h"

namespace cuesta::tiles {
namespace {

constexpr double earth_radius_m = 6.33e6;  // the least of the Earth's curves

/// A child that does not have half its parent's error is not worth its bytes, unless it is the only way to
/// smaller tiles.
constexpr int rungs_to_child = 2;

/// "t03-7". Leading zeros and signs are no names.
std::optional<Tile> tile_of(const std::string& id) {
  const std::size_t dash = id.find('-');
  if (id.empty() || id.front() != 't' || dash == std::string::npos) return std::nullopt;
  Tile tile{id.substr(1, dash - 1), -1};
  const char* const end = id.data() + id.size();
  const auto read = std::from_chars(id.data() + dash + 1, end, tile.rung);
  if (read.ec != std::errc() || read.ptr != end || tile.rung < 0 || tile.id() != id) return std::nullopt;
  return tile;
}

}  // namespace

TileProducer::TileProducer(std::unique_ptr<TileCut> cut, const std::optional<TerrainFacts>& facts,
                           const TileOptions& options, std::shared_ptr<KnownTiles> known)
    : cut_(std::move(cut)),
      options_(options),
      tree_(directory(), facts),
      placement_(directory(), facts),
      known_(std::move(known)) {
  if (facts && !directory().has_colours) tint_.emplace(*facts, directory().grid);
  const double largest =
      static_cast<double>(decode_error(directory().pages.back().largest_error)) * directory().grid.step;
  while (error_of(coarsest_) < largest) ++coarsest_;
}

Result<std::unique_ptr<TileProducer>> TileProducer::open(const std::filesystem::path& file,
                                                         const TileOptions& options,
                                                         std::shared_ptr<KnownTiles> known) {
  CUESTA_CHECK(options.border_share > 0 && options.border_share <= 1, options.border_share);
  auto cut = TileCut::open(file, options.cache_bytes);
  if (!cut) return fail(cut.error());
  auto facts = terrain_facts((*cut)->directory().metadata);
  if (!facts) return fail(facts.error().code, file.string(), facts.error().place, facts.error().message);
  return std::unique_ptr<TileProducer>(new TileProducer(std::move(*cut), *facts, options, std::move(known)));
}

double TileProducer::error_of(int rung) const {
  if (rung == 0) return 0;
  return static_cast<double>(decode_error(least_error_code)) * directory().grid.step *
         std::exp2((rung - 1) / 2.0);
}

Result<TilePiece> TileProducer::piece(const TileRange& range, int rung) {
  return cut_->piece(tree_.part(range), error_of(rung), options_.border_share);
}

TileProducer::Fitted TileProducer::fitted(const std::string& path, int rung, TilePiece piece) const {
  const Grid& grid = directory().grid;
  Fitted tile;
  tile.facts.tile = {path, rung};
  tile.facts.triangles = piece.mesh.triangles.size();
  tile.facts.leaf = digits(tile.facts.tile).empty();
  double& error = tile.facts.geometric_error;
  error = error_of(rung) + grid.snap_error() + glb_rounding(piece.mesh, placement_);
  if (placement_.bends()) {
    const double edge_m = longest_edge(piece.mesh) * grid.step;
    error += edge_m * edge_m / (8 * earth_radius_m);
  }
  tile.facts.volume = volume_of(tree_, placement_, grid, *tree_.range(path), piece.mesh, piece.margin, error);
  Box3d box;
  for (const DrawVertex& v : piece.mesh.vertices) box.add(vec_cast<double>(Vec3i{v.x, v.y, v.z}));
  tile.facts.extent = length(box.hi - box.lo) * grid.step;
  tile.mesh = std::move(piece.mesh);
  return tile;
}

std::vector<char> TileProducer::digits(const Tile& tile) const {
  if (tile.rung == 0) return {};
  return tree_.children(*tree_.range(tile.path));
}

/// The finest that fits, from `first` on. Where nothing can be divided any more, full resolution.
Result<std::optional<TileProducer::Fitted>> TileProducer::fit(const std::string& path, int first,
                                                              int coarsest) {
  const TileRange range = *tree_.range(path);
  int rung = tree_.children(range).empty() ? 0 : first;
  auto best = piece(range, rung);
  if (best && best->mesh.triangles.empty() && rung > 0) {  // maybe of a face without a vertex in here
    rung = 0;
    best = piece(range, rung);
  }
  if (!best) return fail(best.error());
  if (best->mesh.triangles.empty()) {
    known_->keep(path, std::nullopt);
    return std::optional<Fitted>();
  }
  const auto fits = [this](const TilePiece& p) { return p.mesh.triangles.size() <= options_.triangles; };
  const bool grow = !fits(*best) && !tree_.children(range).empty();
  while (grow && !fits(*best) && rung < coarsest) {
    best = piece(range, ++rung);
    if (!best) return fail(best.error());
  }
  while (!grow && rung > 0) {
    // A rung has at most about twice the triangles of the one above it.
    const double room =
        static_cast<double>(options_.triangles) / static_cast<double>(best->mesh.triangles.size());
    int step = std::clamp(static_cast<int>(std::log2(room)), 1, rung);
    auto finer = piece(range, rung - step);
    while (finer && !fits(*finer) && step > 1) finer = piece(range, rung - --step);
    if (!finer) return fail(finer.error());
    if (!fits(*finer)) break;
    best = std::move(finer);
    rung -= step;
  }
  Fitted tile = fitted(path, rung, std::move(*best));
  known_->keep(path, tile.facts);
  return std::optional<Fitted>(std::move(tile));
}

Result<std::optional<TileProducer::Fitted>> TileProducer::root() {
  return fit("", coarsest_, coarsest_);
}

Result<std::optional<TileProducer::Fitted>> TileProducer::child(const Tile& parent, char digit) {
  return fit(parent.path + digit, std::max(parent.rung - rungs_to_child, 0), parent.rung);
}

Result<KnownTiles::Fact> TileProducer::fact_of(const std::string& path) {
  if (const auto known = known_->find(path)) return *known;
  const auto facts_only = [](Result<std::optional<Fitted>> tile) -> Result<KnownTiles::Fact> {
    if (!tile) return fail(tile.error());
    return *tile ? KnownTiles::Fact(std::move((*tile)->facts)) : KnownTiles::Fact();
  };
  if (path.empty()) return facts_only(root());
  const auto above = fact_of(path.substr(0, path.size() - 1));
  if (!above || !*above) return above;
  const auto children = digits((*above)->tile);
  if (std::find(children.begin(), children.end(), path.back()) == children.end()) return KnownTiles::Fact();
  return facts_only(child((*above)->tile, path.back()));
}

Result<TileFacts> TileProducer::facts(const std::string& id) {
  const auto tile = tile_of(id);
  if (!tile || !tree_.range(tile->path)) return fail(ErrorCode::not_found, "", id, "no such tile");
  auto fact = fact_of(tile->path);
  if (!fact) return fail(fact.error());
  if (!*fact || (*fact)->tile.rung != tile->rung) return fail(ErrorCode::not_found, "", id, "no such tile");
  return std::move(**fact);
}

Result<TileProducer::Fitted> TileProducer::find(const std::string& id) {
  auto known = facts(id);
  if (!known) return fail(known.error());
  auto found = piece(*tree_.range(known->tile.path), known->tile.rung);
  if (!found) return fail(found.error());
  return Fitted{std::move(*known), std::move(found->mesh)};
}

std::vector<std::byte> TileProducer::content(Fitted&& tile) const {
  if (tint_) tint_->put(tile.mesh);
  const GlbColours colours = tint_                     ? GlbColours::u8
                             : directory().has_colours ? GlbColours::u16
                                                       : GlbColours::none;
  return encode_glb(std::move(tile.mesh), placement_, colours).bytes;
}

}  // namespace cuesta::tiles
