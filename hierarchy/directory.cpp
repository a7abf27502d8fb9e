#include "hierarchy/directory.h"

#include <zstd.h>

#include <cmath>
#include <limits>

#include "hierarchy/page_codec.h"
#include "ooc/byte_stream.h"
#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr std::uint64_t largest_directory = std::uint64_t{1} << 31;
/// Block, five varints, two errors, a ball, and the number of coarser pages: an entry has no fewer bytes.
constexpr std::uint64_t least_entry_bytes = 24 + 5 + 2 + 16 + 1;

std::uint32_t get_count(ByteReader& r) {
  const std::uint64_t n = r.get_varint();
  return n > max_page_elements ? std::numeric_limits<std::uint32_t>::max() : static_cast<std::uint32_t>(n);
}

/// Pages are in order of their rounds, and lean only on the next one.
bool is_layered(const Directory& d) {
  for (PageId id = 0; id < d.pages.size(); ++id) {
    const PageEntry& e = d.pages[id];
    if (id != d.base() && e.coarser.empty()) return false;
    for (PageId c : e.coarser)
      if (c <= id || d.pages[c].round != e.round + 1) return false;
  }
  return d.pages.back().coarser.empty();
}

tl::unexpected<Error> corrupt(std::string what) {
  return fail(ErrorCode::corrupt, "", "directory", std::move(what));
}

}  // namespace

void put_page_entry(ByteWriter& w, const PageEntry& e) {
  w.put(e.block.offset);
  w.put(e.block.bytes);
  w.put(e.block.checksum);
  for (auto n : {e.round, e.vertices, e.triangles, e.owned_vertices, e.owned_triangles}) w.put_varint(n);
  w.put(e.least_error);
  w.put(e.largest_error);
  for (float f : {e.bound.centre.x, e.bound.centre.y, e.bound.centre.z, e.bound.radius}) w.put(f);
  w.put_varint(e.coarser.size());
  PageId previous = 0;
  for (PageId id : e.coarser) {
    w.put_varint(id - previous);
    previous = id;
  }
}

bool get_page_entry(ByteReader& r, std::uint64_t page_count, PageEntry& e) {
  e.block = {r.get<std::uint64_t>(), r.get<std::uint64_t>(), r.get<std::uint64_t>()};
  for (auto* n : {&e.round, &e.vertices, &e.triangles, &e.owned_vertices, &e.owned_triangles}) {
    *n = get_count(r);
    if (*n > max_page_elements) return false;
  }
  e.least_error = r.get<ErrorCode8>();
  e.largest_error = r.get<ErrorCode8>();
  for (float* f : {&e.bound.centre.x, &e.bound.centre.y, &e.bound.centre.z, &e.bound.radius}) {
    *f = r.get<float>();
    if (!std::isfinite(*f)) return false;
  }
  const std::uint64_t coarser = r.get_varint();
  if (coarser > r.remaining() || e.bound.radius < 0) return false;
  std::uint64_t id = 0;
  for (std::uint64_t i = 0; i < coarser; ++i) {
    const std::uint64_t step = r.get_varint();
    if ((i > 0 && step == 0) || step >= page_count - id) return false;
    id += step;
    e.coarser.push_back(static_cast<PageId>(id));
  }
  return r.ok() && e.owned_triangles <= e.triangles && e.owned_vertices <= e.vertices;
}

void put_vertical(ByteWriter& w, const Vertical& v) {
  for (double x : {v.axis.x, v.axis.y, v.axis.z}) w.put(x);
  w.put(static_cast<std::uint8_t>(v.is_plane));
  for (double x : {v.centre.x, v.centre.y, v.centre.z, v.stretch}) w.put(x);
}

bool get_vertical(ByteReader& r, Vertical& v) {
  for (double* x : {&v.axis.x, &v.axis.y, &v.axis.z}) *x = r.get<double>();
  v.is_plane = r.get<std::uint8_t>() != 0;
  for (double* x : {&v.centre.x, &v.centre.y, &v.centre.z, &v.stretch}) *x = r.get<double>();
  const double sum = length(v.axis) + length(v.centre) + v.stretch;
  return r.ok() && std::isfinite(sum) && std::abs(length(v.axis) - 1) < 1e-6 && v.stretch > -1;
}

std::vector<std::byte> encode_directory(const Directory& d) {
  ByteWriter w;
  for (double v : {d.grid.origin.x, d.grid.origin.y, d.grid.origin.z, d.grid.step}) w.put(v);
  for (const Vec3i& v : {d.lo, d.hi})
    for (int i = 0; i < 3; ++i) w.put(v[i]);
  w.put(d.vertices);
  w.put(d.triangles);
  w.put(static_cast<std::uint8_t>(d.has_normals | d.has_colours << 1 | d.has_texcoords << 2 |
                                  d.vertical.has_value() << 3));
  if (d.vertical) put_vertical(w, *d.vertical);
  w.put_varint(d.metadata.size());
  w.put_bytes(std::as_bytes(std::span(d.metadata)));
  w.put_varint(d.pages.size());
  for (const PageEntry& e : d.pages) put_page_entry(w, e);
  ByteWriter out;
  std::vector<std::byte> packed(ZSTD_compressBound(w.size()));
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), w.bytes().data(), w.size(), 9);
  CUESTA_CHECK(!ZSTD_isError(size), ZSTD_getErrorName(size));
  out.put_varint(w.size());
  out.put_bytes(std::span(packed).first(size));
  return out.take();
}

Result<Directory> decode_directory(std::span<const std::byte> bytes) {
  ByteReader outer(bytes);
  const std::uint64_t raw = outer.get_varint();
  // zstd cannot expand by more than this; a larger claim is a lie that must not be allocated.
  if (!outer.ok() || raw > largest_directory || raw / 65536 > bytes.size()) return corrupt("impossible size");
  std::vector<std::byte> plain(raw);
  const auto packed = outer.get_bytes(outer.remaining());
  const std::size_t got = ZSTD_decompress(plain.data(), plain.size(), packed.data(), packed.size());
  if (ZSTD_isError(got) || got != raw) return corrupt("zstd data are damaged");
  ByteReader r(plain);
  Directory d;
  for (double* v : {&d.grid.origin.x, &d.grid.origin.y, &d.grid.origin.z, &d.grid.step}) {
    *v = r.get<double>();
    if (!std::isfinite(*v)) return corrupt("the grid is not finite");
  }
  if (!(d.grid.step > 0)) return corrupt("the grid step is not positive");
  for (Vec3i* v : {&d.lo, &d.hi})
    for (int i = 0; i < 3; ++i) (*v)[i] = r.get<std::int32_t>();
  d.vertices = r.get<std::uint64_t>();
  d.triangles = r.get<std::uint64_t>();
  const auto flags = r.get<std::uint8_t>();
  d.has_normals = flags & 1;
  d.has_colours = flags & 2;
  d.has_texcoords = flags & 4;
  if (flags & 8 && !get_vertical(r, d.vertical.emplace())) return corrupt("the vertical is none");
  const auto text = r.get_bytes(r.get_varint());
  d.metadata.assign(reinterpret_cast<const char*>(text.data()), text.size());
  const std::uint64_t count = r.get_varint();
  if (!r.ok() || count == 0 || count > r.remaining() / least_entry_bytes)
    return corrupt("impossible number of pages");
  d.pages.resize(count);
  for (PageEntry& e : d.pages)
    if (!get_page_entry(r, count, e))
      return corrupt("entry " + std::to_string(&e - d.pages.data()) + " is damaged");
  if (!r.at_end()) return corrupt("bytes after the last entry");
  if (!is_layered(d)) return corrupt("pages lean on pages that are not of the next round");
  return d;
}

}  // namespace cuesta
