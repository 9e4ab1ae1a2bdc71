# Installs the library component, builds docs/examples/own_device against it with find_package(palpate), and runs it.
function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "failed (${code}): ${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE "${WORK_DIR}")
must(${CMAKE_COMMAND} --install "${BUILD_DIR}" --component library --prefix "${WORK_DIR}/prefix")

file(STRINGS "${EXAMPLE_DIR}/main.cpp" lines)
list(LENGTH lines length)
if(length GREATER 50)
  message(FATAL_ERROR "docs/examples/own_device/main.cpp has ${length} lines; at most 50 were promised")
endif()

set(flags "")
if(SANITIZE)
  string(REPLACE ";" "," SANITIZE "${SANITIZE}")
  set(flags "-DCMAKE_EXE_LINKER_FLAGS=-fsanitize=${SANITIZE}")
endif()
must(${CMAKE_COMMAND} -S "${EXAMPLE_DIR}" -B "${WORK_DIR}/build" -G Ninja -DCMAKE_BUILD_TYPE=Release
  -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix ${flags})
must(${CMAKE_COMMAND} --build "${WORK_DIR}/build")
must("${WORK_DIR}/build/own_device")
message(STATUS "${output}")
