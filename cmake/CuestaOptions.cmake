# Language level, warnings, sanitizers and the compiler cache: what holds for every target.
option(CUESTA_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(CUESTA_TOOLS "Build the data makers, baselines and benchmarks" ${PROJECT_IS_TOP_LEVEL})
option(CUESTA_FUZZ "Build the fuzz targets (needs clang)" OFF)
option(CUESTA_WEB "Build the browser client, too, and install its page (needs emscripten and npm)" OFF)
set(CUESTA_SANITIZE "" CACHE STRING "Sanitizers for all targets, for example address,undefined")

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "" FORCE)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

add_library(cuesta_flags INTERFACE)
target_compile_features(cuesta_flags INTERFACE cxx_std_20)
# One answer on every machine (I6): no contraction into FMA, no reassociation.
target_compile_options(cuesta_flags INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -ffp-contract=off -fno-math-errno -fno-trapping-math
  # GCC 12 warns of its own std::string (bug 105651).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>)
if(CUESTA_SANITIZE)
  add_compile_options(-fsanitize=${CUESTA_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${CUESTA_SANITIZE})
endif()
if(CUESTA_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# cuesta_module(NAME SOURCES... ): a static library cuesta::NAME with the project's flags.
function(cuesta_module name)
  add_library(cuesta_${name} STATIC ${ARGN})
  add_library(cuesta::${name} ALIAS cuesta_${name})
  set_target_properties(cuesta_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(cuesta_${name} PUBLIC cxx_std_20)
  target_link_libraries(cuesta_${name} PRIVATE $<BUILD_INTERFACE:cuesta_flags>)
  target_include_directories(cuesta_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/cuesta>)
endfunction()
