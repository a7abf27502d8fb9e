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

constexpr int no_tile = -1;

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
                           const TileOptions& options)
    : cut_(std::move(cut)), options_(options), tree_(directory(), facts), placement_(directory(), facts) {
  const double largest =
      static_cast<double>(decode_error(directory().pages.back().largest_error)) * directory().grid.step;
  while (error_of(coarsest_) < largest) ++coarsest_;
}

Result<std::unique_ptr<TileProducer>> TileProducer::open(const std::filesystem::path& file,
                                                         const TileOptions& options) {
  CUESTA_CHECK(options.border_share > 0 && options.border_share <= 1, options.border_share);
  auto cut = TileCut::open(file, options.cache_bytes);
  if (!cut) return fail(cut.error());
  auto facts = terrain_facts((*cut)->directory().metadata);
  if (!facts) return fail(facts.error().code, file.string(), facts.error().place, facts.error().message);
  return std::unique_ptr<TileProducer>(new TileProducer(std::move(*cut), *facts, options));
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
    rungs_[path] = no_tile;
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
  rungs_[path] = rung;
  return std::optional<Fitted>(fitted(path, rung, std::move(*best)));
}

Result<std::optional<TileProducer::Fitted>> TileProducer::root() {
  return fit("", coarsest_, coarsest_);
}

Result<std::optional<TileProducer::Fitted>> TileProducer::child(const Tile& parent, char digit) {
  return fit(parent.path + digit, std::max(parent.rung - rungs_to_child, 0), parent.rung);
}

/// no_tile where there is none.
Result<int> TileProducer::rung_of(const std::string& path) {
  if (const auto known = rungs_.find(path); known != rungs_.end()) return known->second;
  if (path.empty()) {
    auto tile = root();
    if (!tile) return fail(tile.error());
    return rungs_.at(path);
  }
  const std::string above = path.substr(0, path.size() - 1);
  auto rung = rung_of(above);
  if (!rung || *rung == no_tile) return rung;
  const Tile parent{above, *rung};
  const auto children = digits(parent);
  if (std::find(children.begin(), children.end(), path.back()) == children.end()) return no_tile;
  auto tile = child(parent, path.back());
  if (!tile) return fail(tile.error());
  return rungs_.at(path);
}

Result<TileProducer::Fitted> TileProducer::find(const std::string& id) {
  const auto tile = tile_of(id);
  const auto range = tile ? tree_.range(tile->path) : std::nullopt;
  if (!range) return fail(ErrorCode::not_found, "", id, "no such tile");
  const auto rung = rung_of(tile->path);
  if (!rung) return fail(rung.error());
  if (*rung != tile->rung) return fail(ErrorCode::not_found, "", id, "no such tile");
  auto found = piece(*range, tile->rung);
  if (!found) return fail(found.error());
  return fitted(tile->path, tile->rung, std::move(*found));
}

std::vector<std::byte> TileProducer::content(Fitted&& tile) const {
  return encode_glb(std::move(tile.mesh), placement_, directory().has_colours).bytes;
}

Result<TileNode> TileProducer::with_children(const Tile& tile) {
  auto found = find(tile.id());
  if (!found) return fail(found.error());
  TileNode node{std::move(found->facts), {}};
  for (const char digit : digits(tile)) {
    auto below = child(tile, digit);
    if (!below) return fail(below.error());
    if (*below) node.children.push_back({std::move((*below)->facts), {}});
  }
  return node;
}

}  // namespace cuesta::tiles
