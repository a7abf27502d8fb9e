#pragma once
/// What the C++ library of Debian 12's Emscripten (3.1.6) lacks of C++20. Included before every source of the
/// module.

#include <bit>

#ifndef __cpp_lib_bit_cast
namespace std {

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

}  // namespace std
#endif
