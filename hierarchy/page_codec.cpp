#include "hierarchy/page_codec.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "hierarchy/packed_planes.h"
#include "hierarchy/sphere_codec.h"
#include "hierarchy/triangle_codec.h"
#include "hierarchy/vertex_codec.h"
#include "ooc/byte_stream.h"
#include "ooc/check.h"

// Layout of a page (all little-endian; docs/format.md):
//   u8 codec version, u8 flags, u32 round, u32 vertices, u32 triangles, u32 owned, u32 fans, u32 strict fans,
//   u32 children, u32 sources,
//   then for each stream in PageStream order its planes, each: varint raw bytes, varint stored bytes, stored
//   bytes (zstd, or raw when the two sizes are equal).

namespace cuesta {
namespace {

constexpr std::uint8_t codec_version = 3;
constexpr std::uint8_t flag_base = 1, flag_normals = 2, flag_colours = 4, flag_texcoords = 8,
                       flag_wedges = 16;

using Planes = std::vector<Plane>;
using Streams = std::array<Planes, page_stream_count>;

/// A stream of numbers in one plane of classes, and the bits.
constexpr std::size_t number_planes = 2;
constexpr std::size_t error_planes = 2;

constexpr std::array<std::size_t, page_stream_count> planes_of_stream{triangle_planes,
                                                                      position_planes,
                                                                      normal_planes,
                                                                      colour_planes,
                                                                      texcoord_planes,
                                                                      number_planes /* fan centres */,
                                                                      number_planes,
                                                                      sphere_planes,
                                                                      number_planes /* child vertices */,
                                                                      error_planes,
                                                                      1,
                                                                      1,
                                                                      1,
                                                                      1,
                                                                      1};

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

// ---- streams as planes
// --------------------------------------------------------------------------------------

Planes one_plane(ByteWriter& w) {
  Planes planes;
  planes.push_back(w.take());
  return planes;
}

void pack_fans(const Page& page, Streams& out) {
  NumberWriter centres(1), sizes(1);
  std::int64_t centre = 0;
  for (const Fan& fan : page.script.fans) {
    centres.put_signed(0, fan.centre - std::exchange(centre, fan.centre));
    sizes.put(0, fan.child_count);
  }
  out[static_cast<std::size_t>(PageStream::fan_centres)] = centres.take();
  out[static_cast<std::size_t>(PageStream::fan_sizes)] = sizes.take();
}

void pack_children(const Page& page, Streams& out) {
  NumberWriter vertices(1);
  Planes errors(error_planes);
  ByteWriter wedges;
  const bool wedged = has_wedges(page);
  for (const Fan& fan : page.script.fans) {
    ErrorCode8 before = 0;
    for (std::uint32_t i = 0; i < fan.child_count; ++i) {
      const Child& c = page.script.children[fan.first_child + i];
      vertices.put_signed(0, static_cast<std::int64_t>(c.vertex) - fan.centre);
      errors[i == 0 ? 0 : 1].push_back(static_cast<std::byte>(c.error - std::exchange(before, c.error)));
      if (wedged) wedges.put_varint(((c.target - fan.centre) << 1) | (c.joined ? 1u : 0u));
    }
  }
  out[static_cast<std::size_t>(PageStream::child_vertices)] = vertices.take();
  out[static_cast<std::size_t>(PageStream::child_errors)] = std::move(errors);
  out[static_cast<std::size_t>(PageStream::child_wedges)] = one_plane(wedges);
}

Streams pack_streams(const Page& page) {
  Streams out;
  const auto at = [&out](PageStream s) -> Planes& { return out[static_cast<std::size_t>(s)]; };
  std::vector<Hint> hints;
  at(PageStream::triangles) = pack_triangles(page.triangles, page.vertex_count, hints);
  const OwnedMesh mesh(page, hints);
  const auto places = local_positions(page);
  at(PageStream::positions) = pack_positions(mesh, places);
  at(PageStream::normals) = pack_normals(mesh, places, page);
  at(PageStream::colours) = pack_colours(mesh, page.owned.colours);
  at(PageStream::texcoords) = pack_texcoords(mesh, page.owned.texcoords);
  at(PageStream::fan_spheres) = pack_spheres(page, places);
  pack_fans(page, out);
  pack_children(page, out);

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
  at(PageStream::wedge_tails) = one_plane(tails);
  orphans.put_varint(page.orphans.size());
  put_ascending(orphans, page.orphans);
  at(PageStream::orphans) = one_plane(orphans);
  for (const PageSource& s : page.sources) {
    source_triangles.put_varint(s.page);
    source_triangles.put_varint(s.triangles.size());
    put_ascending(source_triangles, s.triangles);
    source_vertices.put_varint(s.vertices.size());
    put_ascending(source_vertices, s.vertices);
    put_ascending(source_vertices, s.local_vertices);
  }
  at(PageStream::source_triangles) = one_plane(source_triangles);
  at(PageStream::source_vertices) = one_plane(source_vertices);
  return out;
}

// ---- and back
// -----------------------------------------------------------------------------------------------

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
std::int64_t get_near(NumberReader& r, std::int64_t from, std::uint32_t vertices) {
  const std::int64_t v = from + r.get_signed(0);
  return v >= 0 && v < vertices ? v : -1;
}

bool unpack_fans(const Streams& in, const Counts& n, Script& script) {
  const auto planes = [&in](PageStream s) { return std::span(in[static_cast<std::size_t>(s)]); };
  NumberReader centres(planes(PageStream::fan_centres)), sizes(planes(PageStream::fan_sizes));
  script.fans.resize(n.fans);
  std::uint32_t children = 0;
  std::int64_t before = 0;
  for (Fan& fan : script.fans) {
    const std::int64_t centre = get_near(centres, before, n.vertices);
    const std::uint64_t size = sizes.get(0);
    if (centre < 0 || size == 0 || size > max_fan_children || size > n.children - children) return false;
    fan = {static_cast<std::uint32_t>(centre), children, static_cast<std::uint32_t>(size), {}};
    children += fan.child_count;
    before = centre;
  }
  return children == n.children && centres.at_end() && sizes.at_end();
}

/// Children of the fans. A vertex goes once, to one that is still there; errors do not fall along a fan, and
/// joined wedges share one.
bool unpack_children(const Streams& in, const Counts& n, Script& script, std::vector<std::uint8_t>& removed) {
  const auto planes = [&in](PageStream s) { return std::span(in[static_cast<std::size_t>(s)]); };
  NumberReader vertices(planes(PageStream::child_vertices));
  const auto errors = planes(PageStream::child_errors);
  if (errors[0].size() != n.fans || errors[1].size() != n.children - n.fans) return false;
  ByteReader wedges(planes(PageStream::child_wedges)[0]);
  script.children.resize(n.children);
  std::size_t later = 0;
  for (std::uint32_t f = 0; f < n.fans; ++f) {
    const Fan& fan = script.fans[f];
    unsigned error = 0;
    for (std::uint32_t i = 0; i < fan.child_count; ++i) {
      const std::int64_t vertex = get_near(vertices, fan.centre, n.vertices);
      const std::uint64_t wedge = (n.flags & flag_wedges) ? wedges.get_varint() : 0;
      const std::uint64_t target = fan.centre + (wedge >> 1);
      if (vertex < 0 || target >= n.vertices) return false;
      const unsigned rise = static_cast<unsigned>(i == 0 ? errors[0][f] : errors[1][later++]);
      error += rise;
      Child& child = script.children[fan.first_child + i];
      child = {static_cast<std::uint32_t>(vertex), static_cast<std::uint32_t>(target),
               static_cast<ErrorCode8>(error), (wedge & 1) != 0};
      if (error > 255 || (child.joined && (i == 0 || rise != 0))) return false;
      if (removed[child.vertex] || removed[child.target] || child.vertex == child.target) return false;
      removed[child.vertex] = 1;
    }
  }
  return vertices.at_end() && wedges.at_end();
}

bool unpack_script(const Streams& in, const Counts& n, Page& page) {
  if (n.children < n.fans) return false;
  std::vector<std::uint8_t> removed(n.vertices, 0);
  if (!unpack_fans(in, n, page.script) || !unpack_children(in, n, page.script, removed)) return false;
  ByteReader orphans(in[static_cast<std::size_t>(PageStream::orphans)][0]);
  if (!get_ascending(orphans, orphans.get_varint(), page.orphans) || !orphans.at_end()) return false;
  for (std::uint32_t v : page.orphans)
    if (v >= n.vertices || std::exchange(removed[v], std::uint8_t{1}) != 0) return false;
  return n.owned == (page.base ? n.vertices : n.children + page.orphans.size());
}

bool unpack_wedge_tails(std::span<const std::byte> in, Page& page) {
  ByteReader r(in);
  const auto& tails = page.wedge_tails;
  return get_ascending(r, r.get_varint(), page.wedge_tails) && r.at_end() &&
         (tails.empty() || (tails.front() > 0 && tails.back() < page.vertex_count));
}

bool unpack_sources(const Streams& in, const Counts& n, Page& page) {
  ByteReader triangles(in[static_cast<std::size_t>(PageStream::source_triangles)][0]);
  ByteReader vertices(in[static_cast<std::size_t>(PageStream::source_vertices)][0]);
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
  if (n.owned > n.vertices) return corrupt("it owns more vertices than it has");
  return n;
}

/// Upper bound of a plane's raw size: what the counts in the header can need.
std::uint64_t raw_bound(PageStream s, const Counts& n) {
  constexpr std::uint64_t number_bytes = number_bits / 8;
  switch (s) {
    case PageStream::triangles:
      return number_bytes * 3 * n.triangles;
    case PageStream::positions:
      return number_bytes * 3 * n.owned;
    case PageStream::normals:
    case PageStream::texcoords:
      return number_bytes * 2 * n.owned;
    case PageStream::colours:
      return n.owned;
    case PageStream::fan_centres:
    case PageStream::fan_sizes:
    case PageStream::fan_spheres:
      return number_bytes * n.fans;
    case PageStream::child_vertices:
    case PageStream::child_errors:
      return number_bytes * n.children;
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

/// Places of all local vertices, of which the survivors' are there.
std::vector<Vec3i> places_of_survivors(const OwnedMesh& mesh, std::span<const Vec3i> survivors) {
  std::vector<Vec3i> places(mesh.local_count());
  std::size_t next = 0;
  for (std::uint32_t v = 0; v < places.size(); ++v)
    if (mesh.number(v) == OwnedMesh::nobody) places[v] = survivors[next++];
  return places;
}

std::vector<Vec3i> places_of_owned(const OwnedMesh& mesh, std::span<const Vec3i> places) {
  std::vector<Vec3i> owned(mesh.count());
  for (std::size_t v = 0; v < owned.size(); ++v) owned[v] = places[mesh.local(v)];
  return owned;
}

Result<Streams> read_streams(ByteReader& r, const Counts& n) {
  PlaneDecompressor planes;
  Streams streams;
  for (std::size_t s = 0; s < page_stream_count; ++s)
    for (std::size_t p = 0; p < planes_of_stream[s]; ++p) {
      auto plane = planes.read(r, raw_bound(static_cast<PageStream>(s), n));
      if (!plane) {
        plane.error().place = "stream " + std::string(name(static_cast<PageStream>(s)));
        return fail(plane.error());
      }
      streams[s].push_back(std::move(*plane));
    }
  if (!r.at_end()) return corrupt("bytes after the last stream");
  return streams;
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
  PlaneCompressor compressor;
  for (std::size_t s = 0; s < page_stream_count; ++s) {
    CUESTA_CHECK(streams[s].size() == planes_of_stream[s], s, streams[s].size());
    const std::size_t before = out.size();
    for (const Plane& plane : streams[s]) compressor.write(out, plane);
    if (spent) (*spent)[s] += out.size() - before;
  }
  return out.take();
}

Result<PageStreamBytes> bytes_per_stream(std::span<const std::byte> page) {
  ByteReader r(page);
  if (const auto counts = read_counts(r); !counts) return fail(counts.error());
  PageStreamBytes spent{};
  for (std::size_t s = 0; s < page_stream_count; ++s) {
    const std::size_t before = r.position();
    for (std::size_t p = 0; p < planes_of_stream[s]; ++p)
      if (const auto plane = stored_plane(r); !plane) return fail(plane.error());
    spent[s] = r.position() - before;
  }
  return spent;
}

Result<Page> decode_page(std::span<const std::byte> bytes, std::span<const Vec3i> survivors) {
  ByteReader r(bytes);
  const auto counts = read_counts(r);
  if (!counts) return fail(counts.error());
  const Counts& n = *counts;
  const auto streams = read_streams(r, n);
  if (!streams) return fail(streams.error());
  const auto at = [&](PageStream s) -> const Planes& { return (*streams)[static_cast<std::size_t>(s)]; };
  // What a page has no flag for has no bytes.
  const auto none = [&](PageStream s) {
    return std::all_of(at(s).begin(), at(s).end(), [](const Plane& p) { return p.empty(); });
  };
  if (survivors.size() != n.vertices - n.owned)
    return corrupt("it has " + std::to_string(n.vertices - n.owned) + " survivors, and coarser pages " +
                   std::to_string(survivors.size()));
  Page page;
  page.round = n.round;
  page.base = (n.flags & flag_base) != 0;
  page.vertex_count = n.vertices;
  page.script.strict_fans = n.strict_fans;
  if (at(PageStream::triangles)[0].size() != n.triangles) return corrupt("damaged triangles");
  if (!unpack_script(*streams, n, page)) return corrupt("damaged script");
  if (!unpack_wedge_tails(at(PageStream::wedge_tails)[0], page)) return corrupt("damaged wedge groups");
  std::vector<Hint> hints;
  page.triangles.resize(n.triangles);
  if (!unpack_triangles(at(PageStream::triangles), n.vertices, page.triangles, hints))
    return corrupt("damaged triangles");
  const OwnedMesh mesh(page, hints);
  auto places = places_of_survivors(mesh, survivors);
  if (!unpack_positions(at(PageStream::positions), mesh, places)) return corrupt("damaged positions");
  page.survivors.assign(survivors.begin(), survivors.end());
  page.owned.positions = places_of_owned(mesh, places);
  if (!(n.flags & flag_normals ? unpack_normals(at(PageStream::normals), mesh, places, page)
                               : none(PageStream::normals)))
    return corrupt("damaged normals");
  if (!(n.flags & flag_colours ? unpack_colours(at(PageStream::colours), mesh, page.owned.colours)
                               : none(PageStream::colours)))
    return corrupt("damaged colours");
  if (!(n.flags & flag_texcoords ? unpack_texcoords(at(PageStream::texcoords), mesh, page.owned.texcoords)
                                 : none(PageStream::texcoords)))
    return corrupt("damaged texture coordinates");
  if (!unpack_sources(*streams, n, page)) return corrupt("damaged sources");
  if (!unpack_spheres(at(PageStream::fan_spheres), places, page)) return corrupt("damaged spheres");
  return page;
}

}  // namespace cuesta
