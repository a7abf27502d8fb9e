#include "hierarchy/triangle_codec.h"

#include <optional>

#include "ooc/triangle_order.h"

namespace cuesta {
namespace {

using Corners = std::array<std::uint32_t, 3>;

constexpr std::uint32_t none = ~std::uint32_t{0}, unseen = none - 1;

// A step is gate · 4 + tip.
// Gate: the how-manieth most recent of the open edges; or one told by its first vertex; or none.
constexpr std::uint32_t gate_by_vertex = 62, no_gate = 63;
constexpr std::uint32_t recent_edges = 64;  // a power of two
// Tip: the vertex after the last new one; the end of the open edge after the gate; the start of the one
// before it; or a number.
enum Tip : std::uint32_t { next_new, after_gate, before_gate, by_number };

/// Directed edge of a triangle whose neighbour has not come yet.
struct OpenEdge {
  std::uint32_t from = none, to = none;
};

/// What writer and reader know after the same triangles. A vertex remembers one open edge that leaves it and
/// one that arrives: where several do, the older ones are forgotten, and what hangs on them costs more bits.
class Walk {
 public:
  Walk(std::uint32_t vertex_count, std::vector<Hint>& hints) : vertices_(vertex_count), hints_(hints) {
    hints_.assign(vertex_count, {});
  }

  bool is_open(std::uint32_t from, std::uint32_t to) const { return vertices_[from].leaving_to == to; }
  std::uint32_t leaving(std::uint32_t v) const { return vertices_[v].leaving_to; }
  std::uint32_t arriving(std::uint32_t v) const { return vertices_[v].arriving_from; }
  std::uint32_t next() const { return next_; }

  /// Visits open edges, the most recent first, until `visit(edge, position)` is true or none is remembered.
  template <class Visit>
  bool find_recent(Visit visit) const {
    std::uint32_t position = 0;
    for (std::uint32_t i = 1; i <= recent_edges && position < gate_by_vertex; ++i) {
      const OpenEdge& e = recent_[(head_ - i) % recent_edges];
      if (e.from == none || !is_open(e.from, e.to)) continue;
      if (visit(e, position++)) return true;
    }
    return false;
  }

  /// The open edge at a position; from `none` when fewer are remembered.
  OpenEdge recent(std::uint32_t position) const {
    OpenEdge found;
    if (const OpenEdge& last = recent_[(head_ - 1) % recent_edges];
        position == 0 && last.from != none && is_open(last.from, last.to))
      return last;
    find_recent([&](const OpenEdge& e, std::uint32_t at) {
      if (at == position) found = e;
      return at == position;
    });
    return found;
  }

  /// New vertices are expected to follow each other. @param hint  what a new one can be guessed from
  void see(std::uint32_t v, Hint hint) {
    if (vertices_[v].arriving_from != unseen) return;
    vertices_[v].arriving_from = none;
    hints_[v] = hint;
    next_ = v + 1;
  }
  /// The tip of a triangle on the gate t[1] → t[0], or on none.
  void see_tip(const Corners& t, bool on_gate) {
    see(t[2], {t[0], t[1], on_gate ? vertices_[t[1]].opposite : Hint::nobody});
  }

  void add(const Corners& t) {
    bool closed[3];
    for (unsigned k = 0; k < 3; ++k) {
      closed[k] = is_open(t[(k + 1) % 3], t[k]);
      if (closed[k]) close(t[(k + 1) % 3], t[k]);
    }
    for (unsigned k = 0; k < 3; ++k)
      if (!closed[k]) open(t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
  }

 private:
  struct Vertex {
    std::uint32_t leaving_to = none;       ///< end of the open edge that leaves
    std::uint32_t opposite = none;         ///< tip of that edge's triangle
    std::uint32_t arriving_from = unseen;  ///< start of the open edge that arrives
  };

  void close(std::uint32_t from, std::uint32_t to) {
    vertices_[from].leaving_to = none;
    if (vertices_[to].arriving_from == from) vertices_[to].arriving_from = none;
  }
  void open(std::uint32_t from, std::uint32_t to, std::uint32_t opposite) {
    vertices_[from].leaving_to = to;
    vertices_[from].opposite = opposite;
    vertices_[to].arriving_from = from;
    recent_[head_++ % recent_edges] = {from, to};
  }

  std::vector<Vertex> vertices_;
  std::vector<Hint>& hints_;
  std::array<OpenEdge, recent_edges> recent_{};
  std::uint32_t head_ = recent_edges;
  std::uint32_t next_ = 0;
};

/// The triangle turned so that its first edge is the neighbour of `gate`, if one is.
std::optional<Corners> turned_to(const Corners& t, OpenEdge gate) {
  for (unsigned k = 0; k < 3; ++k)
    if (t[k] == gate.to && t[(k + 1) % 3] == gate.from) return Corners{t[k], t[(k + 1) % 3], t[(k + 2) % 3]};
  return std::nullopt;
}

class Packer {
 public:
  Packer(std::size_t triangles, std::uint32_t vertex_count, std::vector<Hint>& hints)
      : walk_(vertex_count, hints) {
    steps_.reserve(triangles);
  }

  void add(const Corners& triangle) {
    Corners t = triangle;
    std::uint32_t gate = no_gate;
    const bool recent = walk_.find_recent([&](OpenEdge e, std::uint32_t position) {
      const auto turned = turned_to(triangle, e);
      if (!turned) return false;
      t = *turned;
      gate = position;
      return true;
    });
    if (!recent) gate = old_gate(t);
    if (gate == no_gate) {
      put_step(gate, by_number);
      put_number(t[0]);
      walk_.see(t[0], {});
      put_number(t[1]);
      walk_.see(t[1], {t[0], t[0]});
    } else if (gate == gate_by_vertex) {
      put_step(gate, tip_of(t));
      put_number(t[1]);
    } else {
      put_step(gate, tip_of(t));
    }
    if (gate == no_gate || tip_of(t) == by_number) put_number(t[2]);
    walk_.see_tip(t, gate != no_gate);
    walk_.add(t);
  }

  std::vector<Plane> take() {
    auto numbers = numbers_.take();
    numbers.insert(numbers.begin(), std::move(steps_));
    return numbers;
  }

 private:
  std::uint32_t old_gate(Corners& t) const {
    for (unsigned k = 0; k < 3; ++k)
      if (walk_.is_open(t[(k + 1) % 3], t[k])) {
        t = {t[k], t[(k + 1) % 3], t[(k + 2) % 3]};
        return gate_by_vertex;
      }
    return no_gate;
  }
  /// @pre t hangs on an open edge t[1] → t[0]
  Tip tip_of(const Corners& t) const {
    if (t[2] == walk_.next()) return next_new;
    if (t[2] == walk_.leaving(t[0])) return after_gate;
    return t[2] == walk_.arriving(t[1]) ? before_gate : by_number;
  }
  void put_step(std::uint32_t gate, Tip tip) { steps_.push_back(static_cast<std::byte>(gate * 4 + tip)); }
  void put_number(std::uint32_t v) { numbers_.put_signed(0, static_cast<std::int64_t>(v) - walk_.next()); }

  Walk walk_;
  Plane steps_;
  NumberWriter numbers_{1};
};

/// smallest_first without a branch: which corner is the lowest cannot be predicted.
Corners turned_to_smallest(const Corners& t) {
  const unsigned k = (t[1] < t[0] || t[2] < t[0]) ? (t[2] < t[1] ? 2u : 1u) : 0u;
  constexpr std::uint8_t after[] = {1, 2, 0, 1};
  return {t[k], t[after[k]], t[after[k + 1]]};
}

class Unpacker {
 public:
  Unpacker(std::span<const Plane> planes, std::uint32_t vertex_count, std::vector<Hint>& hints)
      : steps_(planes[0]),
        numbers_(planes.subspan(1)),
        walk_(vertex_count, hints),
        vertex_count_(vertex_count) {}

  /// The next triangle. @return false when it is none.
  bool get(std::size_t index, Corners& t) {
    const auto step = static_cast<std::uint32_t>(steps_[index]);
    if (!get_gate(step / 4, t)) return false;
    t[2] = tip(step % 4, t);
    if (t[2] >= vertex_count_ || t[2] == t[0] || t[2] == t[1]) return false;
    walk_.see_tip(t, step / 4 != no_gate);
    walk_.add(t);
    t = turned_to_smallest(t);
    return true;
  }
  bool at_end() const { return numbers_.at_end(); }

 private:
  /// t[0] and t[1]: different vertices.
  bool get_gate(std::uint32_t gate, Corners& t) {
    if (gate < gate_by_vertex) {
      const auto edge = walk_.recent(gate);
      t[0] = edge.to;
      t[1] = edge.from;
      return edge.from != none;
    }
    if (gate == gate_by_vertex) {
      t[1] = get_number();
      if (t[1] == none) return false;
      t[0] = walk_.leaving(t[1]);
      return t[0] != none;
    }
    t[0] = get_number();
    if (t[0] == none) return false;
    walk_.see(t[0], {});
    t[1] = get_number();
    if (t[1] == none || t[1] == t[0]) return false;
    walk_.see(t[1], {t[0], t[0]});
    return true;
  }
  std::uint32_t tip(std::uint32_t how, const Corners& t) {
    switch (how) {
      case next_new:
        return walk_.next();
      case after_gate:
        return walk_.leaving(t[0]);
      case before_gate:
        return walk_.arriving(t[1]);
      default:
        return get_number();
    }
  }
  /// A vertex, or `none`.
  std::uint32_t get_number() {
    const std::int64_t v = numbers_.get_signed(0) + walk_.next();
    return v < 0 || v >= vertex_count_ || !numbers_.ok() ? none : static_cast<std::uint32_t>(v);
  }

  std::span<const std::byte> steps_;
  NumberReader numbers_;
  Walk walk_;
  std::uint32_t vertex_count_;
};

}  // namespace

std::vector<Plane> pack_triangles(std::span<const Corners> triangles, std::uint32_t vertex_count,
                                  std::vector<Hint>& hints) {
  Packer packer(triangles.size(), vertex_count, hints);
  for (const Corners& t : triangles) packer.add(t);
  return packer.take();
}

bool unpack_triangles(std::span<const Plane> planes, std::uint32_t vertex_count, std::span<Corners> triangles,
                      std::vector<Hint>& hints) {
  if (planes[0].size() != triangles.size()) return false;
  Unpacker unpacker(planes, vertex_count, hints);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (!unpacker.get(i, triangles[i])) return false;
  return unpacker.at_end();
}

}  // namespace cuesta
