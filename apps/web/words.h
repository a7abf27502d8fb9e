#pragma once
/// What a step tells, as words of 32 bits.

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "runtime/draw_list.h"

namespace cuesta::web {

class Words {
 public:
  explicit Words(std::vector<std::uint32_t>& words) : words_(words) { words_.clear(); }
  void put(std::size_t n) { words_.push_back(static_cast<std::uint32_t>(n)); }
  void put(std::span<const Range> ranges) {
    for (const Range& r : ranges) put(r.first), put(r.count);
  }
  template <class Element>
  void put_elements(std::span<const Element> elements) {
    static_assert(sizeof(Element) % sizeof(std::uint32_t) == 0);
    const std::size_t at = words_.size();
    words_.resize(at + elements.size_bytes() / sizeof(std::uint32_t));
    if (!elements.empty()) std::memcpy(&words_[at], elements.data(), elements.size_bytes());
  }
  template <class Element>
  void put_elements(std::span<const Element> pool, std::span<const Range> ranges) {
    for (const Range& r : ranges) put_elements(pool.subspan(r.first, r.count));
  }

 private:
  std::vector<std::uint32_t>& words_;
};

}  // namespace cuesta::web
