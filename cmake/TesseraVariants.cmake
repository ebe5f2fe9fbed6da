# SPDX-License-Identifier: Apache-2.0
# core is compiled for every machine and, as a variant, what renders once more:
# - with TESSERA_AVX512 for processors with AVX-512. The loader takes the one that the processor is good for (ld.so(8)):
#   lib/libtessera_core.so or lib/glibc-hwcaps/x86-64-v4/libtessera_core.so;
# - with TESSERA_PORTABLE_VARIANT as with TESSERA_PORTABLE, for tests, which name lib/portable in LD_LIBRARY_PATH.
# With a variant, core is a shared library. All compute the same, to the bit.
option(TESSERA_AVX512 "Compile core a second time, for processors with AVX-512" OFF)
option(TESSERA_PORTABLE_VARIANT "Compile core once more for any processor, for the tests that compare it" OFF)
set(TESSERA_VARIANTS "")
if(TESSERA_AVX512)
  list(APPEND TESSERA_VARIANTS avx512)
endif()
if(TESSERA_PORTABLE_VARIANT)
  list(APPEND TESSERA_VARIANTS portable)
endif()
if(TESSERA_VARIANTS)
  if(TESSERA_PORTABLE)
    message(FATAL_ERROR "TESSERA_PORTABLE excludes TESSERA_AVX512 and TESSERA_PORTABLE_VARIANT")
  endif()
  set(CMAKE_BUILD_RPATH "$ORIGIN/../lib")  # bin/ and lib/ may be moved together
endif()

# tessera_core_library(NAME [ONCE] SOURCES ... LINKS ...): a tessera_library() of core, and for each variant of core
# another, tessera_NAME_VARIANT, which links the others of its kind. ONCE: all variants of core have the same objects, of
# code that reads or writes files and gains nothing from AVX-512. It may not use vectors, whose inline functions differ
# between the variants (tests/variants/no_vectors.sh).
function(tessera_core_library name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "ONCE" "" "")
  tessera_library(${name} ${ARG_UNPARSED_ARGUMENTS})
  get_property(earlier GLOBAL PROPERTY TESSERA_CORE_LIBRARIES)
  set_property(GLOBAL APPEND PROPERTY TESSERA_CORE_LIBRARIES ${name})
  set(targets tessera_${name})
  if(NOT ARG_ONCE)
    foreach(variant IN LISTS TESSERA_VARIANTS)
      set(library_arguments ${ARG_UNPARSED_ARGUMENTS})
      foreach(library IN LISTS earlier)
        if(TARGET tessera_${library}_${variant})
          list(TRANSFORM library_arguments REPLACE "^tessera::${library}$" "tessera::${library}_${variant}")
        endif()
      endforeach()
      tessera_library(${name}_${variant} ${library_arguments})
      set_target_properties(tessera_${name}_${variant} PROPERTIES TESSERA_VARIANT ${variant})
      list(APPEND targets tessera_${name}_${variant})
    endforeach()
  endif()
  foreach(target IN LISTS targets)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_compile_options(${target} PRIVATE -fno-semantic-interposition)
    tessera_profile(${target} ${name})
  endforeach()
endfunction()

# tessera_core(LINKS ...): tessera::core, of all core libraries so far; what else these need is in LINKS.
function(tessera_core)
  cmake_parse_arguments(ARG "" "" "LINKS" ${ARGN})
  get_property(libraries GLOBAL PROPERTY TESSERA_CORE_LIBRARIES)
  if(NOT TESSERA_VARIANTS)
    add_library(tessera_core INTERFACE)
    list(TRANSFORM libraries PREPEND tessera::)
    target_link_libraries(tessera_core INTERFACE ${libraries})
  else()
    tessera_core_variant(tessera_core "" ${PROJECT_BINARY_DIR}/lib)
    if(TESSERA_AVX512)
      tessera_core_variant(tessera_core_avx512 _avx512 ${PROJECT_BINARY_DIR}/lib/glibc-hwcaps/x86-64-v4)
      add_dependencies(tessera_core tessera_core_avx512)
    endif()
    if(TESSERA_PORTABLE_VARIANT)
      tessera_core_variant(tessera_core_portable _portable ${PROJECT_BINARY_DIR}/lib/portable)
    endif()
  endif()
  add_library(tessera::core ALIAS tessera_core)
endfunction()

# Part of tessera_core(): the shared library TARGET of the core libraries with this suffix, and of those that all share.
function(tessera_core_variant target suffix folder)
  foreach(library IN LISTS libraries)
    if(TARGET tessera_${library}${suffix})
      list(APPEND objects $<TARGET_OBJECTS:tessera_${library}${suffix}>)
    else()
      list(APPEND objects_of_all $<TARGET_OBJECTS:tessera_${library}>)
    endif()
  endforeach()
  # The linker takes the first of equal inline functions: those of the variant.
  add_library(${target} SHARED $<TARGET_OBJECTS:tessera_cpu_check> ${objects} ${objects_of_all})
  target_link_libraries(${target} PUBLIC $<BUILD_INTERFACE:tessera::base> PRIVATE ${ARG_LINKS})
  # Each library binds to its own functions, whatever else is loaded.
  target_link_options(${target} PRIVATE -Wl,-Bsymbolic -Wl,-z,defs)
  set_target_properties(${target} PROPERTIES OUTPUT_NAME tessera_core LIBRARY_OUTPUT_DIRECTORY ${folder})
  if(objects_of_all)
    set_property(GLOBAL PROPERTY TESSERA_OBJECTS_OF_ALL ${objects_of_all})
  endif()
endfunction()
