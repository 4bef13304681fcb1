# Compiler options shared by every target, and where the binaries land.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  # The sloppiness that ccache asks for where headers are precompiled. Paths
  # count from the project's root, so that a fresh clone finds what another one
  # has compiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    env CCACHE_SLOPPINESS=pch_defines,time_macros
        CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1
        ${CCACHE_PROGRAM})
  add_compile_options(-fpch-preprocess)
endif()

add_compile_options(-Wall -Wextra)
# gcc 12 sees overlaps in std::string's operator+ that are not there (PR105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-Wno-restrict)
endif()
if(TACTUS_WERROR)
  add_compile_options(-Werror)
endif()
# The same input gives the same bits: no contraction that depends on the host.
add_compile_options(-ffp-contract=off)

# Of Highway's kernels for ARM, those for NEON: neither a Jetson nor a Raspberry
# Pi has SVE, and where headers are precompiled, gcc 12 crashes on arm_sve.h.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  add_compile_definitions(
    HWY_DISABLED_TARGETS=\(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128\))
endif()

# A module of Python is a shared library, and so is all that it links; the same
# for libtactus_c, which nothing replaces a function of, and which keeps only
# what it calls.
if(TACTUS_PYTHON OR TACTUS_EMBEDDED)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()
if(TACTUS_EMBEDDED)
  add_compile_options(-fno-semantic-interposition -ffunction-sections
                      -fdata-sections)
endif()

if(TACTUS_SANITIZE STREQUAL "address")
  # Checks of pointers cost a third of the compile time. A null pointer stops the
  # program by itself, AddressSanitizer sees objects that are too small, and the
  # fuzz preset checks the alignment of what is read from wires and files.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all
                      -fno-sanitize=null,alignment,object-size
                      -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
  # For code that is not what we test: generated code, and the tests themselves.
  # UBSan is a third to a half of their compile time.
  set(TACTUS_WITHOUT_UBSAN -fno-sanitize=undefined)
elseif(TACTUS_SANITIZE STREQUAL "thread")
  add_compile_options(-fsanitize=thread)
  add_link_options(-fsanitize=thread)
elseif(TACTUS_SANITIZE)
  message(FATAL_ERROR
    "TACTUS_SANITIZE is '${TACTUS_SANITIZE}'; use address, thread or nothing")
endif()

if(TACTUS_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined
                      -fno-sanitize-recover=all -g1)
  add_link_options(-fsanitize=address,undefined)
endif()
