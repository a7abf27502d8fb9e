#pragma once
/// Which postings of a part of a layer, as runs along rows: memory for the outline, not for the area.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace cuesta {

struct PostingRun {
  std::uint64_t begin = 0, end = 0;  ///< columns [begin, end)
  bool operator==(const PostingRun&) const = default;
};

/// Rows are added from first_row on. 16 bytes a run and 24 a row.
class PostingRuns {
 public:
  explicit PostingRuns(std::uint64_t first_row = 0) : first_row_(first_row) {}

  /// @pre the runs rise and neither touch nor overlap.
  void add_row(std::vector<PostingRun> runs) { rows_.push_back(std::move(runs)); }

  bool empty() const { return rows_.empty(); }
  std::span<const PostingRun> row(std::uint64_t row) const {
    if (row < first_row_ || row - first_row_ >= rows_.size()) return {};
    return rows_[row - first_row_];
  }
  bool contains(std::uint64_t column, std::uint64_t at_row) const {
    const auto runs = row(at_row);
    const auto next = std::ranges::upper_bound(runs, column, {}, &PostingRun::begin);
    return next != runs.begin() && column < std::prev(next)->end;
  }
  std::uint64_t memory_bytes() const {
    std::uint64_t bytes = rows_.size() * sizeof(rows_[0]);
    for (const auto& runs : rows_) bytes += runs.size() * sizeof(PostingRun);
    return bytes;
  }

 private:
  std::uint64_t first_row_;
  std::vector<std::vector<PostingRun>> rows_;
};

/// Sorts, and joins what touches or overlaps.
inline std::vector<PostingRun> joined(std::vector<PostingRun> runs) {
  std::ranges::sort(runs, {}, &PostingRun::begin);
  std::vector<PostingRun> out;
  for (const PostingRun& run : runs) {
    if (run.begin >= run.end) continue;
    if (!out.empty() && run.begin <= out.back().end)
      out.back().end = std::max(out.back().end, run.end);
    else
      out.push_back(run);
  }
  return out;
}

}  // namespace cuesta
