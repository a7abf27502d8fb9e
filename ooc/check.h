#pragma once
/// CUESTA_CHECK(cond, values…): the caller's bug. On in every build at module borders; prints the condition
/// and the values, then aborts. Never used for what a file may contain: that is a Result (result.h).

#include <cstdio>
#include <cstdlib>
#include <iostream>

namespace cuesta::detail {

template <class... Values>
[[noreturn]] void check_failed(const char* condition, const char* file, int line, const Values&... values) {
  std::cerr << file << ':' << line << ": check failed: " << condition;
  ((std::cerr << ' ' << values), ...);
  std::cerr << std::endl;
  std::abort();
}

}  // namespace cuesta::detail

#define CUESTA_CHECK(cond, ...) \
  ((cond) ? void() : ::cuesta::detail::check_failed(#cond, __FILE__, __LINE__ __VA_OPT__(, ) __VA_ARGS__))
