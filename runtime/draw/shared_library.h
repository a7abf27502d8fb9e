#pragma once
/// Functions of a library that is loaded when it is first used: what brings a driver or a window system
/// should cost nothing, and need not be installed, where nothing is drawn.

#include <dlfcn.h>

namespace cuesta {

/// Sets `function` to the library's function of that name. @return false if it has none.
template <class F>
bool find_function(void* library, const char* name, F& function) {
  function = reinterpret_cast<F>(::dlsym(library, name));
  return function != nullptr;
}

}  // namespace cuesta
