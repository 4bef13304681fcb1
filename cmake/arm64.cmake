# Compiles for 64-bit ARM on another processor: Debian's cross compiler, the
# libraries of a root of Debian for arm64, and QEMU for what is run meanwhile.
#
#   cmake --preset embedded -B build/arm64 \
#     --toolchain cmake/arm64.cmake -D TACTUS_ARM64_ROOT=build/arm64-root
#
# deploy/arm64.sh makes the root and does all of this.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)

# CMake reads this file again for each of its trials.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES TACTUS_ARM64_ROOT)
get_filename_component(CMAKE_SYSROOT "${TACTUS_ARM64_ROOT}" ABSOLUTE
  BASE_DIR ${CMAKE_CURRENT_LIST_DIR}/..)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -L ${CMAKE_SYSROOT})
