# Toolchain: 64-bit ARM, compiled on Debian for x86-64 with the libraries in PALPATE_SYSROOT
# (tests/equivalence/sysroot makes that folder). Tests run in qemu.
if(NOT EXISTS "${PALPATE_SYSROOT}/complete")
  message(FATAL_ERROR
    "PALPATE_SYSROOT, '${PALPATE_SYSROOT}', is no folder that tests/equivalence/sysroot has made")
endif()
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES PALPATE_SYSROOT)
set(CMAKE_SYSROOT "${PALPATE_SYSROOT}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -L "${PALPATE_SYSROOT}")
