# SPDX-License-Identifier: Apache-2.0
# Every target links tessera::options: warnings, sanitizers, and the flags behind "the same bytes on every machine".
#
# On x86-64, v3 (AVX2) is the minimum. Targets of TesseraVariants.cmake are also compiled for x86-64-v4
# (AVX-512), which has twice the registers, and masks; the compiler's own use of 512-bit vectors does not
# help, only core's explicit use. With TESSERA_PORTABLE, everything is compiled for any processor that the
# compiler compiles for, with vectors by SIMDe (core/math/vector_instructions.hpp). Contraction of a*b+c into
# one rounding is off, so that rendered images do not depend on the compiler. Nothing is compiled for the
# build machine alone.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  set(portable OFF)
else()
  set(portable ON)
endif()
option(TESSERA_PORTABLE "Compile for any processor instead of x86-64-v3" ${portable})

add_library(tessera_options INTERFACE)
add_library(tessera::options ALIAS tessera_options)
target_include_directories(tessera_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(tessera_options INTERFACE
  -ffp-contract=off -fno-math-errno
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wunused -Woverloaded-virtual
  -Wnull-dereference -Wimplicit-fallthrough)
if(NOT TESSERA_PORTABLE)
  # TESSERA_VARIANT: that of core which a target belongs to (TesseraVariants.cmake).
  set(is_avx512 $<STREQUAL:$<TARGET_PROPERTY:TESSERA_VARIANT>,avx512>)
  set(is_portable $<STREQUAL:$<TARGET_PROPERTY:TESSERA_VARIANT>,portable>)
  target_compile_options(tessera_options INTERFACE
    "$<${is_avx512}:-march=x86-64-v4;-mprefer-vector-width=256>"
    $<$<NOT:$<OR:${is_avx512},${is_portable}>>:-march=x86-64-v3>)
  # Nothing of x86 at all, and less optimised: GCC takes long for the many small functions of SIMDe.
  target_compile_options(tessera_options INTERFACE "$<${is_portable}:-DSIMDE_NO_NATIVE;-O1>")
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 reports null dereferences and overlapping copies inside its own inlined library code (bug 105651).
  target_compile_options(tessera_options INTERFACE -Wno-null-dereference -Wno-restrict)
  # And values that are not initialised in its own AVX-512 intrinsics, which leave them so on purpose (bug 105593). What
  # both variants share is still checked in the other.
  target_compile_options(tessera_options INTERFACE
    "$<$<STREQUAL:$<TARGET_PROPERTY:TESSERA_VARIANT>,avx512>:-Wno-uninitialized;-Wno-maybe-uninitialized>")
  # The attributes of __m128i, which are no part of the type, where it is a template argument.
  target_compile_options(tessera_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-ignored-attributes>)
  # GCC collects its garbage from 128 MB on, which takes a twentieth of its time.
  target_compile_options(tessera_options INTERFACE --param=ggc-min-heapsize=524288)
  if(CMAKE_UNITY_BUILD)
    # GCC takes the sources that are compiled as one for headers.
    target_compile_options(tessera_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
  endif()
elseif(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  # Clang 14 takes parameters of friends for shadows of members, and wants braces that aggregates do not need.
  target_compile_options(tessera_options INTERFACE -Wno-shadow -Wno-missing-braces)
  # What core/base/mutex.hpp annotates.
  target_compile_options(tessera_options INTERFACE -Wthread-safety -Werror=thread-safety)
endif()
if(TESSERA_SANITIZE)
  target_compile_options(tessera_options INTERFACE
    -fsanitize=${TESSERA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_compile_definitions(tessera_options INTERFACE TESSERA_SANITIZED)
  target_link_options(tessera_options INTERFACE -fsanitize=${TESSERA_SANITIZE})
endif()
if(TESSERA_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "TESSERA_FUZZ needs Clang: configure with the preset fuzz")
  endif()
  target_compile_options(tessera_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

# Compilation dominates the time of a test run, and test code gains little from optimisation. These options
# come after the build type's own.
set(TESSERA_TEST_FLAGS "-O1" CACHE STRING "Compiler options of the tests")
set(TESSERA_FILE_FLAGS "" CACHE STRING "Compiler options of command lines and of what reads, checks and writes scenes and images in core")
set(TESSERA_FARM_FLAGS "" CACHE STRING "Compiler options of the farm and its tests: all but core and the scheduler, core's tests and simulated farms")

# tessera_library(NAME SOURCES ... LINKS ...): a static library tessera_NAME with the alias tessera::NAME.
function(tessera_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  add_library(tessera_${name} STATIC ${ARG_SOURCES})
  add_library(tessera::${name} ALIAS tessera_${name})
  target_link_libraries(tessera_${name} PUBLIC tessera::options ${ARG_LINKS} PRIVATE ${ARG_PRIVATE_LINKS})
  tessera_precompile(tessera_${name})
endfunction()
