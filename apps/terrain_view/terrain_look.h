#pragma once
/// What a terrain file's frame and heights mean for pictures: up, colours, exaggeration, and a first camera.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "hierarchy/directory.h"
#include "runtime/draw/renderer.h"
#include "runtime/relief.h"
#include "terrain/terrain_metadata.h"

namespace cuesta::terrain_view {

/// Up and heights of a frame, at world units of one metre. Heights agree with Frame::geodetic within 0.1 m up
/// to 10 km.
Relief relief_of(const Frame& frame);

struct TerrainLook {
  TerrainFacts facts;
  Relief relief;
  bool has_colours = false;  ///< of an image: they are drawn, and not the heights' own
};

/// Nothing for a file that is no terrain.
/// @param path  for messages.   @error of terrain_facts().
Result<std::optional<TerrainLook>> terrain_look(const Directory& directory,
                                                const std::filesystem::path& path);

/// Sets relief and colours of heights; the shading is the caller's.
void set_look(const TerrainLook& look, DrawOptions& options);

/// A point in the middle of the terrain, at half its heights. World, not exaggerated.
/// @param points  of the surface, for terrain whose bounds are not known.
Vec3d middle_of(const TerrainLook& look, std::span<const Vec3d> points);

/// `view` with an eye that sees all of the terrain from the south, from above, its up the local up; of most
/// of a globe, with the north pole up. Heights are exaggerated as `look` says.
/// @param points  of the surface, coarse ones will do; not empty.
View first_view(const TerrainLook& look, std::span<const Vec3d> points, View view);

/// A point of the world as people say where it is: "46.12346 N 7.65432 E, 1234.5 m"; x and y of a plane that
/// is nowhere. Of what is drawn exaggerated: Relief::lowered() first.
std::string place_text(const TerrainLook& look, Vec3d p);

}  // namespace cuesta::terrain_view
