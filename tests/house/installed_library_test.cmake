# Installs the library component, builds docs/examples/own_device against it with find_package(palpate), and
# runs it.
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
# build(SOURCE NAME): a stranger's project, built against what was installed.
function(build source name)
  must(${CMAKE_COMMAND} -S "${source}" -B "${WORK_DIR}/${name}" -G Ninja -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix ${flags})
  must(${CMAKE_COMMAND} --build "${WORK_DIR}/${name}")
endfunction()
build("${EXAMPLE_DIR}" own_device)
must("${WORK_DIR}/own_device/own_device")
message(STATUS "${output}")

# A program elsewhere finds the importer that was installed with the library.
build("${CMAKE_CURRENT_LIST_DIR}/installed_import" installed_import)
file(WRITE "${WORK_DIR}/triangle.off" "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
must("${WORK_DIR}/installed_import/installed_import" "${WORK_DIR}/triangle.off")
if(NOT output STREQUAL "1 triangles\n")
  message(FATAL_ERROR "the installed library read: ${output}")
endif()
