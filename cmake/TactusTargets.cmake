# Helpers that keep the per-folder CMakeLists.txt to a few lines.

# The files of a library or a test are compiled together, several at once, which
# halves a first build. So names in unnamed namespaces differ within a library.
# OFF compiles each file alone: a change then compiles one file again.
option(TACTUS_UNITY "Compile the files of a target together" ON)

# tactus_unity(TARGET COUNT): compiles COUNT files of TARGET together.
function(tactus_unity target count)
  set_target_properties(${target} PROPERTIES
    UNITY_BUILD ${TACTUS_UNITY} UNITY_BUILD_BATCH_SIZE ${count})
  # Classes may have members of unnamed namespaces' types, each in its file.
  target_compile_options(${target} PRIVATE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# tactus_library(NAME SOURCES a.cc ... [APART b.cc ...] DEPS target ...)
# APART: sources that are compiled alone, such as those that Highway includes
# once for each instruction set.
function(tactus_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;APART;DEPS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES} ${ARG_APART})
  if(ARG_APART)
    set_source_files_properties(${ARG_APART}
      PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
  tactus_unity(${name} 20)
  target_include_directories(${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  target_link_libraries(${name} PUBLIC ${ARG_DEPS})
  tactus_code_kind(${name} ${TACTUS_KIND})
endfunction()

# tactus_binary(NAME SOURCES a.cc ... DEPS target ...): lands in bin/.
function(tactus_binary name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_DEPS})
  tactus_code_kind(${name} ${TACTUS_KIND})
endfunction()

# tactus_test(NAME SOURCES a_test.cc ... DEPS target ... [LABELS long]
#             [LAUNCHER program]):
# a GoogleTest binary, registered as one CTest test, which `program` starts.
function(tactus_test name)
  cmake_parse_arguments(ARG "" "LAUNCHER;TIMEOUT" "SOURCES;DEPS;LABELS"
                        ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_DEPS} GTest::gmock
                                        GTest::gtest_main)
  tactus_code_kind(${name} ${TACTUS_TEST_KIND})
  # It replaces operator new, which gcc must not see beside code that calls it.
  set_source_files_properties(
    ${PROJECT_SOURCE_DIR}/tests/support/allocation_counter.cc
    PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  tactus_unity(${name} 20)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF
    RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  if(ARG_LAUNCHER)
    add_test(NAME ${name} COMMAND ${ARG_LAUNCHER} $<TARGET_FILE:${name}>)
  else()
    # CMake adds the emulator of a foreign processor.
    add_test(NAME ${name} COMMAND ${name})
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
    # An emulator takes ten times as long.
    if(CMAKE_CROSSCOMPILING)
      set(ARG_TIMEOUT 3000)
    endif()
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT}
    ENVIRONMENT "TACTUS_SOURCE_DIR=${PROJECT_SOURCE_DIR}")
  if(ARG_LABELS)
    set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}")
  endif()
endfunction()
