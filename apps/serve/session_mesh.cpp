#include "apps/serve/session_mesh.h"

#include <zstd.h>

#include <limits>

#include "apps/serve/session_codec.h"
#include "ooc/byte_stream.h"

namespace cuesta::serve {
namespace {

constexpr std::array<std::uint32_t, 3> nothing{no_vertex, no_vertex, no_vertex};

tl::unexpected<Error> corrupt(const char* what) {
  return fail(ErrorCode::corrupt, "session", "", what);
}

/// A list of ascending slots: how many, then differences, the first to -1.
class SlotList {
 public:
  explicit SlotList(ByteReader& r) : r_(r), left_(r.get_varint()) {}
  std::uint64_t left() const { return left_; }
  /// @return most_slots where they are not ascending, or too large.
  std::uint32_t next() {
    --left_;
    const std::uint64_t difference = r_.get_varint();
    if (difference == 0 || difference > SessionMesh::most_slots) return SessionMesh::most_slots;
    slot_ += difference;
    return slot_ - 1 < SessionMesh::most_slots ? static_cast<std::uint32_t>(slot_ - 1)
                                               : SessionMesh::most_slots;
  }

 private:
  ByteReader& r_;
  std::uint64_t left_, slot_ = 0;
};

/// @return false where a slot is not one of `size` and as many as are new.
bool read_slots(ByteReader& r, std::size_t size, bool may_grow, std::vector<std::uint32_t>& slots) {
  SlotList list(r);
  slots.clear();
  if (list.left() > r.remaining()) return false;  // each takes a byte at least
  const std::uint64_t end =
      std::min<std::uint64_t>(SessionMesh::most_slots, size + (may_grow ? list.left() : 0));
  slots.reserve(list.left());
  while (list.left() > 0) {
    slots.push_back(list.next());
    if (slots.back() >= end) return false;
  }
  return r.ok();
}

template <class Number>
bool read_difference(ByteReader& r, Number& value) {
  const std::uint64_t sum = static_cast<std::uint64_t>(static_cast<std::int64_t>(value)) +
                            static_cast<std::uint64_t>(unzigzag(r.get_varint()));
  const auto number = static_cast<std::int64_t>(sum);
  if (number < std::numeric_limits<Number>::min() || number > std::numeric_limits<Number>::max())
    return false;
  value = static_cast<Number>(number);
  return true;
}

}  // namespace

Result<ChangeHead> SessionMesh::apply(std::span<const std::byte> message) {
  const auto decoded = decode_change_head(message);
  if (!decoded) return decoded;
  const ChangeHead& head = *decoded;
  if (head.sequence != sequence_ + 1) return corrupt("a change was left out");
  const auto packed = message.subspan(change_head_bytes);
  if (head.raw_bytes > largest_change_bytes ||
      ZSTD_getFrameContentSize(packed.data(), packed.size()) != head.raw_bytes)
    return corrupt("the size of a change is not what it says");
  std::vector<std::byte> body(head.raw_bytes);
  if (ZSTD_decompress(body.data(), body.size(), packed.data(), packed.size()) != body.size())
    return corrupt("a change cannot be unpacked");
  if (auto applied = apply_body(body); !applied) return fail(applied.error());
  if (used_ != head.triangles) return corrupt("a change does not leave as many triangles as it says");
  sequence_ = head.sequence;
  return head;
}

Result<void> SessionMesh::apply_body(std::span<const std::byte> body) {
  ByteReader r(body);
  std::vector<std::uint32_t> slots;
  if (!read_slots(r, triangles_.size(), false, slots)) return corrupt("removed triangles");
  for (const std::uint32_t s : slots) {
    used_ -= triangles_[s] != nothing;
    triangles_[s] = nothing;
  }
  if (!read_slots(r, vertices_.size(), true, slots)) return corrupt("slots of vertices");
  if (!slots.empty() && slots.back() >= vertices_.size()) vertices_.resize(std::size_t{slots.back()} + 1);
  DrawVertex v{0, 0, 0, 0, 0, {255, 255, 255, 255}};
  for (const std::uint32_t s : slots) {
    bool good = read_difference(r, v.x) && read_difference(r, v.y) && read_difference(r, v.z);
    if (has_normals_) good = good && read_difference(r, v.normal_u) && read_difference(r, v.normal_v);
    if (has_colours_) v.colour = r.get<Rgba8>();
    if (!good || !r.ok()) return corrupt("vertices");
    vertices_[s] = v;
    if (!has_normals_) vertices_[s].normal_u = vertices_[s].normal_v = -32768;
  }
  if (!read_slots(r, triangles_.size(), true, slots)) return corrupt("slots of triangles");
  if (!slots.empty() && slots.back() >= triangles_.size())
    triangles_.resize(std::size_t{slots.back()} + 1, nothing);
  std::uint32_t before = 0;
  for (const std::uint32_t s : slots) {
    std::array<std::uint32_t, 3> t{};
    for (std::uint32_t& corner : t) {
      corner = before;
      if (!read_difference(r, corner) || !r.ok() || corner >= vertices_.size())
        return corrupt("corners of triangles");
      before = corner;
    }
    before = t[0];
    used_ += triangles_[s] == nothing;
    triangles_[s] = t;
  }
  return r.at_end() ? Result<void>{} : corrupt("bytes behind a change");
}

}  // namespace cuesta::serve
