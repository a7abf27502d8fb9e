#include "ooc/triangle_soup.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>

#include "ooc/oct_normal.h"

// A record: u8 flags, u8 ordinal's high byte, u32 its low bytes; u32 owner where it is another's triangle;
// the first corner; the others less the first, as i16 or, if wide, as i32; then what the layout has: normals,
// colours, texture coordinates of the corners, the area normal as octahedral i16 pair and upper half of a
// float.

namespace cuesta {
namespace {

constexpr std::uint8_t flag_wide = 1, flag_foreign = 2;

/// Appends to a record.
class Cursor {
 public:
  explicit Cursor(std::byte* at) : at_(at) {}
  template <class T>
  void put(const T& value) {
    std::memcpy(at_, &value, sizeof(T));
    at_ += sizeof(T);
  }
  const std::byte* at() const { return at_; }

 private:
  std::byte* at_;
};

template <class T>
T take(const std::byte*& at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  at += sizeof(T);
  return value;
}

template <class T>
void take(const std::byte*& at, std::vector<T>& out, std::size_t count) {
  const std::size_t old = out.size();
  out.resize(old + count);
  std::memcpy(out.data() + old, at, count * sizeof(T));
  at += count * sizeof(T);
}

std::uint32_t bytes_of(std::uint8_t flags, const SoupLayout& layout) {
  return layout.typical_record_bytes() + ((flags & flag_wide) != 0 ? 12u : 0u) +
         ((flags & flag_foreign) != 0 ? 4u : 0u);
}

bool is_short(Vec3i d) {
  const auto fits = [](std::int32_t c) {
    return c >= std::numeric_limits<std::int16_t>::min() && c <= std::numeric_limits<std::int16_t>::max();
  };
  return fits(d.x) && fits(d.y) && fits(d.z);
}

/// In damaged records the sum may be too large: then it is another place, and no undefined behaviour.
Vec3i moved(Vec3i p, Vec3i by) {
  return vec_cast<std::int32_t>(vec_cast<std::uint32_t>(p) + vec_cast<std::uint32_t>(by));
}

void put_area_normal(Cursor& c, Vec3f n) {
  c.put(encode_oct(normalized(n), 16));
  c.put(static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(length(n)) >> 16));
}

Vec3f take_area_normal(const std::byte*& at) {
  const Vec3f direction = decode_oct(take<OctNormal>(at), 16);
  return direction * std::bit_cast<float>(std::uint32_t{take<std::uint16_t>(at)} << 16);
}

}  // namespace

std::span<const std::byte> encode(const SoupTriangle& t, std::uint32_t bucket, const SoupLayout& layout,
                                  std::span<std::byte, max_soup_record_bytes> out) {
  const std::array<Vec3i, 2> others{t.positions[1] - t.positions[0], t.positions[2] - t.positions[0]};
  const bool wide = !is_short(others[0]) || !is_short(others[1]);
  const bool foreign = t.owner != bucket;
  Cursor c(out.data());
  c.put(static_cast<std::uint8_t>((wide ? flag_wide : 0) | (foreign ? flag_foreign : 0)));
  c.put(static_cast<std::uint8_t>(t.ordinal >> 32));
  c.put(static_cast<std::uint32_t>(t.ordinal));
  if (foreign) c.put(t.owner);
  c.put(t.positions[0]);
  for (const Vec3i& d : others) {
    if (wide)
      c.put(d);
    else
      c.put(vec_cast<std::int16_t>(d));
  }
  if (layout.attributes.normals) c.put(t.normals);
  if (layout.attributes.colours) c.put(t.colours);
  if (layout.attributes.texcoords) c.put(t.texcoords);
  if (layout.area_normals) put_area_normal(c, t.area_normal);
  return out.first(static_cast<std::size_t>(c.at() - out.data()));
}

TriangleSoup decode_soup(std::span<const std::byte> records, std::uint32_t bucket, const SoupLayout& layout) {
  std::vector<std::pair<std::uint64_t, std::size_t>> order;  // ordinal, offset
  order.reserve(records.size() / layout.typical_record_bytes());
  for (std::size_t at = 0; at < records.size();) {
    const std::uint32_t bytes = bytes_of(static_cast<std::uint8_t>(records[at]), layout);
    if (bytes > records.size() - at) break;
    const std::byte* p = records.data() + at + 1;
    const std::uint64_t high = take<std::uint8_t>(p);
    order.emplace_back(high << 32 | take<std::uint32_t>(p), at);
    at += bytes;
  }
  if (!std::is_sorted(order.begin(), order.end())) std::sort(order.begin(), order.end());
  TriangleSoup soup;
  soup.ordinals.reserve(order.size());
  soup.owners.reserve(order.size());
  soup.corners.reserve(order.size() * 3, layout.attributes);
  if (layout.area_normals) soup.area_normals.reserve(order.size());
  for (const auto& [ordinal, offset] : order) {
    const std::byte* at = records.data() + offset;
    const auto flags = take<std::uint8_t>(at);
    at += 5;
    soup.ordinals.push_back(ordinal);
    soup.owners.push_back((flags & flag_foreign) != 0 ? take<std::uint32_t>(at) : bucket);
    const auto first = take<Vec3i>(at);
    soup.corners.positions.push_back(first);
    for (int k = 0; k < 2; ++k) {
      const Vec3i d =
          (flags & flag_wide) != 0 ? take<Vec3i>(at) : vec_cast<std::int32_t>(take<Vec3<std::int16_t>>(at));
      soup.corners.positions.push_back(moved(first, d));
    }
    if (layout.attributes.normals) take(at, soup.corners.normals, 3);
    if (layout.attributes.colours) take(at, soup.corners.colours, 3);
    if (layout.attributes.texcoords) take(at, soup.corners.texcoords, 3);
    if (layout.area_normals) soup.area_normals.push_back(take_area_normal(at));
  }
  return soup;
}

SoupTriangle triangle_of(const TriangleSoup& soup, std::size_t i) {
  const VertexTable& corners = soup.corners;
  SoupTriangle t;
  t.ordinal = soup.ordinals[i];
  t.owner = soup.owners[i];
  for (std::size_t k = 0; k < 3; ++k) {
    t.positions[k] = corners.positions[3 * i + k];
    if (!corners.normals.empty()) t.normals[k] = corners.normals[3 * i + k];
    if (!corners.colours.empty()) t.colours[k] = corners.colours[3 * i + k];
    if (!corners.texcoords.empty()) t.texcoords[k] = corners.texcoords[3 * i + k];
  }
  if (!soup.area_normals.empty()) t.area_normal = soup.area_normals[i];
  return t;
}

void remove_triangles(std::vector<std::byte>& records, std::span<const std::uint64_t> ordinals,
                      const SoupLayout& layout) {
  if (ordinals.empty()) return;
  std::size_t kept = 0;
  for (std::size_t at = 0; at < records.size();) {
    const std::uint32_t bytes = bytes_of(static_cast<std::uint8_t>(records[at]), layout);
    if (bytes > records.size() - at) break;
    const std::byte* p = records.data() + at + 1;
    const std::uint64_t high = take<std::uint8_t>(p);
    const std::uint64_t ordinal = high << 32 | take<std::uint32_t>(p);
    if (!std::binary_search(ordinals.begin(), ordinals.end(), ordinal)) {
      std::memmove(records.data() + kept, records.data() + at, bytes);
      kept += bytes;
    }
    at += bytes;
  }
  records.resize(kept);
}

}  // namespace cuesta
