#include "hierarchy/tom_codec.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "hierarchy/packed_planes.h"
#include "ooc/check.h"
#include "ooc/oct_normal.h"
#include "ooc/vertex_table.h"

// Layout of a segment (all little-endian; docs/format.md):
//   u8 codec version, u8 flags, u32 vertices before, u32 vertices, u32 triangles, u32 error steps,
//   in the first segment f64 × 3 origin, f64 step, u32 base vertices, f32 snap error, f32 × 6 bounds,
//   f32 error at its resolution, then error steps of u32 below, f32 error, then the planes.

namespace cuesta {
namespace {

constexpr std::uint8_t codec_version = 1;
constexpr std::uint8_t flag_first = 1, flag_normals = 2, flag_colours = 4, flag_texcoords = 8;
constexpr double most_steps = 1 << 23;

/// Planes of a segment, in this order; the last of each group holds the bits.
constexpr std::size_t substitute_planes = 2, position_planes = 4, normal_planes = 3, colour_planes = 4,
                      texcoord_planes = 3, triangle_planes = 5, corner_planes = 2;
// Classes of triangle_planes.
constexpr std::size_t plane_counts = 0, plane_sides = 1, plane_third = 2, plane_base = 3;

struct Head {
  std::uint8_t flags = 0;
  std::uint32_t before = 0, vertices = 0, triangles = 0, errors = 0;

  bool has(std::uint8_t flag) const { return (flags & flag) != 0; }
};

bool in_order(const std::vector<TomErrorStep>& steps) {
  for (std::size_t i = 1; i < steps.size(); ++i)
    if (steps[i].below > steps[i - 1].below || !(steps[i].error > steps[i - 1].error)) return false;
  return true;
}

/// Steps of the error as seen at resolution n: one stands for all that lie above it.
std::vector<TomErrorStep> errors_up_to(const std::vector<TomErrorStep>& steps, Resolution n, float at_n) {
  std::vector<TomErrorStep> out;
  if (at_n > 0) out.push_back({n + 1, at_n});
  for (const TomErrorStep& s : steps)
    if (s.below <= n) out.push_back(s);
  return out;
}

Vec3i grid_position(const Tom& tom, std::uint32_t v) {
  const Vec3d g = vec_cast<double>(tom.positions[v]) / tom.step;
  return vec_cast<std::int32_t>(Vec3d{std::round(g.x), std::round(g.y), std::round(g.z)});
}

FixedTexCoord fixed(TexCoord t) {
  const auto units = [](float x) {
    const double u =
        std::isfinite(x) ? std::clamp(std::round(double{x} * 65536), -2147483648.0, 2147483647.0) : 0;
    return static_cast<std::int32_t>(u);
  };
  return {units(t[0]), units(t[1])};
}
TexCoord floating(FixedTexCoord t) {
  return {static_cast<float>(t[0] / 65536.0), static_cast<float>(t[1] / 65536.0)};
}

/// What a vertex is told as a difference from: its substitute, or the one before it in the base mesh.
std::uint32_t reference(const Tom& tom, std::uint32_t v) {
  return v >= tom.base_vertices ? tom.substitute[v] : v > 0 ? v - 1 : 0;
}

/// Which vertices from a resolution on have which substitute: the tree that corners step down.
class Children {
 public:
  /// Of the vertices `from` … full() - 1.
  Children(const Tom& tom, Resolution from) : starts_(tom.substitute.size() + 2, 0) {
    const Resolution first = std::max(from, tom.base_vertices);
    for (std::uint32_t v = first; v < tom.substitute.size(); ++v) ++starts_[tom.substitute[v] + 2];
    counts_to_starts(std::span(starts_).subspan(1));
    children_.resize(tom.substitute.size() - std::min<std::size_t>(first, tom.substitute.size()));
    for (std::uint32_t v = first; v < tom.substitute.size(); ++v)
      children_[starts_[tom.substitute[v] + 1]++] = v;
  }
  /// Ascending, those from `r` on.
  std::span<const std::uint32_t> of(std::uint32_t v, Resolution r) const {
    const auto all = std::span(children_).subspan(starts_[v], starts_[v + 1] - starts_[v]);
    return all.subspan(static_cast<std::size_t>(std::lower_bound(all.begin(), all.end(), r) - all.begin()));
  }

 private:
  std::vector<std::uint32_t> starts_, children_;
};

/// The steps from `corner`, at resolution r, down to `goal`: 0 to stay, else 1 + the number of the child.
/// Where there is no child, nothing needs to be said.
void put_steps(NumberWriter& w, const Tom& tom, const Children& children, std::uint32_t corner, Resolution r,
               std::uint32_t goal, std::vector<std::uint32_t>& path) {
  path.clear();
  for (std::uint32_t v = goal; v != corner; v = tom.substitute[v]) path.push_back(v);
  for (; !path.empty(); path.pop_back()) {
    const auto next = children.of(corner, r);
    const auto at = std::lower_bound(next.begin(), next.end(), path.back());
    w.put(0, static_cast<std::uint64_t>(at - next.begin()) + 1);
    corner = path.back();
    r = corner + 1;
  }
  if (!children.of(corner, r).empty()) w.put(0, 0);
}

/// Where the steps lead, or kNone if they are damaged.
std::uint32_t get_steps(NumberReader& r, const Children& children, std::uint32_t corner, Resolution from) {
  for (;;) {
    const auto next = children.of(corner, from);
    if (next.empty()) return corner;
    const std::uint64_t step = r.get(0);
    if (step == 0) return r.ok() ? corner : kNone;
    if (step > next.size()) return kNone;
    corner = next[step - 1];
    from = corner + 1;
  }
}

Triangle rotated(Triangle t, std::size_t first) {
  return {t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
}

std::size_t smallest(const Triangle& t) {
  return static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
}

// ---- encoding

class SegmentEncoder {
 public:
  SegmentEncoder(const Tom& tom, Resolution from, Resolution to)
      : whole_(tom), part_(tom_prefix(tom, to)), from_(from), to_(to), children_(part_, from) {}

  std::vector<std::byte> run() {
    put_head();
    put_planes(substitutes());
    put_planes(positions());
    if (!part_.normals.empty()) put_planes(normals());
    if (!part_.colours.empty()) put_planes(colours());
    if (!part_.texcoords.empty()) put_planes(texcoords());
    NumberWriter triangles(triangle_planes - 1), corners(corner_planes - 1);
    put_triangles(triangles, corners);
    put_planes(triangles.take());
    put_planes(corners.take());
    return out_.take();
  }

 private:
  void put_planes(const std::vector<Plane>& planes) {
    for (const Plane& p : planes) compressor_.write(out_, p);
  }

  void put_head() {
    const std::uint32_t before = from_ == 0 ? 0 : triangle_count(whole_, from_);
    std::vector<TomErrorStep> steps;
    for (const TomErrorStep& s : part_.errors)
      if (s.below > from_ && s.below <= to_) steps.push_back(s);
    out_.put_varint(codec_version);  // one byte each
    out_.put_varint(static_cast<std::uint8_t>(
        (from_ == 0 ? flag_first : 0) | (part_.normals.empty() ? 0 : flag_normals) |
        (part_.colours.empty() ? 0 : flag_colours) | (part_.texcoords.empty() ? 0 : flag_texcoords)));
    out_.put(from_);
    out_.put(to_ - from_);
    out_.put(static_cast<std::uint32_t>(part_.triangles.size()) - before);
    out_.put(static_cast<std::uint32_t>(steps.size()));
    if (from_ == 0) {
      out_.put(part_.origin);
      out_.put(part_.step);
      out_.put(part_.base_vertices);
      out_.put(part_.snap_error);
      out_.put(part_.bounds.lo);
      out_.put(part_.bounds.hi);
    }
    out_.put(error_at(part_, to_));
    for (const TomErrorStep& s : steps) {
      out_.put(s.below);
      out_.put(s.error);
    }
  }

  std::vector<Plane> substitutes() const {
    NumberWriter w(substitute_planes - 1);
    for (std::uint32_t v = std::max(from_, part_.base_vertices); v < to_; ++v)
      w.put(0, v - 1 - part_.substitute[v]);
    return w.take();
  }
  std::vector<Plane> positions() const {
    NumberWriter w(position_planes - 1);
    for (std::uint32_t v = from_; v < to_; ++v) {
      const Vec3i d = grid_position(part_, v) - (v > 0 ? grid_position(part_, reference(part_, v)) : Vec3i{});
      for (int i = 0; i < 3; ++i) w.put_signed(static_cast<std::size_t>(i), d[i]);
    }
    return w.take();
  }
  std::vector<Plane> normals() const {
    NumberWriter w(normal_planes - 1);
    for (std::uint32_t v = from_; v < to_; ++v) {
      const OctNormal n = encode_oct(part_.normals[v], normal_bits);
      const OctNormal guess =
          v > 0 ? encode_oct(part_.normals[reference(part_, v)], normal_bits) : OctNormal{};
      for (std::size_t i = 0; i < 2; ++i) w.put_signed(i, n[i] - guess[i]);
    }
    return w.take();
  }
  std::vector<Plane> colours() const {
    std::vector<Plane> planes(colour_planes);
    for (std::uint32_t v = from_; v < to_; ++v) {
      const Rgba8 guess = v > 0 ? part_.colours[reference(part_, v)] : Rgba8{};
      for (std::size_t i = 0; i < 4; ++i)
        planes[i].push_back(static_cast<std::byte>(part_.colours[v][i] - guess[i]));
    }
    return planes;
  }
  std::vector<Plane> texcoords() const {
    NumberWriter w(texcoord_planes - 1);
    for (std::uint32_t v = from_; v < to_; ++v) {
      const FixedTexCoord t = fixed(part_.texcoords[v]);
      const FixedTexCoord guess = v > 0 ? fixed(part_.texcoords[reference(part_, v)]) : FixedTexCoord{};
      for (std::size_t i = 0; i < 2; ++i) w.put_signed(i, std::int64_t{t[i]} - guess[i]);
    }
    return w.take();
  }

  void put_triangles(NumberWriter& triangles, NumberWriter& corners) {
    std::vector<std::uint32_t> counts(to_ + 1, 0);
    for (std::size_t t = 0; t < part_.triangles.size(); ++t) {
      const Triangle goal = part_.triangles[t];
      const Resolution r = triangle_resolution(part_.substitute, part_.base_vertices, goal);
      const bool is_known = from_ > 0 && r <= from_;
      const Resolution at = is_known ? from_ : r;
      const Triangle now = active_corners(part_, goal, at);
      std::size_t first = smallest(now);
      if (!is_known && r > part_.base_vertices) {
        ++counts[r - 1];
        first = static_cast<std::size_t>(std::max_element(now.begin(), now.end()) - now.begin());
        put_new(triangles, rotated(now, first));
      } else if (!is_known) {
        for (const std::uint32_t c : rotated(now, first)) triangles.put(plane_base, c);
      }
      const Triangle start = rotated(now, first), end = rotated(goal, first);
      for (std::size_t i = 0; i < 3; ++i) put_steps(corners, part_, children_, start[i], at, end[i], path_);
    }
    for (std::uint32_t v = std::max(from_, part_.base_vertices); v < to_; ++v)
      triangles.put(plane_counts, counts[v]);
  }

  /// t[0] is the vertex that comes with the triangle; its substitute is another corner.
  void put_new(NumberWriter& triangles, const Triangle& t) const {
    const bool second = t[2] == part_.substitute[t[0]];
    triangles.put(plane_sides, second ? 1 : 0);
    triangles.put(plane_third, t[0] - 1 - (second ? t[1] : t[2]));
  }

  const Tom& whole_;
  Tom part_;
  Resolution from_, to_;
  Children children_;
  ByteWriter out_;
  PlaneCompressor compressor_;
  std::vector<std::uint32_t> path_;
};

// ---- decoding

tl::unexpected<Error> corrupt(std::string what) {
  return fail(ErrorCode::corrupt, "", "", std::move(what));
}

class SegmentDecoder {
 public:
  SegmentDecoder(std::span<const std::byte> bytes, Tom& tom) : in_(bytes), tom_(tom) {}

  /// Changes the TOM; it is of no use after an error.
  Result<void> run() {
    if (auto head = get_head(); !head) return head;
    if (!get_substitutes()) return damaged("substitutes");
    if (!get_positions()) return damaged("positions");
    if (head_.has(flag_normals) && !get_normals()) return damaged("normals");
    if (head_.has(flag_colours) && !get_colours()) return damaged("colours");
    if (head_.has(flag_texcoords) && !get_texcoords()) return damaged("texture coordinates");
    if (!get_triangles()) return damaged("triangles");
    if (!in_.at_end()) return corrupt("bytes after the last plane");
    return {};
  }

 private:
  static tl::unexpected<Error> damaged(const std::string& what) { return corrupt("damaged " + what); }

  Result<void> get_head() {
    const auto version = in_.get<std::uint8_t>();
    if (in_.ok() && version != codec_version)
      return fail(
          ErrorCode::unsupported_version, "", "",
          "TOM codec " + std::to_string(version) + ", this program reads " + std::to_string(codec_version));
    head_.flags = in_.get<std::uint8_t>();
    for (auto* field : {&head_.before, &head_.vertices, &head_.triangles, &head_.errors})
      *field = in_.get<std::uint32_t>();
    if (!in_.ok()) return corrupt("the segment ends within its header");
    if (head_.before != tom_.full())
      return fail(ErrorCode::invalid_input, "", "",
                  "a segment from vertex " + std::to_string(head_.before) + " on, expected " +
                      std::to_string(tom_.full()));
    if (head_.has(flag_first) != (head_.before == 0) || head_.flags >= 16 || head_.vertices == 0 ||
        head_.vertices >= kNone - head_.before || head_.triangles > kMaxTriangles - tom_.triangles.size())
      return corrupt("its counts cannot be");
    if (head_.before == 0 ? !get_frame() : !same_attributes())
      return corrupt("its frame or attributes cannot be");
    if (!get_errors()) return damaged("errors");
    return {};
  }

  bool same_attributes() const {
    return head_.has(flag_normals) != tom_.normals.empty() &&
           head_.has(flag_colours) != tom_.colours.empty() &&
           head_.has(flag_texcoords) != tom_.texcoords.empty();
  }

  bool get_frame() {
    tom_.origin = in_.get<Vec3d>();
    tom_.step = in_.get<double>();
    tom_.base_vertices = in_.get<std::uint32_t>();
    tom_.snap_error = in_.get<float>();
    tom_.bounds.lo = in_.get<Vec3f>();
    tom_.bounds.hi = in_.get<Vec3f>();
    double sum = tom_.origin.x + tom_.origin.y + tom_.origin.z + tom_.snap_error;
    for (const Vec3f& p : {tom_.bounds.lo, tom_.bounds.hi}) sum += double{p.x} + p.y + p.z;
    return in_.ok() && std::isfinite(sum) && tom_.step > 0 &&
           tom_.step * most_steps < std::numeric_limits<float>::max() && tom_.snap_error >= 0 &&
           tom_.base_vertices > 0 && tom_.base_vertices <= head_.vertices;
  }

  bool get_errors() {
    const Resolution from = head_.before, to = from + head_.vertices;
    const auto at_to = in_.get<float>();
    if (head_.errors > in_.remaining() / 8 || !(at_to >= 0) || !std::isfinite(at_to)) return false;
    std::vector<TomErrorStep> steps;
    if (at_to > 0) steps.push_back({to + 1, at_to});
    for (std::uint32_t i = 0; i < head_.errors; ++i) {
      const auto below = in_.get<std::uint32_t>();
      const auto error = in_.get<float>();
      if (below <= std::max(from, tom_.base_vertices) || below > to || !std::isfinite(error)) return false;
      steps.push_back({below, error});
    }
    for (const TomErrorStep& s : tom_.errors)
      if (s.below <= from) steps.push_back(s);
    tom_.errors = std::move(steps);
    return in_.ok() && in_order(tom_.errors);
  }

  /// The planes of one group: classes have at most `most` numbers.
  bool get_planes(std::size_t count, std::uint64_t most) {
    planes_.clear();
    for (std::size_t i = 0; i < count; ++i) {
      auto plane = decompressor_.read(in_, most * (number_bits / 8));
      if (!plane) return false;
      planes_.push_back(std::move(*plane));
    }
    return true;
  }

  bool get_substitutes() {
    const std::uint32_t to = head_.before + head_.vertices,
                        first = std::max(head_.before, tom_.base_vertices);
    if (!get_planes(substitute_planes, head_.vertices) || planes_[0].size() != to - first) return false;
    // The base mesh alone could be large without bytes of its own here.
    if (head_.vertices / 65536 > in_.remaining()) return false;
    NumberReader r(planes_);
    tom_.substitute.reserve(to);
    for (std::uint32_t v = head_.before; v < first; ++v) tom_.substitute.push_back(v);
    for (std::uint32_t v = first; v < to; ++v) {
      const std::uint64_t back = r.get(0);
      if (back >= v) return false;
      tom_.substitute.push_back(static_cast<std::uint32_t>(v - 1 - back));
    }
    return r.at_end();
  }

  bool get_positions() {
    if (!get_planes(position_planes, head_.vertices) || planes_[0].size() != head_.vertices) return false;
    NumberReader r(planes_);
    for (std::uint32_t i = 0; i < head_.vertices; ++i) {
      const std::uint32_t v = head_.before + i;
      Vec3i g = v > 0 ? grid_position(tom_, reference(tom_, v)) : Vec3i{};
      for (int k = 0; k < 3; ++k) {
        const std::int64_t at = g[k] + r.get_signed(static_cast<std::size_t>(k));
        if (at < 0 || at >= static_cast<std::int64_t>(most_steps)) return false;
        g[k] = static_cast<std::int32_t>(at);
      }
      tom_.positions.push_back(vec_cast<float>(vec_cast<double>(g) * tom_.step));
    }
    return r.at_end();
  }

  bool get_normals() {
    if (!get_planes(normal_planes, head_.vertices) || planes_[0].size() != head_.vertices) return false;
    NumberReader r(planes_);
    constexpr std::int64_t most = (1 << (normal_bits - 1)) - 1;
    for (std::uint32_t i = 0; i < head_.vertices; ++i) {
      const std::uint32_t v = head_.before + i;
      OctNormal n = v > 0 ? encode_oct(tom_.normals[reference(tom_, v)], normal_bits) : OctNormal{};
      for (std::size_t k = 0; k < 2; ++k) {
        const std::int64_t at = n[k] + r.get_signed(k);
        if (at < -most - 1 || at > most) return false;
        n[k] = static_cast<std::int16_t>(at);
      }
      if ((n[0] < -most) != (n[1] < -most)) return false;
      tom_.normals.push_back(decode_oct(n, normal_bits));
    }
    return r.at_end();
  }

  bool get_colours() {
    if (!get_planes(colour_planes, head_.vertices)) return false;
    for (const Plane& p : planes_)
      if (p.size() != head_.vertices) return false;
    for (std::uint32_t i = 0; i < head_.vertices; ++i) {
      const std::uint32_t v = head_.before + i;
      Rgba8 c = v > 0 ? tom_.colours[reference(tom_, v)] : Rgba8{};
      for (std::size_t k = 0; k < 4; ++k)
        c[k] = static_cast<std::uint8_t>(c[k] + static_cast<std::uint8_t>(planes_[k][i]));
      tom_.colours.push_back(c);
    }
    return true;
  }

  bool get_texcoords() {
    if (!get_planes(texcoord_planes, head_.vertices) || planes_[0].size() != head_.vertices) return false;
    NumberReader r(planes_);
    for (std::uint32_t i = 0; i < head_.vertices; ++i) {
      const std::uint32_t v = head_.before + i;
      FixedTexCoord t = v > 0 ? fixed(tom_.texcoords[reference(tom_, v)]) : FixedTexCoord{};
      for (std::size_t k = 0; k < 2; ++k) {
        const std::int64_t at = t[k] + r.get_signed(k);
        if (at != static_cast<std::int32_t>(at)) return false;
        t[k] = static_cast<std::int32_t>(at);
      }
      tom_.texcoords.push_back(floating(t));
    }
    return r.at_end();
  }

  bool get_triangles() {
    if (!get_planes(triangle_planes, std::uint64_t{head_.vertices} + 3ull * head_.triangles)) return false;
    const std::vector<Plane> triangles = std::move(planes_);
    planes_ = {};
    for (std::size_t i = 0; i < corner_planes; ++i) {
      auto plane = decompressor_.read(in_, std::numeric_limits<std::uint64_t>::max());
      if (!plane) return false;
      planes_.push_back(std::move(*plane));
    }
    NumberReader r(triangles), corners(planes_);
    const Children children(tom_, head_.before);
    for (Triangle& t : tom_.triangles)
      if (!refine(corners, children, t, head_.before)) return false;
    return get_new_triangles(r, corners, children, triangles[plane_base].size()) && r.at_end() &&
           corners.at_end();
  }

  bool refine(NumberReader& r, const Children& children, Triangle& t, Resolution from) const {
    for (std::uint32_t& c : t) {
      c = get_steps(r, children, c, from);
      if (c == kNone) return false;
    }
    t = smallest_first(t);
    return true;
  }

  bool get_new_triangles(NumberReader& r, NumberReader& corners, const Children& children,
                         std::size_t base_corners) {
    const std::size_t end = tom_.triangles.size() + head_.triangles;
    if (base_corners > 0 && head_.before > 0) return false;
    for (std::size_t i = 0; i < base_corners; i += 3) {
      Triangle t;
      for (std::uint32_t& c : t) {
        const std::uint64_t corner = r.get(plane_base);
        if (corner >= tom_.base_vertices) return false;
        c = static_cast<std::uint32_t>(corner);
      }
      if (!r.ok() || !add(corners, children, t, tom_.base_vertices)) return false;
    }
    for (std::uint32_t v = std::max(head_.before, tom_.base_vertices); v < tom_.full(); ++v)
      for (std::uint64_t count = r.get(plane_counts); count > 0; --count) {
        const bool second = r.get(plane_sides) == 1;
        const std::uint64_t back = r.get(plane_third);
        if (!r.ok() || back >= v) return false;
        const auto third = static_cast<std::uint32_t>(v - 1 - back);
        if (!add(corners, children,
                 {v, second ? third : tom_.substitute[v], second ? tom_.substitute[v] : third}, v + 1))
          return false;
      }
    return tom_.triangles.size() == end;
  }

  bool add(NumberReader& corners, const Children& children, Triangle t, Resolution at) {
    if (is_degenerate(t)) return false;
    if (!refine(corners, children, t, at)) return false;
    tom_.triangles.push_back(t);
    return true;
  }

  ByteReader in_;
  Tom& tom_;
  Head head_;
  PlaneDecompressor decompressor_;
  std::vector<Plane> planes_;
};

}  // namespace

Tom tom_prefix(const Tom& tom, Resolution n) {
  CUESTA_CHECK(n >= tom.base_vertices && n <= tom.full(), n);
  Tom out;
  out.origin = tom.origin;
  out.step = tom.step;
  out.snap_error = tom.snap_error;
  out.base_vertices = tom.base_vertices;
  out.bounds = tom.bounds;
  const auto prefix = [n](auto& to, const auto& from) {
    if (!from.empty()) to.assign(from.begin(), from.begin() + n);
  };
  prefix(out.positions, tom.positions);
  prefix(out.normals, tom.normals);
  prefix(out.colours, tom.colours);
  prefix(out.texcoords, tom.texcoords);
  prefix(out.substitute, tom.substitute);
  out.triangles.resize(triangle_count(tom, n));
  extract_triangles(tom, n, out.triangles);
  for (Triangle& t : out.triangles) t = smallest_first(t);
  out.errors = errors_up_to(tom.errors, n, error_at(tom, n));
  return out;
}

std::vector<Resolution> segment_resolutions(const Tom& tom, Resolution first, std::uint32_t ratio) {
  CUESTA_CHECK(first > 0 && ratio > 1, first, ratio);
  std::vector<Resolution> out;
  if (tom.full() == 0) return out;
  for (std::uint64_t n = std::max(first, tom.base_vertices); n < tom.full(); n *= ratio) {
    // The last one is not to be a remnant.
    if (n + n / 2 >= tom.full()) break;
    const Resolution whole = whole_resolution(tom, static_cast<Resolution>(n));
    if (out.empty() || whole > out.back()) out.push_back(whole);
  }
  out.push_back(tom.full());
  return out;
}

std::vector<std::byte> encode_tom_segment(const Tom& tom, Resolution from, Resolution to) {
  CUESTA_CHECK(from < to && to >= tom.base_vertices && to <= tom.full(), from, to);
  CUESTA_CHECK(from == 0 || from >= tom.base_vertices, from);
  return SegmentEncoder(tom, from, to).run();
}

Result<void> decode_tom_segment(std::span<const std::byte> bytes, Tom& tom) {
  Tom more = tom;
  if (auto done = SegmentDecoder(bytes, more).run(); !done) return done;
  tom = std::move(more);
  return {};
}

void snap_attributes(Tom& tom) {
  for (Vec3f& n : tom.normals)
    n = std::isfinite(dot(n, n)) ? decode_oct(encode_oct(n, normal_bits), normal_bits) : Vec3f{};
  for (TexCoord& t : tom.texcoords) t = floating(fixed(t));
}

}  // namespace cuesta
