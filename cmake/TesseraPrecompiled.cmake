# SPDX-License-Identifier: Apache-2.0
# With TESSERA_PRECOMPILE, the headers of other libraries are compiled once for all targets that are not optimised: the farm,
# command lines, what reads and writes files, and tests. That is for Clang, which reads of them what a source uses; GCC 12
# reads everything, and gains nothing. Sources still include what they use.
option(TESSERA_PRECOMPILE "Compile the headers of other libraries once (Clang, with TESSERA_*_FLAGS of -O0)" OFF)

# tessera_precompile(TARGET): the target uses those that its folder names in TESSERA_PRECOMPILED, if any:
# tessera_precompiled or, where gRPC is spoken, tessera_precompiled_grpc, whose headers run code at the start of a program.
function(tessera_precompile target)
  if(TESSERA_PRECOMPILE AND TESSERA_PRECOMPILED)
    target_precompile_headers(${target} REUSE_FROM ${TESSERA_PRECOMPILED})
  endif()
endfunction()

if(NOT TESSERA_PRECOMPILE)
  return()
endif()
# Clang wants these in all sources, or in none.
add_compile_options(-fPIC -pthread $<$<COMPILE_LANGUAGE:CXX>:${OpenMP_CXX_FLAGS}>)

# tessera_precompiled_headers(NAME HEADERS ... LIBRARIES ...)
function(tessera_precompiled_headers name)
  cmake_parse_arguments(ARG "" "" "HEADERS;LIBRARIES" ${ARGN})
  set(source ${PROJECT_BINARY_DIR}/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "")
  add_library(${name} OBJECT ${source})
  target_link_libraries(${name} PRIVATE tessera::options ${ARG_LIBRARIES})
  target_compile_options(${name} PRIVATE ${TESSERA_FARM_FLAGS})
  target_precompile_headers(${name} PRIVATE ${ARG_HEADERS})
endfunction()

set(headers <algorithm> <array> <atomic> <charconv> <chrono> <deque> <filesystem> <fstream> <functional> <future> <map>
  <memory> <optional> <random> <regex> <set> <span> <sstream> <string> <string_view> <thread> <tuple> <unordered_map>
  <utility> <variant> <vector> <CLI/CLI.hpp> <fmt/format.h> <fmt/ranges.h> <nlohmann/json.hpp> <tl/expected.hpp>)
set(libraries CLI11::CLI11 fmt::fmt nlohmann_json::nlohmann_json tl::expected)
if(TESSERA_TESTS)
  list(APPEND headers <gmock/gmock.h> <gtest/gtest.h>)
  list(APPEND libraries GTest::gmock GTest::gtest)
endif()
tessera_precompiled_headers(tessera_precompiled HEADERS ${headers} LIBRARIES ${libraries})
if(TESSERA_FARM)
  tessera_precompiled_headers(tessera_precompiled_grpc
    HEADERS ${headers} <absl/synchronization/mutex.h> <google/protobuf/util/time_util.h> <grpcpp/grpcpp.h>
            <spdlog/spdlog.h>
    LIBRARIES ${libraries} absl::synchronization gRPC::grpc++ protobuf::libprotobuf spdlog::spdlog)
endif()
