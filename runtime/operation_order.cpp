#include "runtime/operation_order.h"

#include <algorithm>
#include <bit>
#include <tuple>

namespace cuesta {
namespace {

// Sixteen bins of sse to the octave: the upper bits of a positive float.
constexpr std::uint32_t bin_shift = 19;
constexpr std::size_t bins = (0x7F800000u >> bin_shift) + 1;

/// So many are sorted at once, without going through thousands of bins.
constexpr std::size_t few = 512;

bool before(const Operation& a, const Operation& b) {
  return std::tie(a.sse, a.page, a.fan) < std::tie(b.sse, b.page, b.fan);
}

}  // namespace

void OperationOrder::bin() {
  const auto bin_of = [this](const Operation& op) {
    const std::size_t bin = std::bit_cast<std::uint32_t>(static_cast<float>(op.sse)) >> bin_shift;
    return direction_ == Direction::rising ? bin : bins - 1 - bin;
  };
  bin_end_.assign(bins + 1, 0);
  for (const Operation& op : operations_) ++bin_end_[bin_of(op) + 1];
  for (std::size_t b = 0; b < bins; ++b) bin_end_[b + 1] += bin_end_[b];
  scratch_.resize(operations_.size());
  for (const Operation& op : operations_) scratch_[bin_end_[bin_of(op)]++] = op;
  operations_.swap(scratch_);  // bin_end_[b] is now the end of bin b
  bin_ = 0;
}

void OperationOrder::sort(std::size_t first, std::size_t last) {
  const auto begin = operations_.begin() + static_cast<std::ptrdiff_t>(first);
  const auto end = operations_.begin() + static_cast<std::ptrdiff_t>(last);
  if (direction_ == Direction::rising)
    std::sort(begin, end, before);
  else
    std::sort(begin, end, [](const Operation& a, const Operation& b) { return before(b, a); });
  sorted_ = last;
}

const Operation* OperationOrder::next() {
  if (next_ == operations_.size()) return nullptr;
  if (sorted_ == 0 && operations_.size() <= few) sort(0, operations_.size());
  if (sorted_ == 0) bin();
  while (next_ == sorted_) sort(sorted_, bin_end_[bin_++]);
  return &operations_[next_++];
}

}  // namespace cuesta
