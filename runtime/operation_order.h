#pragma once
/// Fans to be moved, in the order in which that is legal (I4): coarsenings by rising sse, refinements by
/// falling sse. Sorted piece by piece, as far as a frame gets.

#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/page.h"

namespace cuesta {

/// A fan to be moved to `goal` applied substitutions; `sse` is the largest (coarsening: of those it applies;
/// refining: of those it undoes).
struct Operation {
  double sse;
  PageId page;
  std::uint32_t fan;
  std::uint16_t goal;
};

class OperationOrder {
 public:
  enum class Direction : std::uint8_t { rising, falling };
  explicit OperationOrder(Direction direction) : direction_(direction) {}

  void clear() { operations_.clear(), sorted_ = next_ = 0; }
  void add(const Operation& op) { operations_.push_back(op); }
  std::size_t size() const { return operations_.size(); }
  /// The next operation; ties in sse go finer pages and earlier fans first when rising, the other way round
  /// when falling. Null at the end. No add() after the first next().
  const Operation* next();

 private:
  void bin();
  void sort(std::size_t first, std::size_t last);

  Direction direction_;
  std::vector<Operation> operations_, scratch_;
  std::vector<std::uint32_t> bin_end_;
  std::size_t sorted_ = 0, next_ = 0, bin_ = 0;
};

}  // namespace cuesta
