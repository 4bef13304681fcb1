# Kinds of code. Parsing the headers below costs more than compiling most of our
# files, so all code of a kind shares one precompiled header.
#
#   core     standard library, Abseil, Eigen
#   grpc     core's and gRPC
#   program  core's, CLI11 and JSON: reads flags, prints results
#   remote   grpc's, CLI11 and JSON: the same, with a server
#   test     core's and GoogleTest
#   rpctest  grpc's and GoogleTest
#
# A folder names its kind in TACTUS_KIND, and that of its tests in
# TACTUS_TEST_KIND. Every file still includes what it uses: TACTUS_PCH=OFF
# compiles without. Programs and tests call the code that has to be fast: programs
# themselves are compiled with little optimisation, tests with none, which halves
# their compile time. Under a sanitizer nothing but core is optimised.
set(TACTUS_KIND core)
set(TACTUS_TEST_KIND test)
option(TACTUS_PCH "Share precompiled headers" ON)

set(core_headers
  <algorithm> <array> <atomic> <chrono> <cmath> <cstdint> <functional> <map>
  <memory> <optional> <ostream> <span> <string> <string_view> <utility> <vector>
  [["absl/status/status.h"]] [["absl/status/statusor.h"]]
  [["absl/strings/str_cat.h"]] [["absl/strings/str_format.h"]]
  [["absl/strings/string_view.h"]] [["Eigen/Core"]] [["Eigen/Geometry"]])
set(core_libraries absl::status absl::statusor absl::strings absl::str_format
                   Eigen3::Eigen)
set(grpc_headers ${core_headers}
  [["grpcpp/grpcpp.h"]] [["grpcpp/support/async_stream.h"]])
set(grpc_libraries ${core_libraries} gRPC::grpc++)
set(grpc_options $<$<BOOL:${TACTUS_SANITIZE}>:-O0>)
set(program_headers ${core_headers} [["CLI/CLI.hpp"]] [["nlohmann/json.hpp"]])
set(program_libraries ${core_libraries} CLI11::CLI11
                      nlohmann_json::nlohmann_json)
# gcc 12 sees writes past strings at -O1 that are not there.
set(program_options
  $<$<CONFIG:Release>:-O1> $<$<BOOL:${TACTUS_SANITIZE}>:-O0>
  $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>)
set(remote_headers ${grpc_headers} [["CLI/CLI.hpp"]] [["nlohmann/json.hpp"]])
set(remote_libraries ${program_libraries} gRPC::grpc++)
set(remote_options ${program_options})
set(gtest_headers [["gmock/gmock.h"]] [["gtest/gtest.h"]])
set(test_headers ${core_headers} ${gtest_headers})
set(test_libraries ${core_libraries} GTest::gmock GTest::gtest)
# A failed test says its own lines; a sanitizer's report says those of the code.
set(test_options -O0 -Wno-array-bounds ${TACTUS_WITHOUT_UBSAN}
                 $<$<BOOL:${TACTUS_SANITIZE}>:-g0>)
set(rpctest_headers ${grpc_headers} ${gtest_headers})
set(rpctest_libraries ${test_libraries} gRPC::grpc++)
set(rpctest_options ${test_options})

# tactus_code_kind(TARGET KIND): compiles TARGET as code of KIND. The kind's
# headers are compiled when the first target asks for them.
function(tactus_code_kind target kind)
  target_compile_options(${target} PRIVATE ${${kind}_options})
  if(NOT TACTUS_PCH)
    return()
  endif()
  set(shared tactus_pch_${kind})
  if(NOT TARGET ${shared})
    set(source ${CMAKE_BINARY_DIR}/pch/${kind}.cc)
    file(GENERATE OUTPUT ${source} CONTENT "")
    add_library(${shared} OBJECT ${source})
    target_link_libraries(${shared} PRIVATE ${${kind}_libraries})
    target_compile_options(${shared} PRIVATE ${${kind}_options})
    target_precompile_headers(${shared} PRIVATE ${${kind}_headers})
    # Tests are programs, whose code differs from that of shared libraries.
    if(kind MATCHES "test$")
      set_target_properties(${shared} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    endif()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${shared})
endfunction()
