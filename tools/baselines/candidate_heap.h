#pragma once
/// A heap of numbered items whose keys change: which triangle is the worst now.

#include <cstdint>
#include <limits>
#include <vector>

namespace cuesta::baselines {

/// Largest key first; of equal keys the smallest number. 16 bytes per item.
class CandidateHeap {
 public:
  bool empty() const { return heap_.empty(); }
  std::uint32_t top() const { return heap_.front(); }

  /// Puts `item` in, or moves it to where its new key belongs.
  void set(std::uint32_t item, double key) {
    if (item >= place_.size()) {
      place_.resize(std::size_t{item} + 1, absent);
      key_.resize(std::size_t{item} + 1);
    }
    key_[item] = key;
    if (place_[item] == absent) {
      place_[item] = static_cast<std::uint32_t>(heap_.size());
      heap_.push_back(item);
    }
    sink(rise(place_[item]));
  }

  /// Takes `item` out if it is in.
  void remove(std::uint32_t item) {
    if (item >= place_.size() || place_[item] == absent) return;
    const std::uint32_t hole = place_[item], moved = heap_.back();
    heap_.pop_back();
    place_[item] = absent;
    if (moved == item) return;
    put(hole, moved);
    sink(rise(hole));
  }

 private:
  static constexpr std::uint32_t absent = std::numeric_limits<std::uint32_t>::max();

  bool before(std::uint32_t a, std::uint32_t b) const {
    return key_[a] > key_[b] || (key_[a] == key_[b] && a < b);
  }
  void put(std::uint32_t place, std::uint32_t item) {
    heap_[place] = item;
    place_[item] = place;
  }
  std::uint32_t rise(std::uint32_t place) {
    const std::uint32_t item = heap_[place];
    for (; place > 0 && before(item, heap_[(place - 1) / 2]); place = (place - 1) / 2)
      put(place, heap_[(place - 1) / 2]);
    put(place, item);
    return place;
  }
  void sink(std::uint32_t place) {
    const std::uint32_t item = heap_[place];
    for (std::size_t child; (child = std::size_t{place} * 2 + 1) < heap_.size();
         place = static_cast<std::uint32_t>(child)) {
      if (child + 1 < heap_.size() && before(heap_[child + 1], heap_[child])) ++child;
      if (!before(heap_[child], item)) break;
      put(place, heap_[child]);
    }
    put(place, item);
  }

  std::vector<std::uint32_t> heap_, place_;
  std::vector<double> key_;
};

}  // namespace cuesta::baselines
