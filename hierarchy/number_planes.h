#pragma once
/// Numbers as an entropy coder likes them: a byte for each number's class, and the low bits of large ones in
/// a stream of their own. Classes of numbers of different kinds go to different planes, since each plane is
/// compressed by itself.
///
/// Class c < 16 is the number c. Otherwise, with e = (c - 16) / 2 + 4, the number is
/// 2^e + ((c - 16) % 2) · 2^(e - 1) + the next e - 1 bits. Signed numbers 0, -1, 1, -2, … are 0, 1, 2, 3, ….

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "ooc/check.h"

namespace cuesta {

using Plane = std::vector<std::byte>;

/// Numbers are below 2^40: the bits of one fit into a 64-bit word wherever they begin.
inline constexpr unsigned number_bits = 40;

constexpr std::uint64_t unsigned_of(std::int64_t v) {
  return (static_cast<std::uint64_t>(v) << 1) ^ static_cast<std::uint64_t>(v >> 63);
}
constexpr std::int64_t signed_of(std::uint64_t v) {
  return static_cast<std::int64_t>(v >> 1) ^ -static_cast<std::int64_t>(v & 1);
}

/// What a class says of its numbers.
struct NumberClass {
  std::uint64_t first = 0;  ///< the smallest one
  std::uint8_t bits = 0;    ///< that follow
  bool is_valid = false;
};

inline constexpr auto number_classes = [] {
  std::array<NumberClass, 256> classes{};
  for (unsigned c = 0; c < 16; ++c) classes[c] = {c, 0, true};
  for (unsigned e = 4; e < number_bits; ++e)
    for (unsigned half = 0; half < 2; ++half)
      classes[16 + (e - 4) * 2 + half] = {(2ull | half) << (e - 1), static_cast<std::uint8_t>(e - 1), true};
  return classes;
}();

class NumberWriter {
 public:
  explicit NumberWriter(std::size_t planes) : planes_(planes) {}

  /// @pre v < 2^number_bits
  void put(std::size_t plane, std::uint64_t v) {
    if (v < 16) {
      planes_[plane].push_back(static_cast<std::byte>(v));
      return;
    }
    CUESTA_CHECK(v >> number_bits == 0, v);
    const auto e = static_cast<unsigned>(std::bit_width(v)) - 1;
    planes_[plane].push_back(static_cast<std::byte>(16 + (e - 4) * 2 + ((v >> (e - 1)) & 1)));
    put_bits(v & ((std::uint64_t{1} << (e - 1)) - 1), e - 1);
  }
  void put_signed(std::size_t plane, std::int64_t v) { put(plane, unsigned_of(v)); }

  /// The planes of classes, then the bits, filled up with zeros to a whole byte.
  std::vector<Plane> take() {
    if (pending_ > 0) bits_.push_back(static_cast<std::byte>(word_));
    planes_.push_back(std::move(bits_));
    return std::move(planes_);
  }

 private:
  void put_bits(std::uint64_t bits, unsigned count) {
    word_ |= bits << pending_;  // fewer than 8 are pending
    pending_ += count;
    for (; pending_ >= 8; pending_ -= 8, word_ >>= 8) bits_.push_back(static_cast<std::byte>(word_));
  }

  std::vector<Plane> planes_;
  Plane bits_;
  std::uint64_t word_ = 0;
  unsigned pending_ = 0;
};

/// Reads past the end of a plane give zeros and make ok() false: check once, after a group of reads.
class NumberReader {
 public:
  static constexpr std::size_t most_planes = 8;

  /// @param planes  as NumberWriter::take gave them, at most most_planes of classes; they must outlive this
  explicit NumberReader(std::span<const Plane> planes) : bits_(planes.back()), count_(planes.size() - 1) {
    CUESTA_CHECK(count_ <= most_planes, count_);
    for (std::size_t p = 0; p < count_; ++p)
      ends_[p] = {planes[p].data(), planes[p].data() + planes[p].size()};
  }

  std::uint64_t get(std::size_t plane) {
    Ends& at = ends_[plane];
    if (at.next == at.end) {
      ok_ = false;
      return 0;
    }
    const auto& known = number_classes[static_cast<std::size_t>(*at.next++)];
    ok_ &= known.is_valid;
    return known.first + get_bits(known.bits);
  }
  std::int64_t get_signed(std::size_t plane) { return signed_of(get(plane)); }

  bool ok() const { return ok_; }
  bool at_end() const {
    for (std::size_t p = 0; p < count_; ++p)
      if (ends_[p].next != ends_[p].end) return false;
    return ok_ && (bit_ + 7) / 8 == bits_.size();
  }

 private:
  struct Ends {
    const std::byte *next = nullptr, *end = nullptr;
  };

  std::uint64_t get_bits(unsigned count) {
    const std::size_t byte = bit_ / 8, shift = bit_ % 8;
    bit_ += count;
    std::uint64_t word = 0;
    if (byte + 8 <= bits_.size()) {
      std::memcpy(&word, bits_.data() + byte, 8);
    } else {
      if (bit_ > bits_.size() * 8) {
        ok_ = false;
        bit_ -= count;
        return 0;
      }
      if (byte < bits_.size()) std::memcpy(&word, bits_.data() + byte, bits_.size() - byte);
    }
    return (word >> shift) & ((std::uint64_t{1} << count) - 1);
  }

  Ends ends_[most_planes];
  std::span<const std::byte> bits_;
  std::size_t count_, bit_ = 0;
  bool ok_ = true;
};

}  // namespace cuesta
