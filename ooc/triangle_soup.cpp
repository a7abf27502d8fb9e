#include "ooc/triangle_soup.h"

#include <algorithm>
#include <cstring>

namespace cuesta {
namespace {

/// Appends to, or takes from, a record.
class Cursor {
 public:
  explicit Cursor(std::byte* at) : at_(at) {}
  template <class T>
  void put(const T& value) {
    std::memcpy(at_, &value, sizeof(T));
    at_ += sizeof(T);
  }

 private:
  std::byte* at_;
};

template <class T>
void take(const std::byte*& at, std::vector<T>& out, std::size_t count) {
  const std::size_t old = out.size();
  out.resize(old + count);
  std::memcpy(out.data() + old, at, count * sizeof(T));
  at += count * sizeof(T);
}

}  // namespace

std::span<const std::byte> encode(const SoupTriangle& t, const SoupLayout& layout,
                                  std::span<std::byte, max_soup_record_bytes> out) {
  Cursor c(out.data());
  c.put(t.ordinal);
  c.put(t.owner);
  c.put(t.positions);
  if (layout.attributes.normals) c.put(t.normals);
  if (layout.attributes.colours) c.put(t.colours);
  if (layout.attributes.texcoords) c.put(t.texcoords);
  if (layout.area_normals) c.put(t.area_normal);
  return out.first(layout.record_bytes());
}

TriangleSoup decode_soup(std::span<const std::byte> records, const SoupLayout& layout) {
  const std::size_t stride = layout.record_bytes();
  const std::size_t count = records.size() / stride;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::memcpy(&order[i].first, records.data() + i * stride, sizeof(std::uint64_t));
    order[i].second = i;
  }
  if (!std::is_sorted(order.begin(), order.end())) std::sort(order.begin(), order.end());
  TriangleSoup soup;
  soup.ordinals.reserve(count);
  soup.owners.reserve(count);
  soup.corners.reserve(count * 3, layout.attributes);
  if (layout.area_normals) soup.area_normals.reserve(count);
  for (const auto& [ordinal, i] : order) {
    const std::byte* at = records.data() + i * stride;
    take(at, soup.ordinals, 1);
    take(at, soup.owners, 1);
    take(at, soup.corners.positions, 3);
    if (layout.attributes.normals) take(at, soup.corners.normals, 3);
    if (layout.attributes.colours) take(at, soup.corners.colours, 3);
    if (layout.attributes.texcoords) take(at, soup.corners.texcoords, 3);
    if (layout.area_normals) take(at, soup.area_normals, 1);
  }
  return soup;
}

}  // namespace cuesta
