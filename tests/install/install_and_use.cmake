# cmake -D BUILD=… -D CONSUMER=… -D EXAMPLE=… -D SCRATCH=… -D COMPILER=… -P install_and_use.cmake
# Installs the build tree into a scratch prefix, then configures, builds and runs a project that finds it there.
cmake_policy(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " words)
    message(FATAL_ERROR "status ${status} from: ${words}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

set(prefix ${SCRATCH}/prefix)
file(REMOVE_RECURSE ${SCRATCH})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
run(${CMAKE_COMMAND} -S ${CONSUMER} -B ${SCRATCH}/build -G Ninja -D CMAKE_CXX_COMPILER=${COMPILER}
    -D CMAKE_PREFIX_PATH=${prefix} -D CMAKE_BUILD_TYPE=Release -D EXAMPLE=${EXAMPLE} "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${SCRATCH}/build)

run(${SCRATCH}/build/consumer)
if(NOT output MATCHES "built with cuesta [0-9]+\\.[0-9]+\\.[0-9]+")
  message(FATAL_ERROR "the consumer said: ${output}")
endif()
run(${prefix}/bin/cuesta --version)
run(${prefix}/bin/cuesta build ${CONSUMER}/octahedron.obj -o ${SCRATCH}/octahedron.cuesta --quiet)
run(${SCRATCH}/build/consumer ${SCRATCH}/octahedron.cuesta)
if(NOT output MATCHES "8 of 8 triangles")
  message(FATAL_ERROR "the consumer said: ${output}")
endif()
# A file that is none ends in a message and a status, in a stranger's program as in ours.
execute_process(COMMAND ${SCRATCH}/build/consumer ${EXAMPLE}
  RESULT_VARIABLE status ERROR_VARIABLE message OUTPUT_QUIET)
if(status EQUAL 0 OR NOT message MATCHES "fly.cpp")
  message(FATAL_ERROR "status ${status}, message: ${message}")
endif()
file(REMOVE_RECURSE ${SCRATCH})
message("install: the consumer was built and ran")
