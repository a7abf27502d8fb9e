#include "ooc/weld.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "ooc/spatial_order.h"
#include "ooc/triangle_order.h"

namespace cuesta {
namespace {

using Run = std::span<CurveEntry>;

Vec3i shifted(Vec3i g, int bits) {
  return {g.x >> bits, g.y >> bits, g.z >> bits};
}

/// Entries of the used vertices along the curve. Coordinates of more than 21 bits are sorted by their high
/// bits first; afterwards `key` holds the low bits, and a change of the high bits is a change of position as
/// well.
class CurveOrder {
 public:
  explicit CurveOrder(const std::vector<Vec3i>& positions) : positions_(positions) {
    std::int32_t all = 0;
    for (const Vec3i& g : positions) all |= g.x | g.y | g.z;
    low_bits_ = std::max(0, static_cast<int>(std::bit_width(static_cast<std::uint32_t>(all))) - kMortonBits);
    entries_.reserve(positions.size());
    for (std::uint32_t v = 0; v < positions.size(); ++v)
      entries_.push_back({morton_key(shifted(positions[v], low_bits_)), v});
    sort_by_key(entries_);
  }

  /// Calls f(run) for the entries of each grid point, in curve order, each run in ascending order of
  /// vertices.
  template <class F>
  void for_each_point(F f) {
    for_each_run(entries_, [&](Run cell) {
      if (low_bits_ == 0 || cell.size() == 1) return f(cell);
      for (CurveEntry& e : cell) e.key = morton_key(low(positions_[e.index]));
      std::ranges::sort(cell, [](const CurveEntry& a, const CurveEntry& b) {
        return a.key != b.key ? a.key < b.key : a.index < b.index;
      });
      for_each_run(cell, f);
    });
  }

 private:
  Vec3i low(Vec3i g) const {
    const std::int32_t mask = (1 << low_bits_) - 1;
    return {g.x & mask, g.y & mask, g.z & mask};
  }

  template <class F>
  static void for_each_run(Run entries, F f) {
    for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
      for (end = begin + 1; end < entries.size() && entries[end].key == entries[begin].key;) ++end;
      f(entries.subspan(begin, end - begin));
    }
  }

  const std::vector<Vec3i>& positions_;
  int low_bits_ = 0;
  std::vector<CurveEntry> entries_;
};

template <class T>
int compare_bits(const std::vector<T>& values, std::uint32_t a, std::uint32_t b) {
  return values.empty() ? 0 : std::memcmp(&values[a], &values[b], sizeof(T));
}

/// Order of the attributes' bytes: any total order will do, and NaN and -0 are no trouble.
int compare_attributes(const VertexTable& table, std::uint32_t a, std::uint32_t b) {
  if (const int c = compare_bits(table.normals, a, b)) return c;
  if (const int c = compare_bits(table.colours, a, b)) return c;
  return compare_bits(table.texcoords, a, b);
}

/// Sets of[v] = the first vertex with v's attributes, for the vertices of one grid point.
void find_equals(const VertexTable& table, std::vector<std::uint32_t>& run, std::vector<std::uint32_t>& of) {
  std::ranges::sort(run, [&](std::uint32_t a, std::uint32_t b) {
    const int c = compare_attributes(table, a, b);
    return c != 0 ? c < 0 : a < b;
  });
  std::uint32_t first = run[0];
  for (const std::uint32_t v : run) {
    if (compare_attributes(table, first, v) != 0) first = v;
    of[v] = first;
  }
}

class Welder {
 public:
  Welder(const VertexTable& table, Welded& out)
      : table_(table),
        out_(out),
        attributes_(!table.normals.empty() || !table.colours.empty() || !table.texcoords.empty()) {}

  void add_point(Run run) {
    group_ = static_cast<std::uint32_t>(out_.source.size());
    if (run.size() == 1 || !attributes_) {
      const std::uint32_t welded = add(run[0].index);
      for (const CurveEntry& e : run) out_.of[e.index] = welded;
    } else {
      add_wedges(run);
    }
  }

 private:
  std::uint32_t add(std::uint32_t source) {
    out_.source.push_back(source);
    out_.group.push_back(group_);
    return static_cast<std::uint32_t>(out_.source.size() - 1);
  }

  void add_wedges(Run run) {
    vertices_.clear();
    for (const CurveEntry& e : run) vertices_.push_back(e.index);
    find_equals(table_, vertices_, out_.of);
    // In ascending order the first of each kind comes before the others, so its number is known when they ask
    // for it.
    for (const CurveEntry& e : run) {
      std::uint32_t& of = out_.of[e.index];
      of = of == e.index ? add(e.index) : out_.of[of];
    }
  }

  const VertexTable& table_;
  Welded& out_;
  bool attributes_;
  std::uint32_t group_ = 0;
  std::vector<std::uint32_t> vertices_;
};

}  // namespace

Welded weld(const VertexTable& vertices) {
  Welded out;
  out.of.resize(vertices.size());
  CurveOrder order(vertices.positions);
  Welder welder(vertices, out);
  order.for_each_point([&](Run run) { welder.add_point(run); });
  return out;
}

}  // namespace cuesta
