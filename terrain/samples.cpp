#include "terrain/samples.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

namespace cuesta {
namespace {

static_assert(std::endian::native == std::endian::little);

/// Calls `f` with a value of the C++ type of `type`.
template <class F>
void with_type(SampleType type, F&& f) {
  switch (type) {
    case SampleType::u8:
      return f(std::uint8_t{});
    case SampleType::i8:
      return f(std::int8_t{});
    case SampleType::u16:
      return f(std::uint16_t{});
    case SampleType::i16:
      return f(std::int16_t{});
    case SampleType::u32:
      return f(std::uint32_t{});
    case SampleType::i32:
      return f(std::int32_t{});
    case SampleType::f32:
      return f(float{});
    case SampleType::f64:
      return f(double{});
  }
}

/// `value` as a T stores it, NaN if it cannot be near.
template <class T>
double as_stored(double value) {
  if constexpr (std::is_same_v<T, double>) {
    return value;
  } else if constexpr (std::is_same_v<T, float>) {
    // Written with a digit too many, the lowest float is a little beyond the range.
    constexpr double most = std::numeric_limits<float>::max();
    if (std::abs(value) > most * 1.000001) return std::isinf(value) ? value : std::nan("");
    return static_cast<double>(static_cast<float>(std::clamp(value, -most, most)));
  } else {
    const bool fits = value >= static_cast<double>(std::numeric_limits<T>::min()) &&
                      value <= static_cast<double>(std::numeric_limits<T>::max()) &&
                      value == std::floor(value);
    return fits ? value : std::nan("");
  }
}

template <class T>
T load(const std::byte* from, ByteOrder order) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if (order == ByteOrder::big) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

template <class T>
void convert(const std::byte* samples, ByteOrder order, const SampleMeaning& meaning,
             std::span<double> heights) {
  std::vector<double> no_data;
  for (const double value : meaning.no_data) no_data.push_back(as_stored<T>(value));
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const double value = static_cast<double>(load<T>(samples + i * sizeof(T), order));
    double height = (value * meaning.scale + meaning.offset) * meaning.unit_m;
    if (!(value >= meaning.least && value <= meaning.most) || !std::isfinite(height)) height = std::nan("");
    for (const double none : no_data) {
      if (value == none) height = std::nan("");
    }
    heights[i] = height;
  }
}

}  // namespace

std::size_t bytes_of(SampleType type) {
  std::size_t bytes = 0;
  with_type(type, [&](auto value) { bytes = sizeof(value); });
  return bytes;
}

const char* name(SampleType type) {
  static constexpr std::array<const char*, 8> names{"uint8",  "int8",  "uint16",  "int16",
                                                    "uint32", "int32", "float32", "float64"};
  return names.at(static_cast<std::size_t>(type));
}

void to_heights(std::span<const std::byte> samples, SampleType type, ByteOrder order,
                const SampleMeaning& meaning, std::span<double> heights) {
  with_type(type, [&](auto value) { convert<decltype(value)>(samples.data(), order, meaning, heights); });
}

void fill_with_no_data(std::span<std::byte> samples, SampleType type, const SampleMeaning& meaning) {
  std::fill(samples.begin(), samples.end(), std::byte{0});
  with_type(type, [&](auto zero) {
    using T = decltype(zero);
    for (const double wanted : meaning.no_data) {
      const double stored = as_stored<T>(wanted);
      if (std::isnan(stored)) continue;
      const T value = static_cast<T>(stored);
      for (std::size_t i = 0; i + sizeof(T) <= samples.size(); i += sizeof(T))
        std::memcpy(samples.data() + i, &value, sizeof(T));
      return;
    }
  });
}

}  // namespace cuesta
