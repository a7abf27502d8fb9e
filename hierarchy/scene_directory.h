#pragma once
/// What is known of a scene before any of its parts is read: nodes, materials, clips, and where each part
/// lies.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ooc/container_file.h"
#include "ooc/result.h"
#include "ooc/scene.h"

namespace cuesta {

/// No TOM has more.
inline constexpr std::uint64_t most_segments = 64;

/// A block of a part's TOM. With it and all before it the TOM has these counts; what has not come yet only
/// makes it finer.
struct TomSegment {
  BlockRef block;
  std::uint32_t vertices = 0;
  std::uint32_t triangles = 0;
  float error = 0;  ///< bound on the distance to the whole part then, in units of its frame
};

/// A large part: a surface (directory.h) whose directory and pages are blocks of the scene's file.
struct EmbeddedSurface {
  BlockRef directory;  ///< of its pages' offsets, that of the base page is 0, others count from pages_offset
  BlockRef base;       ///< its base page
  std::uint64_t pages_offset = 0, pages_bytes = 0;  ///< all others, coarse ones first
};

/// One mesh, stored once. Exactly one of `segments` (not empty) and `surface` is there.
struct ScenePartEntry {
  std::string name;
  Box3d box;                                  ///< of all vertices, in the part's frame
  std::uint64_t vertices = 0, triangles = 0;  ///< of the whole part
  AttributeSet attributes;
  std::vector<TomSegment> segments;  ///< of a TOM: coarsest first
  std::optional<EmbeddedSurface> surface;

  bool is_tom() const { return !surface; }
};

/// A node that shows a part.
struct SceneInstance {
  std::uint32_t node = 0, part = 0, material = 0;
};

struct SceneDirectory {
  Scene scene;
  std::vector<ScenePartEntry> parts;
  std::string metadata;  ///< JSON object: inputs, options, counted warnings, program version
};

/// In the order of nodes.
std::vector<SceneInstance> instances_of(const Scene& scene);
/// Around all instances at rest; empty without any.
Box3d world_box(const SceneDirectory& directory);

/// All blocks in the order in which they lie in the file: layer by layer, part by part. Behind them come the
/// pages of surfaces, part by part.
std::vector<BlockRef*> blocks_in_order(SceneDirectory& directory);
/// How many of these are of the first layer, which holds the coarsest of every part.
std::uint64_t coarsest_blocks(const SceneDirectory& directory);
/// Gives every block and all pages their offsets, which follow from their sizes.
/// @param first_byte  where the directory ends   @return where the file ends
std::uint64_t lay_out(SceneDirectory& directory, std::uint64_t first_byte);

/// Without offsets: its own size decides about them.
std::vector<std::byte> encode_scene_directory(const SceneDirectory& directory);
/// @param first_byte  as of lay_out()
/// @error unsupported_version; corrupt. Checks every index, count and number, so that what it returns can be
/// relied on.
Result<SceneDirectory> decode_scene_directory(std::span<const std::byte> bytes, std::uint64_t first_byte);

}  // namespace cuesta
