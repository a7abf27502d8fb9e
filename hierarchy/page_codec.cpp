#include "hierarchy/page_codec.h"

#include <meshoptimizer.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "ooc/byte_stream.h"
#include "ooc/check.h"
#include "ooc/triangle_order.h"

// Layout of a page (all little-endian; docs/format.md):
//   u8 codec version, u8 flags, u32 round, u32 vertices, u32 triangles, u32 owned, u32 fans, u32 strict fans,
//   u32 children, u32 sources,
//   then for each stream in PageStream order: varint raw bytes, varint stored bytes, stored bytes (zstd, or
//   raw when the two sizes are equal).

namespace cuesta {
namespace {

constexpr std::uint8_t codec_version = 1;
constexpr std::uint8_t flag_base = 1, flag_normals = 2, flag_colours = 4, flag_texcoords = 8,
                       flag_wedges = 16;
constexpr int zstd_level = 6;

using Bytes = std::vector<std::byte>;

struct Counts {
  std::uint8_t flags = 0;
  std::uint32_t round = 0, vertices = 0, triangles = 0, owned = 0, fans = 0, strict_fans = 0, children = 0,
                sources = 0;
};

bool has_wedges(const Page& page) {
  return std::any_of(page.script.fans.begin(), page.script.fans.end(), [&](const Fan& fan) {
    const auto first = page.script.children.begin() + fan.first_child;
    return std::any_of(first, first + fan.child_count,
                       [&](const Child& c) { return c.joined || c.target != fan.centre; });
  });
}

Counts counts_of(const Page& page) {
  Counts c;
  c.flags = static_cast<std::uint8_t>(
      (page.base ? flag_base : 0) | (page.owned.normals.empty() ? 0 : flag_normals) |
      (page.owned.colours.empty() ? 0 : flag_colours) | (page.owned.texcoords.empty() ? 0 : flag_texcoords) |
      (has_wedges(page) ? flag_wedges : 0));
  c.round = page.round;
  c.vertices = page.vertex_count;
  c.triangles = static_cast<std::uint32_t>(page.triangles.size());
  c.owned = static_cast<std::uint32_t>(page.owned.positions.size());
  c.fans = static_cast<std::uint32_t>(page.script.fans.size());
  c.strict_fans = page.script.strict_fans;
  c.children = static_cast<std::uint32_t>(page.script.children.size());
  c.sources = static_cast<std::uint32_t>(page.sources.size());
  return c;
}

// ---- streams as plain bytes
// -----------------------------------------------------------------------------------

/// meshoptimizer's vertex codec on an array of 4·k-byte elements.
template <class T>
Bytes pack_vertices(const std::vector<T>& v) {
  static_assert(sizeof(T) % 4 == 0);
  if (v.empty()) return {};
  Bytes out(meshopt_encodeVertexBufferBound(v.size(), sizeof(T)));
  out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(), v.data(),
                                        v.size(), sizeof(T)));
  return out;
}

template <class T>
bool unpack_vertices(std::span<const std::byte> in, std::size_t count, std::vector<T>& v) {
  v.resize(count);
  if (count == 0) return in.empty();
  return meshopt_decodeVertexBuffer(v.data(), count, sizeof(T),
                                    reinterpret_cast<const unsigned char*>(in.data()), in.size()) == 0;
}

Bytes pack_triangles(const Page& page) {
  if (page.triangles.empty()) return {};
  const std::size_t indices = page.triangles.size() * 3;
  Bytes out(meshopt_encodeIndexBufferBound(indices, page.vertex_count));
  out.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                       page.triangles.data()->data(), indices));
  return out;
}

/// The index codec turns triangles; ours have the lowest vertex first.
bool unpack_triangles(std::span<const std::byte> in, Page& page) {
  if (page.triangles.empty()) return in.empty();
  if (meshopt_decodeIndexBuffer(page.triangles.data()->data(), page.triangles.size() * 3,
                                sizeof(std::uint32_t), reinterpret_cast<const unsigned char*>(in.data()),
                                in.size()) != 0)
    return false;
  for (auto& t : page.triangles) {
    if (t[0] >= page.vertex_count || t[1] >= page.vertex_count || t[2] >= page.vertex_count) return false;
    if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]) return false;
    t = smallest_first(t);
  }
  return true;
}

std::array<Bytes, page_stream_count> pack_streams(const Page& page) {
  std::array<Bytes, page_stream_count> out;
  const auto at = [&out](PageStream s) -> Bytes& { return out[static_cast<std::size_t>(s)]; };
  at(PageStream::triangles) = pack_triangles(page);
  at(PageStream::positions) = pack_vertices(page.owned.positions);
  at(PageStream::normals) = pack_vertices(page.owned.normals);
  at(PageStream::colours) = pack_vertices(page.owned.colours);
  at(PageStream::texcoords) = pack_vertices(page.owned.texcoords);

  ByteWriter centres, sizes, spheres, vertices, errors, wedges;
  const bool wedged = has_wedges(page);
  std::int64_t previous = 0;
  for (const Fan& fan : page.script.fans) {
    centres.put_signed_varint(fan.centre - previous);
    previous = fan.centre;
    sizes.put_varint(fan.child_count);
    spheres.put(fan.sphere.radius);
    spheres.put(fan.sphere.offset_x);
    spheres.put(fan.sphere.offset_y);
    spheres.put(fan.sphere.offset_z);
    for (std::uint32_t i = 0; i < fan.child_count; ++i) {
      const Child& c = page.script.children[fan.first_child + i];
      vertices.put_signed_varint(static_cast<std::int64_t>(c.vertex) - fan.centre);
      errors.put(c.error);
      if (wedged) wedges.put_varint(((c.target - fan.centre) << 1) | (c.joined ? 1u : 0u));
    }
  }
  at(PageStream::fan_centres) = centres.take();
  at(PageStream::fan_sizes) = sizes.take();
  at(PageStream::fan_spheres) = spheres.take();
  at(PageStream::child_vertices) = vertices.take();
  at(PageStream::child_errors) = errors.take();
  at(PageStream::child_wedges) = wedges.take();

  ByteWriter tails, orphans, source_triangles, source_vertices;
  const auto put_ascending = [](ByteWriter& w, const std::vector<std::uint32_t>& v) {
    std::uint32_t next = 0;
    for (std::uint32_t x : v) {
      w.put_varint(x - next);
      next = x + 1;
    }
  };
  tails.put_varint(page.wedge_tails.size());
  put_ascending(tails, page.wedge_tails);
  at(PageStream::wedge_tails) = tails.take();
  orphans.put_varint(page.orphans.size());
  put_ascending(orphans, page.orphans);
  at(PageStream::orphans) = orphans.take();
  for (const PageSource& s : page.sources) {
    source_triangles.put_varint(s.page);
    source_triangles.put_varint(s.triangles.size());
    put_ascending(source_triangles, s.triangles);
    source_vertices.put_varint(s.vertices.size());
    put_ascending(source_vertices, s.vertices);
    put_ascending(source_vertices, s.local_vertices);
  }
  at(PageStream::source_triangles) = source_triangles.take();
  at(PageStream::source_vertices) = source_vertices.take();
  return out;
}

// ---- and back
// -------------------------------------------------------------------------------------------------

bool get_ascending(ByteReader& r, std::uint64_t count, std::vector<std::uint32_t>& v) {
  if (count > r.remaining()) return false;
  v.resize(count);
  std::uint64_t next = 0;
  for (auto& x : v) {
    const std::uint64_t gap = r.get_varint();
    if (gap >= max_page_elements || next + gap >= max_page_elements) return false;
    x = static_cast<std::uint32_t>(next + gap);
    next += gap + 1;
  }
  return r.ok();
}

/// A vertex number given as a difference; -1 when it is none of a page's.
std::int64_t get_near(ByteReader& r, std::int64_t from, std::uint32_t vertices) {
  const std::int64_t step = r.get_signed_varint();
  constexpr std::int64_t farthest = max_page_elements;
  if (step < -farthest || step > farthest) return -1;
  return from + step < vertices ? from + step : -1;
}

bool unpack_script(const std::array<Bytes, page_stream_count>& in, const Counts& n, Page& page) {
  const auto reader = [&in](PageStream s) { return ByteReader(in[static_cast<std::size_t>(s)]); };
  ByteReader centres = reader(PageStream::fan_centres), sizes = reader(PageStream::fan_sizes),
             spheres = reader(PageStream::fan_spheres), vertices = reader(PageStream::child_vertices),
             errors = reader(PageStream::child_errors), wedges = reader(PageStream::child_wedges);
  std::vector<std::uint8_t> removed(n.vertices, 0);
  std::int64_t centre = 0;
  page.script.fans.reserve(n.fans);
  page.script.children.reserve(n.children);
  for (std::uint32_t f = 0; f < n.fans; ++f) {
    centre = get_near(centres, centre, n.vertices);
    const std::uint64_t size = sizes.get_varint();
    if (centre < 0 || size == 0 || size > max_fan_children || size > n.children - page.script.children.size())
      return false;
    const auto v = static_cast<std::uint32_t>(centre);
    Fan fan{v, static_cast<std::uint32_t>(page.script.children.size()), static_cast<std::uint32_t>(size), {}};
    fan.sphere.radius = spheres.get<std::uint16_t>();
    fan.sphere.offset_x = spheres.get<std::int8_t>();
    fan.sphere.offset_y = spheres.get<std::int8_t>();
    fan.sphere.offset_z = spheres.get<std::int8_t>();
    if (fan.sphere.radius >= 0x7F80) return false;  // negative, infinite or not a number
    page.script.fans.push_back(fan);
    for (std::uint64_t i = 0; i < size; ++i) {
      const std::int64_t vertex = get_near(vertices, centre, n.vertices);
      const std::uint64_t wedge = (n.flags & flag_wedges) ? wedges.get_varint() : 0;
      const std::uint64_t target = static_cast<std::uint64_t>(centre) + (wedge >> 1);
      if (vertex < 0 || target >= n.vertices) return false;
      Child child{static_cast<std::uint32_t>(vertex), static_cast<std::uint32_t>(target),
                  errors.get<std::uint8_t>(), (wedge & 1) != 0};
      // A vertex goes once, to one that is still there; errors do not fall along a fan, and joined wedges
      // share one.
      if (removed[child.vertex] || removed[child.target] || child.vertex == child.target) return false;
      if (i == 0 ? child.joined : child.error < page.script.children.back().error) return false;
      if (child.joined && child.error != page.script.children.back().error) return false;
      removed[child.vertex] = 1;
      page.script.children.push_back(child);
    }
  }
  ByteReader orphans = reader(PageStream::orphans);
  if (!get_ascending(orphans, orphans.get_varint(), page.orphans) || !orphans.at_end()) return false;
  for (std::uint32_t v : page.orphans)
    if (v >= n.vertices || std::exchange(removed[v], std::uint8_t{1}) != 0) return false;
  const std::size_t gone = page.script.children.size() + page.orphans.size();
  return page.script.children.size() == n.children && n.owned == (page.base ? n.vertices : gone) &&
         centres.at_end() && sizes.at_end() && spheres.at_end() && vertices.at_end() && errors.at_end() &&
         wedges.at_end();
}

bool unpack_wedge_tails(std::span<const std::byte> in, Page& page) {
  ByteReader r(in);
  const auto& tails = page.wedge_tails;
  return get_ascending(r, r.get_varint(), page.wedge_tails) && r.at_end() &&
         (tails.empty() || (tails.front() > 0 && tails.back() < page.vertex_count));
}

bool unpack_sources(const std::array<Bytes, page_stream_count>& in, const Counts& n, Page& page) {
  ByteReader triangles(in[static_cast<std::size_t>(PageStream::source_triangles)]);
  ByteReader vertices(in[static_cast<std::size_t>(PageStream::source_vertices)]);
  std::uint32_t first = 0;
  if (n.sources > triangles.remaining()) return false;
  page.sources.resize(n.sources);
  for (PageSource& s : page.sources) {
    const std::uint64_t id = triangles.get_varint();
    if (id > std::numeric_limits<PageId>::max()) return false;
    s.page = static_cast<PageId>(id);
    s.first_triangle = first;
    if (!get_ascending(triangles, triangles.get_varint(), s.triangles)) return false;
    if (s.triangles.size() > n.triangles - first) return false;
    first += static_cast<std::uint32_t>(s.triangles.size());
    const std::uint64_t count = vertices.get_varint();
    if (!get_ascending(vertices, count, s.vertices) || !get_ascending(vertices, count, s.local_vertices))
      return false;
    if (!s.local_vertices.empty() && s.local_vertices.back() >= n.vertices) return false;
  }
  return (n.sources == 0 || first == n.triangles) && triangles.at_end() && vertices.at_end();
}

tl::unexpected<Error> corrupt(std::string what) {
  return fail(ErrorCode::corrupt, "", "", std::move(what));
}

Result<Counts> read_counts(ByteReader& r) {
  const auto version = r.get<std::uint8_t>();
  if (r.ok() && version != codec_version)
    return fail(
        ErrorCode::unsupported_version, "", "",
        "page codec " + std::to_string(version) + ", this program reads " + std::to_string(codec_version));
  Counts n;
  n.flags = r.get<std::uint8_t>();
  for (auto* field :
       {&n.round, &n.vertices, &n.triangles, &n.owned, &n.fans, &n.strict_fans, &n.children, &n.sources})
    *field = r.get<std::uint32_t>();
  if (!r.ok()) return corrupt("the page ends within its header");
  for (auto count : {n.vertices, n.triangles, n.owned, n.fans, n.children, n.sources})
    if (count > max_page_elements || n.strict_fans > n.fans)
      return corrupt("a count of " + std::to_string(count) + " is beyond any page");
  return n;
}

/// Upper bound of a stream's raw size: what the counts in the header can need.
std::uint64_t raw_bound(PageStream s, const Counts& n) {
  switch (s) {
    case PageStream::triangles:
      return meshopt_encodeIndexBufferBound(std::size_t{n.triangles} * 3, n.vertices);
    case PageStream::positions:
      return meshopt_encodeVertexBufferBound(n.owned, 12);
    case PageStream::normals:
    case PageStream::colours:
      return meshopt_encodeVertexBufferBound(n.owned, 4);
    case PageStream::texcoords:
      return meshopt_encodeVertexBufferBound(n.owned, 8);
    case PageStream::fan_centres:
    case PageStream::fan_sizes:
    case PageStream::fan_spheres:
      return std::uint64_t{10} * n.fans;
    case PageStream::child_vertices:
    case PageStream::child_errors:
    case PageStream::child_wedges:
      return std::uint64_t{10} * n.children;
    case PageStream::wedge_tails:
      return 10 + std::uint64_t{10} * n.vertices;
    case PageStream::orphans:
      return 10 + std::uint64_t{10} * n.owned;
    case PageStream::source_triangles:
      return std::uint64_t{20} * n.sources + std::uint64_t{10} * n.triangles;
    // A vertex can be shared by several sources; four on average is beyond any mesh.
    case PageStream::source_vertices:
      return std::uint64_t{20} * n.sources + std::uint64_t{80} * n.vertices;
    case PageStream::count:
      break;
  }
  return 0;
}

Result<Bytes> read_stream(ByteReader& r, std::uint64_t bound) {
  const std::uint64_t raw = r.get_varint();
  const std::uint64_t stored = r.get_varint();
  if (!r.ok() || stored > r.remaining()) return corrupt("the page ends within a stream");
  // zstd cannot expand by more than this; a larger claim is a lie that must not be allocated.
  if (raw > bound || raw / 65536 > stored) return corrupt("larger than the page's counts or bytes allow");
  const auto bytes = r.get_bytes(stored);
  if (raw == stored) return Bytes(bytes.begin(), bytes.end());
  Bytes out(raw);
  const std::size_t got = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(got) || got != raw) return corrupt("zstd data are damaged");
  return out;
}

void write_stream(ByteWriter& w, const Bytes& raw) {
  Bytes packed(ZSTD_compressBound(raw.size()));
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), zstd_level);
  CUESTA_CHECK(!ZSTD_isError(size), ZSTD_getErrorName(size));
  w.put_varint(raw.size());
  const bool smaller = size < raw.size();
  w.put_varint(smaller ? size : raw.size());
  w.put_bytes(smaller ? std::span<const std::byte>(packed.data(), size) : std::span<const std::byte>(raw));
}

}  // namespace

std::string_view name(PageStream stream) {
  constexpr std::array<std::string_view, page_stream_count> names{
      "triangles",    "positions",   "normals",     "colours",          "texcoords",
      "fan centres",  "fan sizes",   "fan spheres", "child vertices",   "child errors",
      "child wedges", "wedge tails", "orphans",     "source triangles", "source vertices"};
  return names.at(static_cast<std::size_t>(stream));
}

std::vector<std::byte> encode_page(const Page& page, PageStreamBytes* spent) {
  ByteWriter out;
  const Counts n = counts_of(page);
  CUESTA_CHECK(n.owned == (page.base ? n.vertices : n.children + page.orphans.size()), n.owned, n.children);
  out.put(codec_version);
  out.put(n.flags);
  for (auto field : {n.round, n.vertices, n.triangles, n.owned, n.fans, n.strict_fans, n.children, n.sources})
    out.put(field);
  const auto streams = pack_streams(page);
  for (std::size_t s = 0; s < page_stream_count; ++s) {
    const std::size_t before = out.size();
    write_stream(out, streams[s]);
    if (spent) (*spent)[s] += out.size() - before;
  }
  return out.take();
}

Result<Page> decode_page(std::span<const std::byte> bytes) {
  ByteReader r(bytes);
  auto counts = read_counts(r);
  if (!counts) return fail(counts.error());
  const Counts& n = *counts;
  std::array<Bytes, page_stream_count> streams;
  for (std::size_t s = 0; s < page_stream_count; ++s) {
    auto stream = read_stream(r, raw_bound(static_cast<PageStream>(s), n));
    if (!stream) {
      stream.error().place = "stream " + std::string(name(static_cast<PageStream>(s)));
      return fail(stream.error());
    }
    streams[s] = std::move(*stream);
  }
  if (!r.at_end()) return corrupt("bytes after the last stream");
  Page page;
  page.round = n.round;
  page.base = (n.flags & flag_base) != 0;
  page.vertex_count = n.vertices;
  page.script.strict_fans = n.strict_fans;
  page.triangles.resize(n.triangles);
  const auto at = [&streams](PageStream s) {
    return std::span<const std::byte>(streams[static_cast<std::size_t>(s)]);
  };
  const auto optional_count = [&n](std::uint8_t flag) { return (n.flags & flag) ? n.owned : 0u; };
  if (!unpack_triangles(at(PageStream::triangles), page)) return corrupt("damaged triangles");
  if (!unpack_vertices(at(PageStream::positions), n.owned, page.owned.positions))
    return corrupt("damaged positions");
  if (!unpack_vertices(at(PageStream::normals), optional_count(flag_normals), page.owned.normals))
    return corrupt("damaged normals");
  if (!unpack_vertices(at(PageStream::colours), optional_count(flag_colours), page.owned.colours))
    return corrupt("damaged colours");
  if (!unpack_vertices(at(PageStream::texcoords), optional_count(flag_texcoords), page.owned.texcoords))
    return corrupt("damaged texture coordinates");
  if (!unpack_script(streams, n, page)) return corrupt("damaged script");
  if (!unpack_wedge_tails(at(PageStream::wedge_tails), page)) return corrupt("damaged wedge groups");
  if (!unpack_sources(streams, n, page)) return corrupt("damaged sources");
  return page;
}

}  // namespace cuesta
