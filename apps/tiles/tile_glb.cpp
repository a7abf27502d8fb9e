#include "apps/tiles/tile_glb.h"

#include <meshoptimizer.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "ooc/oct_normal.h"
#include "ooc/srgb.h"

namespace cuesta::tiles {
namespace {

using Json = nlohmann::ordered_json;

enum ComponentType { i8 = 5120, u8, u16 = 5123, u32 = 5125 };
enum Target { vertex_data = 34962, index_data = 34963 };
constexpr std::int64_t most_steps = 65535;

/// The box of a tile on the lattice, in blocks of 2^shift steps.
struct Cube {
  Vec3i lo;  // of multiples of 2^shift
  int shift = 0;

  std::int32_t block(std::int32_t v) const {
    const std::int64_t half = shift > 0 ? std::int64_t{1} << (shift - 1) : 0;
    return static_cast<std::int32_t>((std::int64_t{v} + half) >> shift);
  }
};

std::vector<Vec3i> on_lattice(const TileMesh& mesh, const TilePlacement& placement) {
  std::vector<Vec3i> points;
  points.reserve(mesh.vertices.size());
  for (const DrawVertex& v : mesh.vertices) points.push_back(placement.lattice({v.x, v.y, v.z}));
  return points;
}

Cube cube_of(std::span<const Vec3i> points) {
  Vec3i lo = points.front(), hi = lo;
  for (const Vec3i& p : points) {
    lo = min(lo, p);
    hi = max(hi, p);
  }
  Cube cube;
  const auto fits = [&] {
    for (int a = 0; a < 3; ++a)
      if (std::int64_t{cube.block(hi[a])} - cube.block(lo[a]) > most_steps) return false;
    return true;
  };
  while (!fits()) ++cube.shift;
  cube.lo = {cube.block(lo.x), cube.block(lo.y), cube.block(lo.z)};
  return cube;
}

double rounding_of(const Cube& cube, const TilePlacement& placement) {
  const double snap = std::sqrt(3.0) / 2 * placement.step();
  return (cube.shift > 0 ? std::ldexp(snap, cube.shift) : 0) + (placement.bends() ? snap : 0);
}

/// Compressed views, one after the other in buffer 0; buffer 1 is what they decompress to, and is not in the
/// file.
class Views {
 public:
  Json json = Json::array();
  std::vector<unsigned char> bytes;
  std::uint64_t plain_bytes = 0;

  template <class Element>
  void add_vertices(const std::vector<Element>& elements, const char* filter) {
    std::vector<unsigned char> code(meshopt_encodeVertexBufferBound(elements.size(), sizeof(Element)));
    code.resize(meshopt_encodeVertexBuffer(code.data(), code.size(), elements.data(), elements.size(),
                                           sizeof(Element)));
    add(code, elements.size(), sizeof(Element), "ATTRIBUTES", filter, vertex_data);
  }

  void add_triangles(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
    meshopt_encodeIndexVersion(1);  // what the extension asks for
    std::vector<unsigned char> code(meshopt_encodeIndexBufferBound(indices.size(), vertices));
    code.resize(meshopt_encodeIndexBuffer(code.data(), code.size(), indices.data(), indices.size()));
    add(code, indices.size(), vertices <= 65535 ? 2 : 4, "TRIANGLES", nullptr, index_data);
  }

 private:
  void add(const std::vector<unsigned char>& code, std::size_t count, std::size_t stride, const char* mode,
           const char* filter, Target target) {
    Json compression{{"buffer", 0},
                     {"byteOffset", bytes.size()},
                     {"byteLength", code.size()},
                     {"byteStride", stride},
                     {"count", count},
                     {"mode", mode}};
    if (filter) compression["filter"] = filter;
    Json view{{"buffer", 1}, {"byteOffset", plain_bytes}, {"byteLength", count * stride}};
    if (target == vertex_data) view["byteStride"] = stride;
    view["target"] = static_cast<int>(target);
    view["extensions"]["EXT_meshopt_compression"] = std::move(compression);
    json.push_back(std::move(view));
    bytes.insert(bytes.end(), code.begin(), code.end());
    bytes.resize((bytes.size() + 3) / 4 * 4, 0);
    plain_bytes += (count * stride + 3) / 4 * 4;
  }
};

struct Position {
  std::uint16_t x, y, z, none;
};
struct Normal {
  std::int8_t u, v, one, none;
};

std::vector<Normal> normals_of(const TileMesh& mesh) {
  std::vector<float> plain;
  plain.reserve(mesh.vertices.size() * 4);
  for (const DrawVertex& v : mesh.vertices) {
    const Vec3f n = decode_oct({v.normal_u, v.normal_v}, 16);
    const bool none = !(dot(n, n) > 0);  // of a vertex without area around it
    for (const float c : {none ? 0.0f : n.x, none ? 0.0f : n.y, none ? 1.0f : n.z, 0.0f}) plain.push_back(c);
  }
  std::vector<Normal> normals(mesh.vertices.size());
  meshopt_encodeFilterOct(normals.data(), normals.size(), sizeof(Normal), 8, plain.data());
  return normals;
}

template <class Part>
std::vector<std::array<Part, 4>> colours_of(const TileMesh& mesh) {
  constexpr Part most = std::numeric_limits<Part>::max();
  std::array<Part, 256> linear{};
  for (std::size_t i = 0; i < linear.size(); ++i)
    linear[i] = static_cast<Part>(linear_from_srgb(static_cast<double>(i) / 255) * most + 0.5);
  std::vector<std::array<Part, 4>> colours;
  colours.reserve(mesh.vertices.size());
  for (const DrawVertex& v : mesh.vertices)
    colours.push_back({linear[v.colour[0]], linear[v.colour[1]], linear[v.colour[2]],
                       static_cast<Part>(v.colour[3] * (most / 255))});
  return colours;
}

/// In the order that a GPU's caches like, which is also the one that compresses.
std::vector<std::uint32_t> order_for_drawing(TileMesh& mesh) {
  std::vector<std::uint32_t> indices;
  indices.reserve(mesh.triangles.size() * 3);
  for (const auto& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  meshopt_optimizeVertexCache(indices.data(), indices.data(), indices.size(), mesh.vertices.size());
  meshopt_optimizeVertexFetch(mesh.vertices.data(), indices.data(), indices.size(), mesh.vertices.data(),
                              mesh.vertices.size(), sizeof(DrawVertex));
  return indices;
}

Json accessor(std::size_t view, int component, std::size_t count, const char* type, bool normalised) {
  Json json{{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}};
  if (normalised) json["normalized"] = true;
  return json;
}

/// z up to y up, steps to metres; column-major.
Json node_matrix(const Cube& cube, const TilePlacement& placement) {
  const double s = std::ldexp(placement.step(), cube.shift);
  const Vec3d zero = placement.lattice_zero() + vec_cast<double>(cube.lo) * s;
  return {s, 0, 0, 0, 0, 0, -s, 0, 0, s, 0, 0, zero.x, zero.z, -zero.y, 1};
}

void put_u32(std::vector<std::byte>& out, std::uint64_t value) {
  for (unsigned i = 0; i < 4; ++i) out.push_back(static_cast<std::byte>(value >> (8 * i) & 0xFFu));
}

void put(std::vector<std::byte>& out, const void* data, std::size_t count) {
  const auto* first = static_cast<const std::byte*>(data);
  out.insert(out.end(), first, first + count);
}

std::vector<std::byte> container(const Json& root, const std::vector<unsigned char>& binary) {
  std::string json = root.dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::vector<std::byte> out;
  out.reserve(28 + json.size() + binary.size());
  put(out, "glTF", 4);
  put_u32(out, 2);
  put_u32(out, 28 + json.size() + binary.size());
  put_u32(out, json.size());
  put(out, "JSON", 4);
  put(out, json.data(), json.size());
  put_u32(out, binary.size());
  put(out, "BIN\0", 4);
  put(out, binary.data(), binary.size());
  return out;
}

}  // namespace

double glb_rounding(const TileMesh& mesh, const TilePlacement& placement) {
  return rounding_of(cube_of(on_lattice(mesh, placement)), placement);
}

TileGlb encode_glb(TileMesh mesh, const TilePlacement& placement, GlbColours colours) {
  const std::vector<std::uint32_t> indices = order_for_drawing(mesh);
  const std::vector<Vec3i> points = on_lattice(mesh, placement);
  const Cube cube = cube_of(points);
  std::vector<Position> positions;
  positions.reserve(points.size());
  Position hi{};
  for (const Vec3i& p : points) {
    const auto part = [&](int a) { return static_cast<std::uint16_t>(cube.block(p[a]) - cube.lo[a]); };
    positions.push_back({part(0), part(1), part(2), 0});
    const Position& q = positions.back();
    hi = {std::max(hi.x, q.x), std::max(hi.y, q.y), std::max(hi.z, q.z), 0};
  }
  Views views;
  Json accessors = Json::array(), attributes;
  const std::size_t count = positions.size();
  views.add_vertices(positions, nullptr);
  accessors.push_back(accessor(0, u16, count, "VEC3", false));
  accessors.back()["min"] = {0, 0, 0};
  accessors.back()["max"] = {hi.x, hi.y, hi.z};
  attributes["POSITION"] = 0;
  views.add_vertices(normals_of(mesh), "OCTAHEDRAL");
  accessors.push_back(accessor(1, i8, count, "VEC3", true));
  attributes["NORMAL"] = 1;
  if (colours != GlbColours::none) {
    const bool fine = colours == GlbColours::u16;
    if (fine)
      views.add_vertices(colours_of<std::uint16_t>(mesh), nullptr);
    else
      views.add_vertices(colours_of<std::uint8_t>(mesh), nullptr);
    attributes["COLOR_0"] = accessors.size();
    accessors.push_back(accessor(2, fine ? u16 : u8, count, "VEC4", true));
  }
  views.add_triangles(indices, count);
  const std::size_t index_accessor = accessors.size();
  accessors.push_back(accessor(index_accessor, count <= 65535 ? u16 : u32, indices.size(), "SCALAR", false));

  Json root;
  root["asset"] = {{"version", "2.0"}, {"generator", "cuesta"}};
  root["extensionsUsed"] = root["extensionsRequired"] = {"KHR_mesh_quantization", "EXT_meshopt_compression"};
  root["scene"] = 0;
  root["scenes"] = Json::array({{{"nodes", {0}}}});
  root["nodes"] = Json::array({{{"mesh", 0}, {"matrix", node_matrix(cube, placement)}}});
  root["meshes"] = Json::array(
      {{{"primitives",
         Json::array({{{"attributes", attributes}, {"indices", index_accessor}, {"material", 0}}})}}});
  root["materials"] = Json::array(
      {{{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}, {"doubleSided", true}}});
  root["accessors"] = std::move(accessors);
  root["bufferViews"] = std::move(views.json);
  root["buffers"] = Json::array({{{"byteLength", views.bytes.size()}},
                                 {{"byteLength", views.plain_bytes},
                                  {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}});
  return {container(root, views.bytes), rounding_of(cube, placement)};
}

}  // namespace cuesta::tiles
