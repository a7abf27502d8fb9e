#pragma once
/// The memory that a build was given: what is large is reserved before it is allocated. Reading has a budget
/// of its own (ReadBudget), half of it, before anything is reserved here.

#include <atomic>
#include <cstdint>
#include <string_view>
#include <utility>

#include "ooc/result.h"

namespace cuesta {

/// Meant for what a build holds beside its budget: the program itself, its libraries and stacks, blocks of
/// the allocator that are not full. What is kept per page and per piece of a bucket file is not reserved
/// either, and is more from 10^8 triangles on.
inline constexpr std::uint64_t memory_overhead_bytes = std::uint64_t{64} << 20;
/// A build with less is not begun. With this much any input can be built that is read in parts, with cells of
/// 2^15 triangles and up to nine threads.
inline constexpr std::uint64_t least_memory_bytes = std::uint64_t{256} << 20;

/// A hard limit: a reservation that would exceed it is refused. Thread-safe.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::uint64_t limit_bytes) : limit_(limit_bytes) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  /// Gives its bytes back when it goes. Must not outlive the budget.
  class Reservation {
   public:
    Reservation() = default;
    Reservation(Reservation&& other) noexcept
        : budget_(std::exchange(other.budget_, nullptr)), bytes_(other.bytes_) {}
    Reservation& operator=(Reservation&& other) noexcept {
      std::swap(budget_, other.budget_);
      std::swap(bytes_, other.bytes_);
      return *this;
    }
    ~Reservation() {
      if (budget_) budget_->used_ -= bytes_;
    }
    std::uint64_t bytes() const { return bytes_; }

   private:
    friend class MemoryBudget;
    Reservation(MemoryBudget* budget, std::uint64_t bytes) : budget_(budget), bytes_(bytes) {}
    MemoryBudget* budget_ = nullptr;
    std::uint64_t bytes_ = 0;
  };

  /// @param what  for the message: "the cells of a chunk"
  /// @error out_of_budget, with what is needed and what there is
  Result<Reservation> reserve(std::uint64_t bytes, std::string_view what);
  /// Room for as many things of `bytes` each as fit, `most` at most.
  /// @return the reservation and how many. @error out_of_budget if not even one does
  Result<std::pair<Reservation, std::size_t>> reserve_some(std::uint64_t bytes, std::size_t most,
                                                           std::string_view what);
  std::uint64_t limit_bytes() const { return limit_; }
  std::uint64_t used_bytes() const { return used_.load(); }

 private:
  std::uint64_t limit_;
  std::atomic<std::uint64_t> used_{0};
};

}  // namespace cuesta
