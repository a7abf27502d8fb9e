#pragma once
/// The triangles of one glTF primitive, from accessors or from Draco data, put where they are shown.

#include <array>
#include <cstdint>
#include <span>

#include "ooc/affine.h"
#include "ooc/gltf_document.h"
#include "ooc/mesh_emitter.h"

namespace cuesta::gltf {

class Data;

/// Of linear red, green, blue and alpha: the bytes that everything else works with.
Rgba8 stored_colour(const std::array<double, 4>& linear);

/// Whether it has triangles: it is neither points nor lines.
bool is_surface(const Primitive& primitive);

/// Emits it once per transform. Vertex colour is COLOR_0 times the base colour (both linear); the texture
/// coordinate v is turned up.
/// @param first_vertex  so many vertices went into `out` before
/// @return so many have by now. @pre is_surface(primitive). @error of Data and of the sink
Result<std::uint64_t> emit_primitive(const ReadJob& job, const Document& document, Data& data,
                                     const Primitive& primitive, const std::array<float, 4>& base_colour,
                                     std::span<const Affine> placed, std::uint64_t first_vertex,
                                     MeshEmitter& out);

}  // namespace cuesta::gltf
