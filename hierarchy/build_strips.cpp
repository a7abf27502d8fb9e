#include "hierarchy/build_strips.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hierarchy/strip_reduction.h"
#include "ooc/check.h"

namespace cuesta {
namespace {

/// A band that would have fewer vertices is part of the one before it.
constexpr std::uint32_t least_band = 64;

/// How far through a band, as a share of its resolutions, an edge must stay an edge for a strip to cross it.
/// A strip that crosses one that is substituted falls into two parts with vertices between them that draw
/// nothing; but the fewer edges may be crossed, the shorter are the strips. docs/design-notes.md has the
/// numbers.
constexpr double crossed_share = 0.5;

/// The vertex whose substitution makes both one; 0 if that never happens.
std::uint32_t merged_by(std::uint32_t a, std::uint32_t b, std::span<const std::uint32_t> substitute,
                        std::uint32_t base) {
  for (std::uint32_t last = 0;;) {
    if (a == b) return last;
    std::uint32_t& latest = a > b ? a : b;
    if (latest < base) return 0;
    last = latest;
    latest = substitute[latest];
  }
}

/// The vertex whose substitution makes the triangle degenerate; 0 if that never happens.
std::uint32_t ended_by(const std::uint32_t* t, std::span<const std::uint32_t> substitute,
                       std::uint32_t base) {
  return std::max({merged_by(t[0], t[1], substitute, base), merged_by(t[1], t[2], substitute, base),
                   merged_by(t[2], t[0], substitute, base)});
}

}  // namespace

class StripMeshBuilder {
 public:
  StripMeshBuilder(std::span<const Triangle> triangles, std::span<const std::uint32_t> substitute,
                   std::uint32_t base, const StripOptions& options)
      : options_(options), triangles_(triangles.begin(), triangles.end()) {
    mesh_.substitute_.assign(substitute.begin(), substitute.end());
    mesh_.base_resolution_ = base;
    mesh_.skips_when_drawn_ = !options.dynamic_length;
  }

  StripMesh build() {
    std::uint32_t finest = mesh_.vertex_count();
    do {
      const std::uint32_t next = band_after(finest);
      add_band(finest, next);
      finest = next;
    } while (finest >= mesh_.base_resolution_);
    end_step();
    mesh_.entries_.insert(mesh_.entries_.end(), copy_slack, 0);
    mesh_.index_bound_ += copy_slack;
    mesh_.set_resolution(mesh_.vertex_count());
    return std::move(mesh_);
  }

 private:
  using Mesh = StripMesh;

  /// Finest resolution of the next band; one less than the base where there is none.
  std::uint32_t band_after(std::uint32_t finest) const {
    const auto next = static_cast<std::uint32_t>(std::floor(finest / options_.band_ratio));
    const std::uint32_t base = mesh_.base_resolution_;
    return next < base + least_band || next == finest ? base - 1 : next;
  }

  void add_band(std::uint32_t finest, std::uint32_t next) {
    keep_live_triangles(finest);
    const auto middle = static_cast<std::uint32_t>(finest - crossed_share * (finest - next));
    const auto lasts = [&](std::uint32_t a, std::uint32_t b) {
      return merged_by(a, b, mesh_.substitute_, mesh_.base_resolution_) < middle;
    };
    lay_out(stripify(triangles_, finest, options_.dynamic_length ? MayCross(lasts) : MayCross{}), finest);
    note_strips(finest);
    for (std::uint32_t v = finest; v-- > std::max(next + 1, mesh_.base_resolution_);) substitute(v);
    if (next >= mesh_.base_resolution_) end_step();  // from one band to the next
  }

  void keep_live_triangles(std::uint32_t resolution) {
    for (Triangle& t : triangles_)
      for (std::uint32_t& v : t)
        while (v >= resolution) v = mesh_.substitute_[v];
    std::erase_if(triangles_, [](const Triangle& t) { return is_degenerate(t); });
  }

  /// Strips that last longest come first.
  void lay_out(const StripSet& set, std::uint32_t finest) {
    std::vector<std::uint32_t> last(set.strip_count(), finest), order(set.strip_count());
    for (std::uint32_t s = 0; s < set.strip_count(); ++s) {
      const auto strip = set.strip(s);
      for (std::size_t i = 0; i + 2 < strip.size(); ++i)
        if (!is_degenerate(&strip[i]))
          last[s] = std::min(last[s], ended_by(&strip[i], mesh_.substitute_, mesh_.base_resolution_));
    }
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return last[a] < last[b]; });
    mesh_.bands_.push_back(
        {finest, static_cast<std::uint32_t>(mesh_.strips_.size()), set.strip_count(), finest});
    for (const std::uint32_t s : order) {
      const auto begin = static_cast<std::uint32_t>(mesh_.entries_.size());
      const auto strip = set.strip(s);
      mesh_.entries_.insert(mesh_.entries_.end(), strip.begin(), strip.end());
      mesh_.strips_.push_back({begin, static_cast<std::uint32_t>(mesh_.entries_.size())});
    }
    mesh_.index_bound_ = std::max(mesh_.index_bound_, set.entries.size() + set.strip_count());
  }

  void note_strips(std::uint32_t finest) {
    strips_of_.assign(finest, {});
    for (std::uint32_t s = mesh_.bands_.back().first_strip; s < mesh_.strips_.size(); ++s)
      for (const std::uint32_t v : live(s))
        if (strips_of_[v].empty() || strips_of_[v].back() != s) strips_of_[v].push_back(s);
  }

  std::span<const std::uint32_t> live(std::uint32_t s) const {
    const auto [begin, end] = mesh_.strips_[s];
    return std::span(mesh_.entries_).subspan(begin, end - begin);
  }

  void end_step() {
    mesh_.steps_.push_back(
        {static_cast<std::uint32_t>(mesh_.writes_.size()), static_cast<std::uint32_t>(mesh_.cuts_.size())});
  }

  void substitute(std::uint32_t v) {
    end_step();
    const std::uint32_t target = mesh_.substitute_[v];
    mesh_.bands_.back().resolution = v;
    for (const std::uint32_t s : strips_of_[v]) {
      write(s, v, target);
      if (options_.dynamic_length) reduce(s);
      auto& at_target = strips_of_[target];
      if (std::find(at_target.begin(), at_target.end(), s) == at_target.end()) at_target.push_back(s);
    }
    strips_of_[v] = {};
  }

  void write(std::uint32_t s, std::uint32_t v, std::uint32_t target) {
    const auto [begin, end] = mesh_.strips_[s];
    for (std::uint32_t i = begin; i < end; ++i)
      if (mesh_.entries_[i] == v) {
        mesh_.entries_[i] = target;
        mesh_.writes_.push_back(i);
      }
  }

  void take_out(std::uint32_t s, Mesh::CutKind kind, std::uint32_t where) {
    Mesh::Cut cut{.strip = s};
    cut.kind = kind;
    cut.where = where & Mesh::Cut::largest;
    mesh_.cuts_.push_back(cut);
    mesh_.apply(mesh_.bands_.back(), cut);
  }

  void reduce(std::uint32_t s) {
    const Mesh::Live& strip = mesh_.strips_[s];
    if (strip.begin == strip.end) return;
    if (const std::uint32_t spare = spare_head(live(s)); spare > 0)
      take_out(s, Mesh::CutKind::trim_head, spare);
    if (strip.begin == strip.end) return;
    if (const std::uint32_t spare = spare_tail(live(s)); spare > 0)
      take_out(s, Mesh::CutKind::trim_tail, spare);
    for (std::uint32_t i = strip.begin; i + 4 <= strip.end;)
      if (!repeats(&mesh_.entries_[i])) {
        ++i;
      } else {
        const bool near_head = i - strip.begin < strip.end - i - 4;
        take_out(s, near_head ? Mesh::CutKind::move_head : Mesh::CutKind::move_tail, i);
        i = std::max(strip.begin, i - std::min(i, 2u));  // the entries before it may repeat now
      }
  }

  StripOptions options_;
  std::vector<Triangle> triangles_;  // of the band's finest resolution
  StripMesh mesh_;
  std::vector<std::vector<std::uint32_t>> strips_of_;  // of each vertex, the strips of the band that have it
};

StripMesh build_strips(std::span<const Triangle> triangles, std::span<const std::uint32_t> substitute,
                       std::uint32_t base_resolution, const StripOptions& options) {
  CUESTA_CHECK(base_resolution >= 1 && base_resolution <= substitute.size(), base_resolution,
               substitute.size());
  CUESTA_CHECK(options.band_ratio > 1, options.band_ratio);
  for (std::size_t v = base_resolution; v < substitute.size(); ++v)
    CUESTA_CHECK(substitute[v] < v, v, substitute[v]);
  return StripMeshBuilder(triangles, substitute, base_resolution, options).build();
}

}  // namespace cuesta
