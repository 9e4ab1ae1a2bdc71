# How every target of ours is compiled, in one place.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
# Every build keeps its assertions, for every build is tested. Not -O3, but for compute/: elsewhere it gains
# nothing, builds longer, and GCC 12 then warns of overlaps in the standard library's strings that are not
# there.
set(CMAKE_CXX_FLAGS_RELEASE "-O2")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O2 -g")
if(PALPATE_SANITIZE)   # half the compiling; a report still names its lines
  set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1")
endif()
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
find_package(Threads REQUIRED)

option(PALPATE_TOGETHER
  "Compile the files of a folder as one: a whole build takes less, a change more, and ccache in another checkout does not know it"
  ON)
# The headers that most files include, compiled once for each set of options: a third to a half of the
# compiling. -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON turns them off, for ccache to know a file from another
# checkout, and to see that each includes what it uses.
set(palpate_common_headers <algorithm> <array> <atomic> <chrono> <cmath> <cstdint> <cstring> <filesystem>
  <fstream> <functional> <map> <memory> <mutex> <optional> <random> <set> <span> <string> <string_view>
  <thread> <utility> <variant> <vector>
  <glm/gtc/quaternion.hpp> <glm/mat3x3.hpp> <glm/vec3.hpp>)

# palpate_precompile(NAME OPTION [more headers]): an object library of nothing but them, with -fPIC for
# libraries or -fPIE for programs.
function(palpate_precompile name option)
  add_library(${name} OBJECT "${PROJECT_SOURCE_DIR}/scripts/cmake/precompiled.cpp")
  palpate_compile_options(${name} "")
  target_compile_options(${name} PRIVATE ${option})
  # CMake's own option, which for an object library is -fPIC.
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_precompile_headers(${name} PRIVATE ${palpate_common_headers} ${ARGN})
endfunction()

# Warnings are errors on our own targets (of GCC). -ffp-contract=off: what both back ends compute on the host
# must not depend on whether the compiler found a fused multiply-add.
# palpate_compile_options(TARGET [PRECOMPILED]): with the common headers, with another target's, or with none
# ("").
function(palpate_compile_options target)
  get_target_property(type ${target} TYPE)
  set(precompiled palpate_precompiled_library)
  if(ARGC GREATER 1)
    set(precompiled "${ARGV1}")
  elseif(type STREQUAL "EXECUTABLE")
    set(precompiled palpate_precompiled_program)
  endif()
  if(precompiled)
    target_precompile_headers(${target} REUSE_FROM ${precompiled})
  endif()
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
    -Wnon-virtual-dtor -Woverloaded-virtual -ffp-contract=off
    $<$<CXX_COMPILER_ID:GNU>:-Werror> $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)   # -Wrestrict: GCC bug 105329
  # GCC 12 forgets that precompiled headers are the system's, and finds std::string to copy beyond its end
  # (bug 105329)
  if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>
      $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>
      $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overread>)
  endif()
  target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}")
  # A warning inside a library's template is not ours to mend.
  target_compile_definitions(${target} PRIVATE GLM_FORCE_EXPLICIT_CTOR GLM_ENABLE_EXPERIMENTAL)
  if(PALPATE_SANITIZE)
    string(REPLACE ";" "," sanitizers "${PALPATE_SANITIZE}")
    target_compile_options(${target} PRIVATE -fsanitize=${sanitizers} -fno-omit-frame-pointer
      -fno-sanitize-recover=all
      # GCC bug 105616: std::regex under the address sanitizer.
      $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    target_link_options(${target} PRIVATE -fsanitize=${sanitizers})
    # The library's own checks see an index beyond a span or an optional without a value, which may well lie
    # in memory of ours.
    target_compile_definitions(${target} PRIVATE PALPATE_SANITIZED _GLIBCXX_ASSERTIONS)
    if(PALPATE_SANITIZE STREQUAL "thread")
      target_compile_definitions(${target} PRIVATE PALPATE_SANITIZED_THREADS)
    endif()
  endif()
endfunction()

# Boost.Beast's coroutines, of which a file is a minute's compiling: no more optimizing than pays where a
# socket is waited for, and under the sanitizers none: clang takes three minutes over what is half a one so,
# and GCC 12 sees uninitialised values in Boost that are not. -fsanitize=undefined can't be had: clang 14
# writes objects that its assembler refuses. The thread sanitizer does not know Asio's fences, which stand
# beside mutexes that it does.
set(palpate_beast_options -O1)
if(PALPATE_SANITIZE)
  set(palpate_beast_options -O0 -fno-sanitize=undefined $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>
    $<$<CXX_COMPILER_ID:GNU>:-Wno-tsan>)
endif()
# It has C++20's coroutines and does not say so.
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 15)
  list(APPEND palpate_beast_options -D__cpp_impl_coroutine=201902L -DBOOST_ASIO_HAS_CO_AWAIT=1)
endif()

# palpate_beast_library(name a.cpp): a static library of such files, without the headers that are compiled
# with other options.
function(palpate_beast_library name)
  add_library(${name} STATIC ${ARGN})
  palpate_compile_options(${name} "")
  target_compile_options(${name} PRIVATE ${palpate_beast_options})
  palpate_together(${name})
endfunction()

# palpate_together(TARGET [EXCEPT "folders"]): compiles the files of a folder as one, since much of the
# compiling is of what they include. So within a folder a name of an unnamed namespace stands for one thing.
# EXCEPT: a regular expression of folders whose files stay apart.
function(palpate_together target)
  cmake_parse_arguments(arg "" "EXCEPT" "" ${ARGN})
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" OUTPUT_VARIABLE folder)
    cmake_path(GET folder PARENT_PATH folder)
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY "${PROJECT_SOURCE_DIR}")
    if(NOT arg_EXCEPT OR NOT folder MATCHES "${arg_EXCEPT}")
      string(MAKE_C_IDENTIFIER "${folder}" folder)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder})
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${PALPATE_TOGETHER} UNITY_BUILD_MODE GROUP)
  if(PALPATE_TOGETHER)   # to GCC an unnamed namespace in an included file is a header's
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

# palpate_library(model a.cpp b.cpp): the static library palpate_model, known as palpate::model.
function(palpate_library name)
  add_library(palpate_${name} STATIC ${ARGN})
  add_library(palpate::${name} ALIAS palpate_${name})
  set_target_properties(palpate_${name} PROPERTIES EXPORT_NAME ${name})
  palpate_compile_options(palpate_${name})
  target_include_directories(palpate_${name} PUBLIC
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>" "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/palpate>")
endfunction()

# A test's own arithmetic is not what is tested, and that sanitizer is a third of its compiling.
function(palpate_options_of_tests target)
  if(PALPATE_SANITIZE MATCHES "undefined")
    target_compile_options(${target} PRIVATE -fno-sanitize=undefined)
  endif()
endfunction()

# palpate_test_objects(name SOURCES a.cpp [LIBS palpate::model]): what several tests share, compiled once.
function(palpate_test_objects name)
  cmake_parse_arguments(arg "" "" "SOURCES;LIBS" ${ARGN})
  add_library(${name} OBJECT ${arg_SOURCES})
  palpate_compile_options(${name})
  palpate_options_of_tests(${name})
  target_link_libraries(${name} PRIVATE ${arg_LIBS})
endfunction()

# palpate_test(lattice_test LABEL quick SOURCES lattice_test.cpp LIBS palpate::model
#   [ENV "A=1;B=2"] [TIMEOUT 60])
function(palpate_test name)
  cmake_parse_arguments(arg "" "LABEL;TIMEOUT" "SOURCES;LIBS;ENV" ${ARGN})
  if(NOT arg_LABEL)
    set(arg_LABEL quick)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  add_executable(${name} ${arg_SOURCES})
  palpate_compile_options(${name} palpate_precompiled_test)
  palpate_options_of_tests(${name})
  target_link_libraries(${name} PRIVATE ${arg_LIBS} GTest::gmock GTest::gtest_main)
  add_test(NAME ${name} COMMAND ${name})
  # Host code runs under the sanitizers in CI too: asan_tests and tsan_tests build just those, the labels run
  # them.
  get_filename_component(folder "${CMAKE_CURRENT_SOURCE_DIR}" NAME)
  if(arg_LABEL STREQUAL "quick" AND folder MATCHES "^(model|driver|service|library)$")
    list(APPEND arg_LABEL asan)
    add_dependencies(asan_tests ${name})
  endif()
  if(arg_LABEL MATCHES "quick" AND folder STREQUAL "service" AND NOT name STREQUAL "serve_test")
    list(APPEND arg_LABEL tsan)
    add_dependencies(tsan_tests ${name})
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${arg_LABEL}" TIMEOUT ${arg_TIMEOUT} ENVIRONMENT
    "${arg_ENV}")
endfunction()
