#include "hierarchy/scene_directory.h"

#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "hierarchy/page_codec.h"
#include "ooc/byte_stream.h"
#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr std::uint8_t scene_directory_version = 1;
constexpr std::uint64_t largest_directory = std::uint64_t{1} << 31;
/// No block, and no surface's pages, are larger.
constexpr std::uint64_t largest_block = std::uint64_t{1} << 46;
/// Where sums of sizes stay.
constexpr std::uint64_t largest_file = std::uint64_t{1} << 60;

// What is stored of each has at least so many bytes: counts are held against what is left.
constexpr std::uint64_t least_node_bytes = 1 + 3 + 1 + 80;
constexpr std::uint64_t least_material_bytes = 1 + 4 + 8 + 1;
constexpr std::uint64_t least_clip_bytes = 2;
constexpr std::uint64_t least_channel_bytes = 1 + 2 + 1;
constexpr std::uint64_t least_part_bytes = 1 + 48 + 2 + 1 + 1;
constexpr std::uint64_t least_segment_bytes = 1 + 8 + 2 + 4;

tl::unexpected<Error> corrupt(std::string what) {
  return fail(ErrorCode::corrupt, "", "directory", std::move(what));
}

void put_text(ByteWriter& w, const std::string& text) {
  w.put_varint(text.size());
  w.put_bytes(std::as_bytes(std::span(text)));
}

std::string get_text(ByteReader& r) {
  const std::uint64_t size = r.get_varint();
  const auto bytes = r.get_bytes(r.ok() ? size : 0);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A number that need not be there: no_index is 0.
void put_index(ByteWriter& w, std::uint32_t index) {
  w.put_varint(index == no_index ? 0 : std::uint64_t{index} + 1);
}

/// One that does not fit becomes one that nothing has.
std::uint32_t get_index(ByteReader& r) {
  const std::uint64_t n = r.get_varint();
  return n == 0 ? no_index : static_cast<std::uint32_t>(std::min<std::uint64_t>(n - 1, no_index - 1));
}

/// False if so many elements cannot be in what is left.
bool get_count(ByteReader& r, std::uint64_t least_bytes, std::uint64_t& count) {
  count = r.get_varint();
  return r.ok() && count <= r.remaining() / least_bytes;
}

void put_vector(ByteWriter& w, Vec3d v) {
  for (int i = 0; i < 3; ++i) w.put(v[i]);
}

Vec3d get_vector(ByteReader& r) {
  Vec3d v;
  for (int i = 0; i < 3; ++i) v[i] = r.get<double>();
  return v;
}

void put_node(ByteWriter& w, const SceneNode& node) {
  put_text(w, node.name);
  for (const std::uint32_t index : {node.parent, node.part, node.material}) put_index(w, index);
  const Trs* trs = std::get_if<Trs>(&node.local);
  w.put(static_cast<std::uint8_t>(trs == nullptr));
  if (trs) {
    put_vector(w, trs->translation);
    for (const double x : trs->rotation) w.put(x);
    put_vector(w, trs->scale);
  } else {
    const Affine& a = std::get<Affine>(node.local);
    for (const Vec3d& column : a.columns) put_vector(w, column);
    put_vector(w, a.translation);
  }
}

LocalTransform get_transform(ByteReader& r) {
  if (r.get<std::uint8_t>() == 0) {
    Trs trs;
    trs.translation = get_vector(r);
    for (double& x : trs.rotation) x = r.get<double>();
    trs.scale = get_vector(r);
    return trs;
  }
  Affine a;
  for (Vec3d& column : a.columns) column = get_vector(r);
  a.translation = get_vector(r);
  return a;
}

SceneNode get_node(ByteReader& r) {
  SceneNode node;
  node.name = get_text(r);
  for (std::uint32_t* index : {&node.parent, &node.part, &node.material}) *index = get_index(r);
  node.local = get_transform(r);
  return node;
}

void put_material(ByteWriter& w, const SceneMaterial& m) {
  put_text(w, m.name);
  w.put(m.base_colour);
  w.put(m.metallic);
  w.put(m.roughness);
  w.put(static_cast<std::uint8_t>(m.double_sided));
}

SceneMaterial get_material(ByteReader& r) {
  SceneMaterial m;
  m.name = get_text(r);
  m.base_colour = r.get<Rgba8>();
  m.metallic = r.get<float>();
  m.roughness = r.get<float>();
  m.double_sided = r.get<std::uint8_t>() != 0;
  return m;
}

void put_clip(ByteWriter& w, const SceneClip& clip) {
  put_text(w, clip.name);
  w.put_varint(clip.channels.size());
  for (const SceneChannel& c : clip.channels) {
    w.put_varint(c.node);
    w.put(c.property);
    w.put(c.interpolation);
    w.put_varint(c.times_s.size());
    w.put_bytes(std::as_bytes(std::span(c.times_s)));
    w.put_bytes(std::as_bytes(std::span(c.values)));
  }
}

bool get_floats(ByteReader& r, std::uint64_t count, std::vector<float>& values) {
  const auto bytes = count <= r.remaining() / sizeof(float) ? r.get_bytes(count * sizeof(float))
                                                            : std::span<const std::byte>();
  values.resize(bytes.size() / sizeof(float));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values.size() == count;
}

bool get_channel(ByteReader& r, SceneChannel& c) {
  const std::uint64_t node = r.get_varint();
  const auto property = r.get<std::uint8_t>(), interpolation = r.get<std::uint8_t>();
  std::uint64_t keys = 0;
  if (node >= no_index || property > 2 || interpolation > 2 || !get_count(r, sizeof(float), keys))
    return false;
  c.node = static_cast<std::uint32_t>(node);
  c.property = static_cast<AnimatedProperty>(property);
  c.interpolation = static_cast<Interpolation>(interpolation);
  const std::uint64_t per_key = c.components() * (c.interpolation == Interpolation::cubic ? 3 : 1);
  return get_floats(r, keys, c.times_s) && get_floats(r, keys * per_key, c.values);
}

bool get_clip(ByteReader& r, SceneClip& clip) {
  clip.name = get_text(r);
  std::uint64_t channels = 0;
  if (!get_count(r, least_channel_bytes, channels)) return false;
  clip.channels.resize(channels);
  for (SceneChannel& c : clip.channels)
    if (!get_channel(r, c)) return false;
  return true;
}

void put_block(ByteWriter& w, const BlockRef& block) {
  w.put_varint(block.bytes);
  w.put(block.checksum);
}

/// Its offset follows from those before it.
bool get_block(ByteReader& r, BlockRef& block) {
  block = {0, r.get_varint(), r.get<std::uint64_t>()};
  return r.ok() && block.bytes <= largest_block;
}

void put_part(ByteWriter& w, const ScenePartEntry& part) {
  put_text(w, part.name);
  put_vector(w, part.box.lo);
  put_vector(w, part.box.hi);
  w.put_varint(part.vertices);
  w.put_varint(part.triangles);
  w.put(static_cast<std::uint8_t>(part.attributes.normals | part.attributes.colours << 1 |
                                  part.attributes.texcoords << 2));
  w.put_varint(part.segments.size());
  for (const TomSegment& s : part.segments) {
    put_block(w, s.block);
    w.put_varint(s.vertices);
    w.put_varint(s.triangles);
    w.put(s.error);
  }
  if (!part.surface) return;
  put_block(w, part.surface->directory);
  put_block(w, part.surface->base);
  w.put_varint(part.surface->pages_bytes);
}

bool get_u32(ByteReader& r, std::uint32_t& value) {
  const std::uint64_t n = r.get_varint();
  value = static_cast<std::uint32_t>(n);
  return r.ok() && n <= std::numeric_limits<std::uint32_t>::max();
}

/// Resolution rises from segment to segment up to the whole part.
bool get_segments(ByteReader& r, std::uint64_t count, ScenePartEntry& part) {
  part.segments.resize(count);
  TomSegment before;
  before.error = std::numeric_limits<float>::infinity();
  for (TomSegment& s : part.segments) {
    if (!get_block(r, s.block) || !get_u32(r, s.vertices) || !get_u32(r, s.triangles)) return false;
    s.error = r.get<float>();
    if (s.vertices < before.vertices || s.triangles < before.triangles || !(s.error <= before.error) ||
        !std::isfinite(s.error) || s.error < 0)
      return false;
    before = s;
  }
  return before.vertices == part.vertices && before.triangles == part.triangles;
}

bool get_surface(ByteReader& r, EmbeddedSurface& s) {
  if (!get_block(r, s.directory) || !get_block(r, s.base)) return false;
  s.pages_bytes = r.get_varint();
  return r.ok() && s.pages_bytes <= largest_block;
}

bool is_box(const Box3d& box) {
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(box.lo[i]) || !std::isfinite(box.hi[i]) || box.lo[i] > box.hi[i]) return false;
  return true;
}

bool get_part(ByteReader& r, ScenePartEntry& part) {
  part.name = get_text(r);
  part.box.lo = get_vector(r);
  part.box.hi = get_vector(r);
  part.vertices = r.get_varint();
  part.triangles = r.get_varint();
  const auto flags = r.get<std::uint8_t>();
  part.attributes = {(flags & 1) != 0, (flags & 2) != 0, (flags & 4) != 0};
  std::uint64_t segments = 0;
  if (!get_count(r, least_segment_bytes, segments) || segments > most_segments || !is_box(part.box) ||
      flags > 7)
    return false;
  return segments > 0 ? get_segments(r, segments, part) : get_surface(r, part.surface.emplace());
}

/// A count and as many elements. False if one of them is damaged.
template <class T, class Get>
bool get_all(ByteReader& r, std::uint64_t least_bytes, std::vector<T>& all, Get get) {
  std::uint64_t count = 0;
  if (!get_count(r, least_bytes, count)) return false;
  all.resize(count);
  for (T& one : all)
    if (!get(r, one)) return false;
  return r.ok();
}

std::vector<std::byte> packed(std::span<const std::byte> plain) {
  std::vector<std::byte> bytes(ZSTD_compressBound(plain.size()));
  const std::size_t size = ZSTD_compress(bytes.data(), bytes.size(), plain.data(), plain.size(), 12);
  CUESTA_CHECK(!ZSTD_isError(size), ZSTD_getErrorName(size));
  bytes.resize(size);
  return bytes;
}

Result<std::vector<std::byte>> unpacked(std::span<const std::byte> bytes) {
  ByteReader r(bytes);
  const auto version = r.get<std::uint8_t>();
  if (r.ok() && version != scene_directory_version)
    return fail(ErrorCode::unsupported_version, "", "directory",
                "version " + std::to_string(version) + " of a scene's directory; this program reads 1");
  const std::uint64_t raw = r.get_varint();
  // zstd cannot expand by more than this; a larger claim is a lie that must not be allocated.
  if (!r.ok() || raw > largest_directory || raw / 65536 > bytes.size()) return corrupt("impossible size");
  std::vector<std::byte> plain(raw);
  const auto rest = r.get_bytes(r.remaining());
  const std::size_t got = ZSTD_decompress(plain.data(), plain.size(), rest.data(), rest.size());
  if (ZSTD_isError(got) || got != raw) return corrupt("zstd data are damaged");
  return plain;
}

bool get_tables(ByteReader& r, SceneDirectory& d) {
  d.metadata = get_text(r);
  const auto plain = [](auto get) {
    return [get](ByteReader& from, auto& into) {
      into = get(from);
      return from.ok();
    };
  };
  return get_all(r, least_node_bytes, d.scene.nodes, plain(get_node)) &&
         get_all(r, least_material_bytes, d.scene.materials, plain(get_material)) &&
         get_all(r, least_clip_bytes, d.scene.clips, get_clip) &&
         get_all(r, least_part_bytes, d.parts, get_part) && r.at_end();
}

/// Blocks of the part in the layer: of a TOM one segment; of a surface, directory and base page in layer 0.
template <class F>
void each_block_in_layer(ScenePartEntry& part, std::size_t layer, F&& f) {
  if (part.surface && layer == 0) {
    f(part.surface->directory);
    f(part.surface->base);
  } else if (layer < part.segments.size()) {
    f(part.segments[layer].block);
  }
}

}  // namespace

std::vector<BlockRef*> blocks_in_order(SceneDirectory& directory) {
  std::vector<BlockRef*> blocks;
  bool is_more = true;
  for (std::size_t layer = 0; is_more; ++layer) {
    is_more = false;
    for (ScenePartEntry& part : directory.parts) {
      each_block_in_layer(part, layer, [&](BlockRef& block) { blocks.push_back(&block); });
      is_more |= layer + 1 < part.segments.size();
    }
  }
  return blocks;
}

std::uint64_t coarsest_blocks(const SceneDirectory& directory) {
  std::uint64_t count = 0;
  for (const ScenePartEntry& part : directory.parts) count += part.surface ? 2 : 1;
  return count;
}

std::uint64_t lay_out(SceneDirectory& directory, std::uint64_t first_byte) {
  std::uint64_t at = first_byte;
  const auto place = [&at](std::uint64_t& offset, std::uint64_t bytes) {
    offset = container_aligned(at);
    if (bytes > 0) at = std::min(offset + bytes, largest_file);  // a surface may be its base page alone
  };
  for (BlockRef* block : blocks_in_order(directory)) place(block->offset, block->bytes);
  for (ScenePartEntry& part : directory.parts)
    if (part.surface) place(part.surface->pages_offset, part.surface->pages_bytes);
  return at;
}

std::vector<SceneInstance> instances_of(const Scene& scene) {
  std::vector<SceneInstance> instances;
  for (std::uint32_t i = 0; i < scene.nodes.size(); ++i)
    if (scene.nodes[i].part != no_index)
      instances.push_back({i, scene.nodes[i].part, scene.nodes[i].material});
  return instances;
}

Box3d world_box(const SceneDirectory& directory) {
  Box3d box;
  const auto world = world_transforms(directory.scene);
  for (const SceneInstance& i : instances_of(directory.scene))
    box.add(map_box(world[i.node], directory.parts[i.part].box));
  return box;
}

std::vector<std::byte> encode_scene_directory(const SceneDirectory& d) {
  ByteWriter w;
  put_text(w, d.metadata);
  w.put_varint(d.scene.nodes.size());
  for (const SceneNode& node : d.scene.nodes) put_node(w, node);
  w.put_varint(d.scene.materials.size());
  for (const SceneMaterial& m : d.scene.materials) put_material(w, m);
  w.put_varint(d.scene.clips.size());
  for (const SceneClip& clip : d.scene.clips) put_clip(w, clip);
  w.put_varint(d.parts.size());
  for (const ScenePartEntry& part : d.parts) put_part(w, part);
  ByteWriter out;
  out.put(scene_directory_version);
  out.put_varint(w.size());
  out.put_bytes(packed(w.bytes()));
  return out.take();
}

Result<SceneDirectory> decode_scene_directory(std::span<const std::byte> bytes, std::uint64_t first_byte) {
  const auto plain = unpacked(bytes);
  if (!plain) return fail(plain.error());
  ByteReader r(*plain);
  SceneDirectory d;
  if (!get_tables(r, d)) return corrupt("a table is damaged");
  if (const auto fault = fault_of(d.scene, d.parts.size()); !fault.empty()) return corrupt(fault);
  lay_out(d, first_byte);
  return d;
}

}  // namespace cuesta
