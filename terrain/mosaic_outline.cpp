#include "terrain/mosaic_outline.h"

#include <cmath>
#include <tuple>

#include "ooc/read_job.h"

namespace cuesta {
namespace {

constexpr std::uint64_t postings_at_once = std::uint64_t{1} << 18;

std::uint64_t mixed(std::uint64_t seed, std::uint64_t value) {
  seed = (seed ^ value) * 0x9e3779b97f4a7c15ull;
  return seed ^ (seed >> 29);
}

/// Takes rows of postings from the north, and adds the edges of cells that have a triangle on one side only.
class CellRows {
 public:
  CellRows(const LayerPart& part, std::uint64_t columns_around, const PostingRuns& covered, Outline& outline)
      : part_(part),
        around_(columns_around),
        covered_(covered),
        cells_(part.is_closed ? part.width : part.width - 1),
        outline_(outline),
        north_(part.width, 0),
        cells_north_(part.width, 0) {}

  void add_row(const std::vector<char>& south) {
    std::vector<char> cells(part_.width, 0);  // whether those between the two rows have triangles
    for (std::uint64_t c = 0; c < cells_; ++c) {
      const int corners = north_[c] + north_[east_of(c)] + south[c] + south[east_of(c)];
      cells[c] = corners >= 3;
      if (corners == 3) add_diagonal(c, south);
    }
    for (std::uint64_t c = 0; c < cells_; ++c) {  // along the northern row
      if (!north_[c] || !north_[east_of(c)] || cells_north_[c] == cells[c]) continue;
      const PostingRef west = ref(c, 0), east = ref(east_of(c), 0);
      add(cells[c] ? OutlineEdge{east, west} : OutlineEdge{west, east});
    }
    for (std::uint64_t c = 0; c < part_.width; ++c) {  // between the rows
      if (!north_[c] || !south[c]) continue;
      const char west = cells[west_of(c)];
      if (west == cells[c]) continue;
      add(west ? OutlineEdge{ref(c, 1), ref(c, 0)} : OutlineEdge{ref(c, 0), ref(c, 1)});
    }
    for (std::uint64_t c = 0; c < part_.width; ++c) {
      const bool is_loose =
          north_[c] && !cells_north_[c] && !cells[c] && !cells_north_[west_of(c)] && !cells[west_of(c)];
      if (is_loose && has_covered_neighbour(c)) loose_.push_back(ref(c, 0));
    }
    north_ = south;
    cells_north_ = std::move(cells);
    ++rows_;
  }
  std::vector<PostingRef> finish() {
    add_row(std::vector<char>(part_.width, 0));
    return std::move(loose_);
  }

 private:
  std::uint64_t east_of(std::uint64_t column) const { return column + 1 == part_.width ? 0 : column + 1; }
  /// Of a part that does not close, cells of the last column have no triangles: it may stand for one before
  /// the first.
  std::uint64_t west_of(std::uint64_t column) const { return column == 0 ? part_.width - 1 : column - 1; }
  bool has_covered_neighbour(std::uint64_t column) const {
    const std::uint64_t row = part_.row + rows_ - 1;
    for (const std::uint64_t r : {row - 1, row, row + 1}) {
      for (const std::uint64_t c : {west_of(column), column, east_of(column)}) {
        if (covered_.contains(c, r)) return true;
      }
    }
    return false;
  }
  /// @param south  0: of the row before, 1: of the one that is added.
  PostingRef ref(std::uint64_t column, std::uint64_t south) const {
    const std::uint64_t c = part_.column + column;
    return {part_.layer, around_ != 0 ? c % around_ : c, part_.row + rows_ + south - 1};
  }
  void add_diagonal(std::uint64_t c, const std::vector<char>& south) {
    const PostingRef nw = ref(c, 0), ne = ref(east_of(c), 0), sw = ref(c, 1), se = ref(east_of(c), 1);
    add(!north_[c]            ? OutlineEdge{ne, sw}
        : !north_[east_of(c)] ? OutlineEdge{se, nw}
        : !south[c]           ? OutlineEdge{nw, se}
                              : OutlineEdge{sw, ne});
  }
  void add(const OutlineEdge& edge) { outline_.add(edge); }

  LayerPart part_;
  std::uint64_t around_;
  const PostingRuns& covered_;
  std::uint64_t cells_;
  Outline& outline_;
  std::uint64_t rows_ = 0;
  std::vector<PostingRef> loose_;
  std::vector<char> north_, cells_north_;  // the row before, and the cells north of it
};

std::vector<PostingRun> runs_of(const std::vector<char>& bits) {
  std::vector<PostingRun> runs;
  for (std::uint64_t c = 0; c < bits.size(); ++c) {
    if (!bits[c]) continue;
    if (!runs.empty() && runs.back().end == c)
      runs.back().end = c + 1;
    else
      runs.push_back({c, c + 1});
  }
  return runs;
}

}  // namespace

std::size_t Outline::Hash::operator()(const OutlineEdge& edge) const {
  std::uint64_t seed = 1;
  for (const PostingRef& end : {edge.from, edge.to}) {
    for (const std::uint64_t value : {std::uint64_t{end.layer}, end.column, end.row})
      seed = mixed(seed, value);
  }
  return seed;
}

void Outline::add(const OutlineEdge& edge) {
  if (edges_.erase({edge.to, edge.from}) == 0) edges_.insert(edge);
}

std::vector<OutlineEdge> Outline::edges() const {
  std::vector<OutlineEdge> out(edges_.begin(), edges_.end());
  const auto key = [](const OutlineEdge& e) {
    return std::tuple(e.from.layer, e.from.row, e.from.column, e.to.layer, e.to.row, e.to.column);
  };
  std::ranges::sort(out, {}, key);
  return out;
}

Result<PartPostings> trace(const MosaicField& field, const LayerPart& part, const PostingRuns& covered,
                           Outline& outline) {
  PartPostings out{PostingRuns(part.row), {}};
  CellRows cells(part, field.layers()[part.layer].columns_around, covered, outline);
  const std::uint64_t rows_at_once = std::max<std::uint64_t>(1, postings_at_once / part.width);
  std::vector<double> heights;
  std::vector<char> bits(part.width);
  MosaicCounts ignored;
  for (std::uint64_t done = 0; done < part.height; done += rows_at_once) {
    const std::uint64_t rows = std::min(rows_at_once, part.height - done);
    heights.resize(rows * part.width);
    CUESTA_TRY(field.read(part.layer, {part.column, part.row + done, part.width, rows}, heights, ignored));
    for (std::uint64_t r = 0; r < rows; ++r) {
      for (std::uint64_t c = 0; c < part.width; ++c) bits[c] = !std::isnan(heights[r * part.width + c]);
      out.with_data.add_row(runs_of(bits));
      for (const PostingRun& run : covered.row(part.row + done + r))
        std::fill(bits.begin() + std::ptrdiff_t(run.begin), bits.begin() + std::ptrdiff_t(run.end), char{0});
      cells.add_row(bits);
    }
  }
  out.loose = cells.finish();
  return out;
}

}  // namespace cuesta
