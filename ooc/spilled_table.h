#pragma once
/// An array that only grows and may be larger than memory: its beginning in memory, the rest in a file
/// without a name.

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <type_traits>
#include <vector>

#include "ooc/cached_file.h"
#include "ooc/read_job.h"
#include "ooc/temp_file.h"

namespace cuesta {

/// Pages of one size, appended to a temporary file and read back through a cache.
class SpillFile {
 public:
  SpillFile(ReadBudget& budget, std::filesystem::path temp, std::size_t page_bytes)
      : budget_(budget), temp_(std::move(temp)), page_bytes_(page_bytes) {}
  ~SpillFile() { budget_.release(charged_); }
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;

  /// Makes the file; charges one page for the caller, and the cache: a 16th of what is left, at least a page.
  /// @error out_of_budget; of TempFile::create().
  Result<void> begin(const char* what);
  /// @pre begin() was good; `page` has page_bytes. @error of TempFile::write().
  Result<void> append(const char* page);
  /// @pre number < pages(). @return page_bytes, valid until the next call. @error of TempFile::read().
  Result<const char*> page(std::uint64_t number) { return cache_->page(number); }
  std::uint64_t pages() const { return pages_; }

 private:
  ReadBudget& budget_;
  std::filesystem::path temp_;
  std::size_t page_bytes_;
  std::uint64_t charged_ = 0, pages_ = 0;
  std::optional<TempFile> file_;
  std::optional<CachedFile> cache_;
};

/// Holds, and charges to the budget, chunks of at most 256 KiB while keep_free() bytes of the budget stay
/// free; after that 16 KiB and a cache, however many elements come. Not thread-safe, not for reading either.
template <class T>
class SpilledTable {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  static constexpr std::size_t chunk_elements = std::bit_floor((std::size_t{1} << 18) / sizeof(T));
  static constexpr std::size_t page_elements = std::bit_floor((std::size_t{1} << 14) / sizeof(T));

  /// @param what  the elements' name, for messages.
  SpilledTable(const ReadJob& job, const char* what)
      : budget_(job.budget),
        keep_free_(job.budget.left() / 2),
        what_(what),
        spill_(job.budget, job.temp, page_elements * sizeof(T)) {}
  ~SpilledTable() { budget_.release(chunks_.size() * chunk_elements * sizeof(T)); }
  SpilledTable(const SpilledTable&) = delete;
  SpilledTable& operator=(const SpilledTable&) = delete;

  /// Call before the first append(); without it, half of what was left when the table was made stays free.
  void keep_free(std::uint64_t bytes) { keep_free_ = bytes; }
  std::uint64_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool is_spilled() const { return tail_ != nullptr; }

  /// @error out_of_budget: not even two pages fit, or the disk is full; io, not_found: the temporary file.
  Result<void> append(const T& value) {
    if (next_ == end_) CUESTA_TRY(make_room());
    *next_++ = value;
    ++size_;
    return {};
  }
  /// @pre i < size(). @error io.
  Result<T> get(std::uint64_t i) {
    if (i < in_memory_) return chunks_[i / chunk_elements][i % chunk_elements];
    return get_spilled(i - in_memory_);
  }

 private:
  Result<void> make_room() {
    std::size_t room = page_elements;
    if (tail_) {
      CUESTA_TRY(spill_.append(reinterpret_cast<const char*>(tail_.get())));
      next_ = tail_.get();
    } else if (budget_.left() >= keep_free_ + chunk_elements * sizeof(T)) {
      CUESTA_TRY(budget_.charge(chunk_elements, sizeof(T), what_));
      chunks_.push_back(std::make_unique_for_overwrite<T[]>(chunk_elements));
      in_memory_ += chunk_elements;
      next_ = chunks_.back().get();
      room = chunk_elements;
    } else {
      CUESTA_TRY(spill_.begin(what_));
      tail_ = std::make_unique_for_overwrite<T[]>(page_elements);
      next_ = tail_.get();
    }
    end_ = next_ + room;
    return {};
  }
  Result<T> get_spilled(std::uint64_t i) {
    const std::uint64_t page = i / page_elements;
    const std::size_t k = static_cast<std::size_t>(i % page_elements);
    if (page == spill_.pages()) return tail_[k];
    const auto bytes = spill_.page(page);
    if (!bytes) return fail(bytes.error());
    T value;
    std::memcpy(&value, *bytes + k * sizeof(T), sizeof(T));
    return value;
  }

  ReadBudget& budget_;
  std::uint64_t keep_free_;
  const char* what_;
  std::uint64_t size_ = 0, in_memory_ = 0;
  T* next_ = nullptr;
  T* end_ = nullptr;
  std::vector<std::unique_ptr<T[]>> chunks_;
  std::unique_ptr<T[]> tail_;  ///< the page that is being filled
  SpillFile spill_;
};

}  // namespace cuesta
