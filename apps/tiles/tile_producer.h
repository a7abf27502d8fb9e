#pragma once
/// Tiles of a .cuesta file, made one at a time: 3D Tiles 1.1 with a content at every tile, each replaced by
/// its children.
///
/// A tile's content is the finest cut, of a ladder of errors, whose part in the tile has no more than so many
/// triangles. Along the borders between tiles its error is `border_share` times smaller, and it reaches over
/// them by as much. So where a client draws tiles of any levels side by side, each at no more than `px`
/// pixels of screen-space error, the surfaces on either side of a border differ by at most 2 · border_share ·
/// px pixels and overlap by more than that; tiles of the same error agree on every triangle at the border.
/// There are no skirts.
///
/// The same tile has the same bytes whatever was made before it. Threads: one at a time; several producers of
/// one file are independent.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/tiles/height_tint.h"
#include "apps/tiles/known_tiles.h"
#include "apps/tiles/tile_cut.h"
#include "apps/tiles/tile_placement.h"
#include "apps/tiles/tile_tree.h"

namespace cuesta::tiles {

struct TileOptions {
  std::uint32_t triangles = 65535;  ///< of a tile, before its borders are cut; at least 64
  double border_share = 0.25;       ///< in (0, 1]
  std::uint64_t cache_bytes = std::uint64_t{1} << 30;
};

class TileProducer {
 public:
  /// @error as Cut::open; corrupt: damaged facts of a terrain.
  /// @param known  of other producers of the same file and the same options, but for their cache; not null.
  static Result<std::unique_ptr<TileProducer>> open(
      const std::filesystem::path& file, const TileOptions& options,
      std::shared_ptr<KnownTiles> known = std::make_shared<KnownTiles>());

  struct Fitted {
    TileFacts facts;
    TileMesh mesh;
  };

  /// The root, the coarsest tile; nothing for a file without triangles.
  Result<std::optional<Fitted>> root();
  /// Without its mesh, if it is known.
  Result<KnownTiles::Fact> root_facts() { return fact_of(""); }
  /// The tile at a child's path; nothing if no surface is there.   @pre path is a child's of `parent`
  Result<std::optional<Fitted>> child(const Tile& parent, char digit);
  /// The digits to ask child() for; none for a leaf.
  std::vector<char> digits(const Tile& tile) const;
  /// A tile as Tile::id() names it. Names come from strangers, so one that was not given out yet is looked
  /// for from the root on; a wrong one costs the children on its way, once.
  /// @error not_found: there is no such tile.
  Result<TileFacts> facts(const std::string& id);
  Result<Fitted> find(const std::string& id);

  /// A binary glTF, in colours: the file's, or those of a terrain's heights. Other surfaces without have
  /// none.
  std::vector<std::byte> content(Fitted&& tile) const;

  const TilePlacement& placement() const { return placement_; }
  const TileTree& tree() const { return tree_; }
  const Directory& directory() const { return cut_->directory(); }

 private:
  TileProducer(std::unique_ptr<TileCut> cut, const std::optional<TerrainFacts>& facts,
               const TileOptions& options, std::shared_ptr<KnownTiles> known);
  double error_of(int rung) const;
  Result<std::optional<Fitted>> fit(const std::string& path, int first, int coarsest);
  Result<TilePiece> piece(const TileRange& range, int rung);
  Result<KnownTiles::Fact> fact_of(const std::string& path);
  Fitted fitted(const std::string& path, int rung, TilePiece piece) const;

  std::unique_ptr<TileCut> cut_;
  TileOptions options_;
  TileTree tree_;
  TilePlacement placement_;
  std::optional<HeightTint> tint_;  // of a terrain without colours
  int coarsest_ = 0;
  std::shared_ptr<KnownTiles> known_;
};

/// A tileset.json: of a tile and its children. A child that has children is a tileset of its own,
/// Tile::id() + ".json", and so on; contents are Tile::id() + ".glb".
/// @param transform  TilePlacement::transform(), of the root; null for tilesets within it.
std::string tileset_json(const TileFacts& tile, std::span<const TileFacts> children,
                         const std::array<double, 16>* transform);

}  // namespace cuesta::tiles
