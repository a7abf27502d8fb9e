#include "terrain/mosaic_cover.h"

#include <tuple>

namespace cuesta {
namespace {

/// Where an edge crosses a row: going east, into the surface (+1) or out of it (-1).
struct Crossing {
  std::int64_t row = 0;
  double column = 0;
  int step = 0;
};

struct Edge {
  PlanePoint from, to;
};

double squared_distance(const Edge& e, double x, double y) {
  const double dx = e.to.x - e.from.x, dy = e.to.y - e.from.y;
  const double length = dx * dx + dy * dy;
  const double t =
      length > 0 ? std::clamp(((x - e.from.x) * dx + (y - e.from.y) * dy) / length, 0.0, 1.0) : 0.0;
  return std::pow(e.from.x + t * dx - x, 2) + std::pow(e.from.y + t * dy - y, 2);
}

class Cover {
 public:
  Cover(const LayerPart& part, const MosaicLayer& layer)
      : part_(part), around_(layer.columns_around), runs_(part.height) {
    if (layer.north_pole && part.row == 0) poles_.push_back(0);
    if (layer.south_pole && part.row + part.height == layer.height) poles_.push_back(part.height - 1);
  }

  void add(const Edge& e) {
    add_crossings(e);
    add_near(e);
  }

  PostingRuns finish() {
    std::ranges::sort(crossings_, [](const Crossing& a, const Crossing& b) {
      return std::tuple(a.row, a.column, -a.step) < std::tuple(b.row, b.column, -b.step);
    });
    std::ranges::sort(meridian_, {}, [](const Crossing& c) { return std::pair(c.column, -c.step); });
    auto next = crossings_.begin();
    for (std::uint64_t r = 0; r < part_.height; ++r) {
      const auto begin = next;
      while (next != crossings_.end() && next->row == static_cast<std::int64_t>(r)) ++next;
      add_inside(r, {begin, next});
    }
    for (const std::uint64_t row : poles_) {  // one place
      if (!runs_[row].empty()) runs_[row] = {{0, part_.width}};
    }
    PostingRuns out(part_.row);
    for (auto& runs : runs_) out.add_row(joined(std::move(runs)));
    return out;
  }

 private:
  // Rows and columns here are counted from the part's own.
  double row_of(PlanePoint p) const { return p.y - double(part_.row); }

  void add_crossings(const Edge& e) {
    const double from = row_of(e.from), to = row_of(e.to), top = std::min(from, to),
                 bottom = std::max(from, to);
    const double last = double(part_.height) - 1;
    // A row r is crossed if top ≤ r < bottom, so that of two edges that meet on it one counts.
    for (double r = std::max(0.0, std::ceil(top)); r < bottom && r <= last; ++r) {
      double column = e.from.x + (e.to.x - e.from.x) * (r - from) / (to - from);
      if (part_.is_closed) column -= double(around_) * std::floor(column / double(around_));
      crossings_.push_back({static_cast<std::int64_t>(r), column, to > from ? 1 : -1});
    }
    if (!part_.is_closed) return;
    // The meridian of column ½, for rows that nothing crosses.
    const auto around = double(around_);
    const double meridian = around * std::ceil((std::min(e.from.x, e.to.x) - 0.5) / around) + 0.5;
    if ((e.from.x < meridian) == (e.to.x < meridian)) return;
    const double row = from + (to - from) * (meridian - e.from.x) / (e.to.x - e.from.x);
    meridian_.push_back({0, row, e.to.x < e.from.x ? 1 : -1});
  }

  void add_near(const Edge& e) {
    const double top = std::min(row_of(e.from), row_of(e.to)),
                 bottom = std::max(row_of(e.from), row_of(e.to));
    const double west = std::min(e.from.x, e.to.x), east = std::max(e.from.x, e.to.x);
    const double last = double(part_.height) - 1;
    for (double r = std::max(0.0, std::ceil(top - cover_reach)); r <= std::min(last, bottom + cover_reach);
         ++r) {
      for (double c = std::ceil(west - cover_reach); c <= east + cover_reach; ++c) {
        if (squared_distance(e, c, r + double(part_.row)) > cover_reach * cover_reach) continue;
        const double column = part_.is_closed ? c - double(around_) * std::floor(c / double(around_)) : c;
        if (column < 0 || column >= double(part_.width)) continue;
        const auto first = static_cast<std::uint64_t>(column);
        runs_[static_cast<std::uint64_t>(r)].push_back({first, first + 1});
      }
    }
  }

  /// How often the surface lies at the beginning of a line, 0 or 1: it is nowhere less than not at all.
  static int at_beginning(std::span<const Crossing> line) {
    int sum = 0, least = 0;
    for (const Crossing& crossing : line) least = std::min(least, sum += crossing.step);
    return -least;
  }

  void add_inside(std::uint64_t row, std::span<const Crossing> line) {
    int depth = at_beginning(line);
    if (line.empty() && part_.is_closed) {
      depth = at_beginning(meridian_);
      for (const Crossing& crossing : meridian_) depth += crossing.column <= double(row) ? crossing.step : 0;
    }
    double from = 0;
    const auto add = [&](double to) {
      const double begin = std::max(0.0, std::ceil(from)), end = std::min(double(part_.width), std::ceil(to));
      if (depth > 0 && begin < end)
        runs_[row].push_back({static_cast<std::uint64_t>(begin), static_cast<std::uint64_t>(end)});
      from = to;
    };
    for (const Crossing& crossing : line) {
      add(crossing.column);
      depth += crossing.step;
    }
    add(double(part_.width));
  }

  LayerPart part_;
  std::uint64_t around_;
  std::vector<std::vector<PostingRun>> runs_;
  std::vector<std::uint64_t> poles_;            // rows
  std::vector<Crossing> crossings_, meridian_;  // of the meridian: `column` is the row, going south
};

}  // namespace

PostingRuns covered_postings(std::span<const OutlineEdge> outline, const LatticeView& view,
                             const LayerPart& part) {
  Cover cover(part, view.layer());
  for (const OutlineEdge& edge : outline) {
    PlanePoint from = view.at(edge.from);
    from.x -= double(part.column);
    PlanePoint to = view.at(edge.to);
    to.x -= double(part.column);
    to = view.near(to, from);
    if (std::isnan(from.x) || std::isnan(to.x)) continue;  // nowhere near the layer
    cover.add({from, to});
  }
  return cover.finish();
}

}  // namespace cuesta
