# cmake -D ROOT=… -P check_layout.cmake: fails on an #include that points back, and on a path of one machine.
#
#   ooc ← hierarchy ← runtime ← runtime/draw      ooc ← terrain      apps, tests and tools use everything
cmake_policy(VERSION 3.25)

set(may_include_ooc ooc)
set(may_include_hierarchy hierarchy ooc)
set(may_include_runtime runtime hierarchy ooc)
set(may_include_runtime/draw runtime/draw runtime hierarchy ooc)
set(may_include_terrain terrain ooc)

# The module that a path from the root belongs to; empty for what is not a module's.
function(module_of path out)
  set(module "")
  if(path MATCHES "^runtime/draw/")
    set(module runtime/draw)
  elseif(path MATCHES "^(ooc|hierarchy|runtime|terrain|apps|tests|tools)/")
    set(module ${CMAKE_MATCH_1})
  endif()
  set(${out} "${module}" PARENT_SCOPE)
endfunction()

set(faults "")
set(arrows 0)
file(GLOB_RECURSE sources RELATIVE ${ROOT}
  ${ROOT}/ooc/*.h ${ROOT}/ooc/*.cpp ${ROOT}/hierarchy/*.h ${ROOT}/hierarchy/*.cpp
  ${ROOT}/runtime/*.h ${ROOT}/runtime/*.cpp ${ROOT}/terrain/*.h ${ROOT}/terrain/*.cpp)
foreach(source IN LISTS sources)
  module_of(${source} from)
  file(STRINGS ${ROOT}/${source} includes REGEX "^[ \t]*#[ \t]*include[ \t]*\"")
  foreach(include IN LISTS includes)
    string(REGEX REPLACE "^[^\"]*\"([^\"]*)\".*$" "\\1" path "${include}")
    math(EXPR arrows "${arrows} + 1")
    module_of(${path} to)
    if(to STREQUAL "")
      string(APPEND faults "  ${source} includes \"${path}\": write it from the root, as \"${from}/…\"\n")
    elseif(NOT to IN_LIST may_include_${from})
      string(APPEND faults "  ${source} includes \"${path}\": ${from} must not know ${to}\n")
    endif()
  endforeach()
endforeach()

# Paths that exist on one machine only. A file's own text is looked at, so the names are put together here.
set(machine_path "[\"' =(]/(home|root|work|Users|mnt)/[A-Za-z0-9._-]+")
file(GLOB_RECURSE texts RELATIVE ${ROOT}
  ${ROOT}/*.h ${ROOT}/*.cpp ${ROOT}/*.cmake ${ROOT}/CMakeLists.txt ${ROOT}/*.md ${ROOT}/*.json ${ROOT}/*.mjs
  ${ROOT}/*.py ${ROOT}/tools/setup ${ROOT}/tools/test ${ROOT}/tools/demo ${ROOT}/tools/bench/* ${ROOT}/.ci/run)
list(FILTER texts EXCLUDE REGEX "^(build|out|demo-out|node_modules)/")
foreach(text IN LISTS texts)
  file(STRINGS ${ROOT}/${text} lines REGEX "${machine_path}")
  foreach(line IN LISTS lines)
    string(APPEND faults "  ${text} has a path of one machine: ${line}\n")
  endforeach()
endforeach()

list(LENGTH sources source_count)
if(faults)
  message(FATAL_ERROR "layout:\n${faults}")
elseif(arrows EQUAL 0)
  message(FATAL_ERROR "layout: no #include found under ${ROOT}")
endif()
message("layout: ${arrows} arrows of ${source_count} files point the right way")
