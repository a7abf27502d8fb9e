#include "ooc/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace cuesta::gltf {
namespace {

using Json = nlohmann::json;

/// Thrown only inside this file, caught in parse().
struct Bad {
  ErrorCode code;
  std::string what;
};
[[noreturn]] void bad(std::string what) {
  throw Bad{ErrorCode::corrupt, std::move(what)};
}

/// Counts what a Json tree will take, without building it, and refuses deep nesting (destroying a tree
/// recurses).
class TreeSize : public nlohmann::json_sax<Json> {
 public:
  static constexpr int deepest = 128;
  explicit TreeSize(std::uint64_t limit) : limit_(limit) {}
  std::uint64_t bytes() const { return bytes_; }

  bool null() override { return add(value); }
  bool boolean(bool) override { return add(value); }
  bool number_integer(number_integer_t) override { return add(value); }
  bool number_unsigned(number_unsigned_t) override { return add(value); }
  bool number_float(number_float_t, const string_t&) override { return add(value); }
  bool string(string_t& text) override { return add(value + 64 + text.size()); }
  bool binary(binary_t&) override { return false; }
  bool key(string_t& text) override { return add(128 + text.size()); }
  bool start_object(std::size_t) override { return ++depth_ <= deepest && add(96); }
  bool start_array(std::size_t) override { return ++depth_ <= deepest && add(96); }
  bool end_object() override { return --depth_ >= 0; }
  bool end_array() override { return --depth_ >= 0; }
  bool parse_error(std::size_t position, const std::string&, const Json::exception&) override {
    bad(fmt::format("not JSON at byte {}", position));
  }
  bool too_deep() const { return depth_ > deepest; }

 private:
  static constexpr std::uint64_t value = 48;  ///< 16 bytes in a vector that doubles and moves
  bool add(std::uint64_t more) { return (bytes_ += more) <= limit_; }
  std::uint64_t limit_;
  std::uint64_t bytes_ = 0;
  int depth_ = 0;
};

const Json* find(const Json& object, const char* key) {
  if (!object.is_object()) bad(fmt::format("expected an object that may have \"{}\"", key));
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}
const Json& need(const Json& object, const char* key) {
  const Json* found = find(object, key);
  if (!found) bad(fmt::format("\"{}\" is missing", key));
  return *found;
}
std::uint64_t whole(const Json& value, const char* key) {
  if (value.is_number_unsigned()) return value.get<std::uint64_t>();
  if (value.is_number_float()) {
    const double real = value.get<double>();
    if (real >= 0 && real < 9e15 && real == static_cast<double>(static_cast<std::uint64_t>(real))) {
      return static_cast<std::uint64_t>(real);
    }
  }
  bad(fmt::format("\"{}\" is not a whole number", key));
}
std::uint64_t whole_or(const Json& object, const char* key, std::uint64_t otherwise) {
  const Json* found = find(object, key);
  return found ? whole(*found, key) : otherwise;
}
/// An index that must be below `size`.
Id checked_id(const Json& value, const char* key, std::size_t size) {
  const std::uint64_t id = whole(value, key);
  if (id >= size) bad(fmt::format("\"{}\" is {}, but there are {}", key, id, size));
  return static_cast<Id>(id);
}
Id id_or_none(const Json& object, const char* key, std::size_t size) {
  const Json* found = find(object, key);
  return found ? checked_id(*found, key, size) : none;
}
template <std::size_t N, class T>
bool read_numbers(const Json& object, const char* key, std::array<T, N>& out) {
  const Json* found = find(object, key);
  if (!found) return false;
  if (!found->is_array() || found->size() != N) bad(fmt::format("\"{}\" needs {} numbers", key, N));
  for (std::size_t i = 0; i < N; ++i) {
    if (!(*found)[i].is_number()) bad(fmt::format("\"{}\" needs {} numbers", key, N));
    out[i] = (*found)[i].get<T>();
  }
  return true;
}
/// Calls `f` for each element of an array that need not be there.
template <class F>
void each(const Json& object, const char* key, F&& f) {
  const Json* found = find(object, key);
  if (!found) return;
  if (!found->is_array()) bad(fmt::format("\"{}\" is not an array", key));
  for (const Json& element : *found) f(element);
}
std::string text_or_empty(const Json& object, const char* key) {
  const Json* found = find(object, key);
  if (!found) return {};
  if (!found->is_string()) bad(fmt::format("\"{}\" is not a string", key));
  return found->get<std::string>();
}
const Json* extension(const Json& object, const char* name) {
  const Json* extensions = find(object, "extensions");
  return extensions ? find(*extensions, name) : nullptr;
}

Component component(std::uint64_t type) {
  switch (type) {
    case 5120:
      return Component::i8;
    case 5121:
      return Component::u8;
    case 5122:
      return Component::i16;
    case 5123:
      return Component::u16;
    case 5125:
      return Component::u32;
    case 5126:
      return Component::f32;
    default:
      bad(fmt::format("componentType {} is unknown", type));
  }
}
std::uint32_t components(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4" || type == "MAT2") return 4;
  if (type == "MAT3") return 9;
  if (type == "MAT4") return 16;
  bad("accessor type " + quote_word(type) + " is unknown");
}

void check_version(const Json& root) {
  const std::string version = text_or_empty(need(root, "asset"), "version");
  if (!version.starts_with("2")) {
    throw Bad{ErrorCode::unsupported_version, "glTF version " + quote_word(version) + "; 2.0 can be read"};
  }
  each(root, "extensionsRequired", [](const Json& name) {
    if (!name.is_string()) bad("\"extensionsRequired\" holds something that is not a string");
    const std::string text = name.get<std::string>();
    const bool known = text == "KHR_draco_mesh_compression" || text == "EXT_meshopt_compression" ||
                       text == "KHR_mesh_quantization" || text == "EXT_mesh_gpu_instancing" ||
                       text.starts_with("KHR_materials_") || text.starts_with("KHR_texture_") ||
                       text.starts_with("EXT_texture_") || text.starts_with("KHR_lights_");
    if (!known) {
      throw Bad{ErrorCode::unsupported_version, "the file requires the extension " + quote_word(text) +
                                                    ", which is not read; export it without"};
    }
  });
}

Meshopt meshopt_of(const Json& json, std::size_t buffers) {
  Meshopt m;
  m.buffer = checked_id(need(json, "buffer"), "buffer", buffers);
  m.offset = whole_or(json, "byteOffset", 0);
  m.bytes = whole(need(json, "byteLength"), "byteLength");
  m.stride = whole(need(json, "byteStride"), "byteStride");
  m.count = whole(need(json, "count"), "count");
  const std::string mode = text_or_empty(json, "mode");
  if (mode == "TRIANGLES")
    m.mode = MeshoptMode::triangles;
  else if (mode == "INDICES")
    m.mode = MeshoptMode::indices;
  else if (mode != "ATTRIBUTES")
    bad("meshopt mode " + quote_word(mode) + " is unknown");
  const std::string filter = text_or_empty(json, "filter");
  if (filter == "OCTAHEDRAL")
    m.filter = MeshoptFilter::octahedral;
  else if (filter == "QUATERNION")
    m.filter = MeshoptFilter::quaternion;
  else if (filter == "EXPONENTIAL")
    m.filter = MeshoptFilter::exponential;
  else if (!filter.empty() && filter != "NONE")
    bad("meshopt filter " + quote_word(filter) + " is unknown");
  return m;
}

void read_data(const Json& root, Document& d) {
  each(root, "buffers", [&](const Json& json) {
    d.buffers.push_back({text_or_empty(json, "uri"), whole(need(json, "byteLength"), "byteLength")});
  });
  each(root, "bufferViews", [&](const Json& json) {
    View v;
    v.buffer = checked_id(need(json, "buffer"), "buffer", d.buffers.size());
    v.offset = whole_or(json, "byteOffset", 0);
    v.bytes = whole(need(json, "byteLength"), "byteLength");
    v.stride = whole_or(json, "byteStride", 0);
    if (const Json* m = extension(json, "EXT_meshopt_compression"))
      v.meshopt = meshopt_of(*m, d.buffers.size());
    d.views.push_back(v);
  });
  each(root, "accessors", [&](const Json& json) {
    Accessor a;
    a.view = id_or_none(json, "bufferView", d.views.size());
    a.offset = whole_or(json, "byteOffset", 0);
    a.count = whole(need(json, "count"), "count");
    a.component = component(whole(need(json, "componentType"), "componentType"));
    a.components = components(text_or_empty(json, "type"));
    if (const Json* n = find(json, "normalized")) a.normalised = n->is_boolean() && n->get<bool>();
    if (const Json* s = find(json, "sparse")) {
      const Json& indices = need(*s, "indices");
      const Json& values = need(*s, "values");
      a.sparse = Sparse{.count = whole(need(*s, "count"), "count"),
                        .index_view = checked_id(need(indices, "bufferView"), "bufferView", d.views.size()),
                        .value_view = checked_id(need(values, "bufferView"), "bufferView", d.views.size()),
                        .index_offset = whole_or(indices, "byteOffset", 0),
                        .value_offset = whole_or(values, "byteOffset", 0),
                        .index_type = component(whole(need(indices, "componentType"), "componentType"))};
    }
    d.accessors.push_back(a);
  });
}

Primitive primitive_of(const Json& json, const Document& d) {
  const std::size_t accessors = d.accessors.size();
  Primitive p;
  const std::uint64_t mode = whole_or(json, "mode", 4);
  if (mode > 6) bad(fmt::format("primitive mode {} is unknown", mode));
  p.mode = mode == 4 ? Mode::triangles : mode == 5 ? Mode::strip : mode == 6 ? Mode::fan : Mode::other;
  p.indices = id_or_none(json, "indices", accessors);
  p.material = id_or_none(json, "material", d.materials.size());
  const Json& attributes = need(json, "attributes");
  p.position = id_or_none(attributes, "POSITION", accessors);
  p.normal = id_or_none(attributes, "NORMAL", accessors);
  p.colour = id_or_none(attributes, "COLOR_0", accessors);
  p.texcoord = id_or_none(attributes, "TEXCOORD_0", accessors);
  if (const Json* json_draco = extension(json, "KHR_draco_mesh_compression")) {
    const Json& ids = need(*json_draco, "attributes");
    p.draco = Draco{.view = checked_id(need(*json_draco, "bufferView"), "bufferView", d.views.size()),
                    .position = id_or_none(ids, "POSITION", none),
                    .normal = id_or_none(ids, "NORMAL", none),
                    .colour = id_or_none(ids, "COLOR_0", none),
                    .texcoord = id_or_none(ids, "TEXCOORD_0", none)};
  }
  return p;
}

float factor_or(const Json& object, const char* key, float otherwise) {
  const Json* found = find(object, key);
  if (!found) return otherwise;
  if (!found->is_number()) bad(fmt::format("\"{}\" is not a number", key));
  return std::clamp(found->get<float>(), 0.0f, 1.0f);
}

Material material_of(const Json& json) {
  Material m;
  m.name = text_or_empty(json, "name");
  m.blended = text_or_empty(json, "alphaMode") == "BLEND";
  if (const Json* sides = find(json, "doubleSided"))
    m.double_sided = sides->is_boolean() && sides->get<bool>();
  const Json* pbr = find(json, "pbrMetallicRoughness");
  if (!pbr) return m;
  read_numbers(*pbr, "baseColorFactor", m.base_colour);
  m.metallic = factor_or(*pbr, "metallicFactor", m.metallic);
  m.roughness = factor_or(*pbr, "roughnessFactor", m.roughness);
  m.textured = find(*pbr, "baseColorTexture") != nullptr;
  return m;
}

void read_meshes(const Json& root, Document& d) {
  each(root, "materials", [&](const Json& json) { d.materials.push_back(material_of(json)); });
  each(root, "meshes", [&](const Json& json) {
    Mesh& mesh = d.meshes.emplace_back();
    mesh.name = text_or_empty(json, "name");
    each(json, "primitives", [&](const Json& p) {
      mesh.primitives.push_back(primitive_of(p, d));
      mesh.has_morph_targets |= find(p, "targets") != nullptr;
    });
  });
}

LocalTransform local_of(const Json& json) {
  std::array<double, 16> m{};
  if (read_numbers(json, "matrix", m))
    return Affine{{Vec3d{m[0], m[1], m[2]}, Vec3d{m[4], m[5], m[6]}, Vec3d{m[8], m[9], m[10]}},
                  {m[12], m[13], m[14]}};
  std::array<double, 3> t{0, 0, 0}, s{1, 1, 1};
  Trs trs;
  read_numbers(json, "translation", t);
  read_numbers(json, "rotation", trs.rotation);
  read_numbers(json, "scale", s);
  trs.translation = {t[0], t[1], t[2]};
  trs.scale = {s[0], s[1], s[2]};
  return trs;
}

Instancing instancing_of(const Json& json, std::size_t accessors) {
  const Json* found = extension(json, "EXT_mesh_gpu_instancing");
  if (!found) return {};
  const Json& attributes = need(*found, "attributes");
  return {id_or_none(attributes, "TRANSLATION", accessors), id_or_none(attributes, "ROTATION", accessors),
          id_or_none(attributes, "SCALE", accessors)};
}

void add_children(const Json& json, std::size_t nodes, Node& node) {
  each(json, "children",
       [&](const Json& child) { node.children.push_back(checked_id(child, "children", nodes)); });
}

/// Of all scenes, each once; without scenes, nodes that have no parent.
void find_roots(const Json& root, Document& d) {
  const std::size_t count = d.nodes.size();
  std::vector<bool> is_root(count, false);
  const auto add_root = [&](Id id) {
    if (!is_root[id]) d.roots.push_back(id);
    is_root[id] = true;
  };
  bool has_scenes = false;
  each(root, "scenes", [&](const Json& scene) {
    has_scenes = true;
    each(scene, "nodes", [&](const Json& node) { add_root(checked_id(node, "nodes", count)); });
  });
  if (has_scenes) return;
  std::vector<bool> has_parent(count, false);
  for (const Node& node : d.nodes) {
    for (const Id child : node.children) has_parent[child] = true;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!has_parent[i]) add_root(static_cast<Id>(i));
  }
}

void read_nodes(const Json& root, Document& d) {
  const Json* nodes = find(root, "nodes");
  const std::size_t count = nodes && nodes->is_array() ? nodes->size() : 0;
  each(root, "nodes", [&](const Json& json) {
    Node node;
    node.name = text_or_empty(json, "name");
    node.mesh = id_or_none(json, "mesh", d.meshes.size());
    node.local = local_of(json);
    node.instancing = instancing_of(json, d.accessors.size());
    node.skinned = find(json, "skin") != nullptr;
    add_children(json, count, node);
    d.nodes.push_back(std::move(node));
  });
  find_roots(root, d);
}

Sampler sampler_of(const Json& json, std::size_t accessors) {
  const std::string way = text_or_empty(json, "interpolation");
  if (!way.empty() && way != "LINEAR" && way != "STEP" && way != "CUBICSPLINE")
    bad("interpolation " + quote_word(way) + " is unknown");
  return {checked_id(need(json, "input"), "input", accessors),
          checked_id(need(json, "output"), "output", accessors),
          way == "STEP"          ? Interpolation::step
          : way == "CUBICSPLINE" ? Interpolation::cubic
                                 : Interpolation::linear};
}

void read_animations(const Json& root, Document& d) {
  each(root, "animations", [&](const Json& json) {
    Animation& animation = d.animations.emplace_back();
    animation.name = text_or_empty(json, "name");
    std::vector<Sampler> samplers;
    each(json, "samplers", [&](const Json& s) { samplers.push_back(sampler_of(s, d.accessors.size())); });
    each(json, "channels", [&](const Json& channel) {
      const Json& target = need(channel, "target");
      const std::string path = text_or_empty(target, "path");
      const Id node = id_or_none(target, "node", d.nodes.size());
      const Sampler sampler = samplers[checked_id(need(channel, "sampler"), "sampler", samplers.size())];
      if (node == none || (path != "translation" && path != "rotation" && path != "scale")) {
        ++animation.dropped;
        return;
      }
      animation.channels.push_back({sampler, node,
                                    path == "translation" ? AnimatedProperty::translation
                                    : path == "rotation"  ? AnimatedProperty::rotation
                                                          : AnimatedProperty::scale});
    });
  });
}

Document parse_or_throw(std::string_view text, ReadBudget& budget) {
  TreeSize size(budget.left() / 2);  // the other half: the structs made from it
  if (!Json::sax_parse(text, &size)) {
    if (size.too_deep()) bad("JSON nested deeper than 128 levels");
    throw Bad{ErrorCode::out_of_budget,
              fmt::format("{} bytes of JSON need more than the {} bytes left; allow more memory", text.size(),
                          budget.left())};
  }
  const Json root = Json::parse(text);
  if (!root.is_object()) bad("expected a JSON object");
  Document d;
  check_version(root);
  read_data(root, d);
  read_meshes(root, d);
  read_nodes(root, d);
  read_animations(root, d);
  return d;
}

std::uint64_t bytes_of(const Document& d) {
  std::uint64_t bytes = d.views.capacity() * sizeof(View) + d.accessors.capacity() * sizeof(Accessor) +
                        d.meshes.capacity() * sizeof(Mesh) + d.nodes.capacity() * sizeof(Node);
  for (const Buffer& b : d.buffers) bytes += sizeof(Buffer) + b.uri.capacity();
  bytes += d.materials.capacity() * sizeof(Material) + d.animations.capacity() * sizeof(Animation);
  for (const Mesh& m : d.meshes) bytes += m.primitives.capacity() * sizeof(Primitive) + m.name.capacity();
  for (const Node& n : d.nodes) bytes += n.children.capacity() * sizeof(Id) + n.name.capacity();
  for (const Animation& a : d.animations) bytes += a.channels.capacity() * sizeof(Channel);
  return bytes;
}

}  // namespace

Result<Document> parse(const ReadJob& job, std::string_view json) {
  try {
    Document document = parse_or_throw(json, job.budget);
    CUESTA_TRY(job.budget.charge(bytes_of(document), 1, "bytes of glTF nodes and accessors"));
    return document;
  } catch (const Bad& e) {
    return job.error(e.code, "JSON", e.what);
  } catch (const std::bad_alloc&) {
    return job.error(ErrorCode::out_of_budget, "JSON", "the system has no memory left");
  } catch (const std::exception& e) {
    return job.error(ErrorCode::corrupt, "JSON", e.what());
  }
}

}  // namespace cuesta::gltf
