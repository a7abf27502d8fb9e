#pragma once
/// The part of a glTF 2.0 file that scenes need, as plain structs: what the JSON says, nothing loaded.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ooc/read_job.h"
#include "ooc/scene.h"

namespace cuesta::gltf {

/// Index into one of the document's arrays; parse() has checked it. none: not given.
using Id = std::uint32_t;
constexpr Id none = 0xffff'ffff;

struct Buffer {
  std::string uri;  ///< empty: the binary chunk of a GLB, or a stand-in that is never read
  std::uint64_t bytes = 0;
};

enum class MeshoptMode : std::uint8_t { attributes, triangles, indices };
enum class MeshoptFilter : std::uint8_t { identity, octahedral, quaternion, exponential };

/// EXT_meshopt_compression: the view's content is decoded from here instead.
struct Meshopt {
  Id buffer = none;
  std::uint64_t offset = 0, bytes = 0, stride = 0, count = 0;
  MeshoptMode mode = MeshoptMode::attributes;
  MeshoptFilter filter = MeshoptFilter::identity;
};

struct View {
  Id buffer = none;
  std::uint64_t offset = 0, bytes = 0;
  std::uint64_t stride = 0;  ///< 0: packed
  std::optional<Meshopt> meshopt;
};

enum class Component : std::uint8_t { i8, u8, i16, u16, u32, f32 };

struct Sparse {
  std::uint64_t count = 0;
  Id index_view = none, value_view = none;
  std::uint64_t index_offset = 0, value_offset = 0;
  Component index_type = Component::u32;
};

struct Accessor {
  Id view = none;  ///< none: zeros
  std::uint64_t offset = 0, count = 0;
  Component component = Component::f32;
  std::uint32_t components = 1;  ///< 1…4, or more for matrices, which geometry does not use
  bool normalised = false;
  std::optional<Sparse> sparse;
};

/// KHR_draco_mesh_compression; unique ids of attributes in the Draco data, or none.
struct Draco {
  Id view = none;
  std::uint32_t position = none, normal = none, colour = none, texcoord = none;
};

enum class Mode : std::uint8_t { other, triangles, strip, fan };

struct Primitive {
  Mode mode = Mode::triangles;
  Id indices = none, position = none, normal = none, colour = none, texcoord = none;  ///< accessors
  Id material = none;
  std::optional<Draco> draco;
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
  bool has_morph_targets = false;
};

struct Material {
  std::string name;
  std::array<float, 4> base_colour{1, 1, 1, 1};  ///< linear
  float metallic = 1, roughness = 1;
  bool double_sided = false;
  bool blended = false;   ///< alphaMode BLEND
  bool textured = false;  ///< its base colour has a texture
};

/// EXT_mesh_gpu_instancing: accessors, one transform per element; all none: the node's mesh is shown once.
struct Instancing {
  Id translation = none, rotation = none, scale = none;

  bool is_there() const { return translation != none || rotation != none || scale != none; }
};

struct Node {
  std::string name;
  Id mesh = none;
  std::vector<Id> children;
  LocalTransform local;
  Instancing instancing;
  bool skinned = false;
};

struct Sampler {
  Id times = none, values = none;  ///< accessors
  Interpolation interpolation = Interpolation::linear;
};

struct Channel {
  Sampler sampler;
  Id node = none;
  AnimatedProperty property = AnimatedProperty::translation;
};

struct Animation {
  std::string name;
  std::vector<Channel> channels;  ///< of nodes' transforms
  std::uint64_t dropped = 0;      ///< channels of anything else
};

struct Document {
  std::vector<Buffer> buffers;
  std::vector<View> views;
  std::vector<Accessor> accessors;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Node> nodes;
  std::vector<Animation> animations;
  std::vector<Id> roots;  ///< of all scenes, each once; of a file without scenes, all nodes without a parent
};

/// Parses the JSON. What the library's tree of it needs is charged to the job's budget meanwhile.
/// @error corrupt; unsupported_version for glTF 1 and for required extensions that change geometry;
/// out_of_budget.
Result<Document> parse(const ReadJob& job, std::string_view json);

}  // namespace cuesta::gltf
