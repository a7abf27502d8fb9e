#pragma once
/// A scene of many parts as plain structs: nodes that put parts somewhere, materials, and clips that move
/// nodes. The geometry of parts is not in it: readers give it part by part (scene_source.h), a .cuesta scene
/// in segments (hierarchy/scene_file.h).

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "ooc/affine.h"
#include "ooc/surface_mesh.h"

namespace cuesta {

/// No node, no part, no material.
inline constexpr std::uint32_t no_index = 0xffff'ffffu;

/// Translation after rotation after scale.
struct Trs {
  Vec3d translation;
  std::array<double, 4> rotation{0, 0, 0, 1};  ///< unit quaternion: x, y, z, w
  Vec3d scale{1, 1, 1};

  friend bool operator==(const Trs&, const Trs&) = default;
};
Affine affine_of(const Trs& trs);

/// As the file gave it. Clips move nodes that have a Trs.
using LocalTransform = std::variant<Trs, Affine>;
Affine affine_of(const LocalTransform& local);

/// A node with a part is an instance of it. A part's frame is its node's: world = … parent · local · point.
/// Counter-clockwise is outside in the part's frame; where determinant(world) < 0, clockwise is in the
/// world's.
struct SceneNode {
  std::string name;                 ///< UTF-8 as the file had it; may be empty, need not be unique
  std::uint32_t parent = no_index;  ///< below the node's own number; a root has none
  std::uint32_t part = no_index;
  std::uint32_t material = no_index;  ///< there where a part is
  LocalTransform local;

  friend bool operator==(const SceneNode&, const SceneNode&) = default;
};

struct SceneMaterial {
  std::string name;
  /// Of parts that have no vertex colours; theirs are final. Alpha is 255 unless the file asks for blending.
  Rgba8 base_colour{255, 255, 255, 255};
  float metallic = 0;   ///< 0 … 1
  float roughness = 1;  ///< 0 … 1
  bool double_sided = false;

  friend bool operator==(const SceneMaterial&, const SceneMaterial&) = default;
};

enum class AnimatedProperty : std::uint8_t { translation, rotation, scale };
/// cubic: Hermite splines, as glTF defines CUBICSPLINE.
enum class Interpolation : std::uint8_t { step, linear, cubic };

/// One property of one node over time. Before the first key it is as at the first, after the last as at the
/// last. Linear rotations go along the shorter great arc.
struct SceneChannel {
  std::uint32_t node = no_index;  ///< its local transform is a Trs
  AnimatedProperty property = AnimatedProperty::translation;
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times_s;  ///< of the keys, strictly ascending, at least one
  /// Per key three numbers, or the four of a quaternion; cubic: per key in-tangent, value, out-tangent.
  std::vector<float> values;

  std::size_t components() const { return property == AnimatedProperty::rotation ? 4 : 3; }
  friend bool operator==(const SceneChannel&, const SceneChannel&) = default;
};

struct SceneClip {
  std::string name;
  std::vector<SceneChannel> channels;

  /// Time of its last key.
  double seconds() const;
  friend bool operator==(const SceneClip&, const SceneClip&) = default;
};

struct Scene {
  std::vector<SceneNode> nodes;  ///< parents before children
  std::vector<SceneMaterial> materials;
  std::vector<SceneClip> clips;

  friend bool operator==(const Scene&, const Scene&) = default;
};

/// What is wrong with it, for a scene of `parts` parts: an index, an order, a number that is not finite.
/// Empty: nothing. Whoever makes a Scene from bytes asks; everything else may rely on it. @cost linear
std::string fault_of(const Scene& scene, std::uint64_t parts);

/// Of all nodes at rest. @cost linear
std::vector<Affine> world_transforms(const Scene& scene);

/// The values of a channel at a time: three numbers, or a unit quaternion x, y, z, w.
/// @cost O(log keys)
std::array<double, 4> value_at(const SceneChannel& channel, double seconds);

/// Puts the clip's values at a time into `locals`, one element per node of the scene; what the clip does not
/// move keeps its value. @pre nodes that channels name hold a Trs
void apply_clip(const SceneClip& clip, double seconds, std::vector<LocalTransform>& locals);

}  // namespace cuesta
