# SPDX-License-Identifier: Apache-2.0
# core is compiled for every machine and, with TESSERA_AVX512, what renders a second time for those with AVX-512. It
# then is a shared library, lib/libtessera_core.so, the other is lib/glibc-hwcaps/x86-64-v4/libtessera_core.so, and the
# loader takes the one that the processor is good for (ld.so(8)). Both compute the same, to the bit.
option(TESSERA_AVX512 "Compile core a second time, for processors with AVX-512" OFF)
if(TESSERA_AVX512)
  if(TESSERA_PORTABLE)
    message(FATAL_ERROR "TESSERA_AVX512 and TESSERA_PORTABLE exclude each other")
  endif()
  set(CMAKE_BUILD_RPATH "$ORIGIN/../lib")  # bin/ and lib/ may be moved together
endif()

# tessera_core_library(NAME [ONCE] SOURCES ... LINKS ...): a tessera_library() of core, and with TESSERA_AVX512 another,
# tessera_NAME_avx512, which links the others of its kind. ONCE: both variants of core have the same objects, of code
# that reads or writes files and gains nothing from AVX-512. It may not use vectors, whose inline functions differ between
# the variants (tests/variants/no_vectors.sh).
function(tessera_core_library name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "ONCE" "" "")
  set(library_arguments ${ARG_UNPARSED_ARGUMENTS})
  tessera_library(${name} ${library_arguments})
  get_property(earlier GLOBAL PROPERTY TESSERA_CORE_LIBRARIES)
  set_property(GLOBAL APPEND PROPERTY TESSERA_CORE_LIBRARIES ${name})
  set(variants tessera_${name})
  if(TESSERA_AVX512 AND NOT ARG_ONCE)
    foreach(library IN LISTS earlier)
      if(TARGET tessera_${library}_avx512)
        list(TRANSFORM library_arguments REPLACE "^tessera::${library}$" "tessera::${library}_avx512")
      endif()
    endforeach()
    tessera_library(${name}_avx512 ${library_arguments})
    set_target_properties(tessera_${name}_avx512 PROPERTIES TESSERA_AVX512 ON)
    list(APPEND variants tessera_${name}_avx512)
  endif()
  foreach(variant IN LISTS variants)
    set_target_properties(${variant} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_compile_options(${variant} PRIVATE -fno-semantic-interposition)
    tessera_profile(${variant} ${name})
  endforeach()
endfunction()

# tessera_core(LINKS ...): tessera::core, of all core libraries so far; what else these need is in LINKS.
function(tessera_core)
  cmake_parse_arguments(ARG "" "" "LINKS" ${ARGN})
  get_property(libraries GLOBAL PROPERTY TESSERA_CORE_LIBRARIES)
  if(NOT TESSERA_AVX512)
    add_library(tessera_core INTERFACE)
    list(TRANSFORM libraries PREPEND tessera::)
    target_link_libraries(tessera_core INTERFACE ${libraries})
  else()
    foreach(library IN LISTS libraries)
      list(APPEND objects $<TARGET_OBJECTS:tessera_${library}>)
      if(TARGET tessera_${library}_avx512)
        list(APPEND objects_avx512 $<TARGET_OBJECTS:tessera_${library}_avx512>)
      else()
        list(APPEND objects_of_both $<TARGET_OBJECTS:tessera_${library}>)
      endif()
    endforeach()
    # The linker takes the first of equal inline functions: those of AVX-512.
    list(APPEND objects_avx512 ${objects_of_both})
    set_property(GLOBAL PROPERTY TESSERA_OBJECTS_OF_BOTH ${objects_of_both})
    foreach(variant IN ITEMS "" _avx512)
      add_library(tessera_core${variant} SHARED $<TARGET_OBJECTS:tessera_cpu_check> ${objects${variant}})
      target_link_libraries(tessera_core${variant} PUBLIC $<BUILD_INTERFACE:tessera::base> PRIVATE ${ARG_LINKS})
      # Each library binds to its own functions, whatever else is loaded.
      target_link_options(tessera_core${variant} PRIVATE -Wl,-Bsymbolic -Wl,-z,defs)
      set_target_properties(tessera_core${variant} PROPERTIES OUTPUT_NAME tessera_core
        LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
    endforeach()
    set_target_properties(tessera_core_avx512 PROPERTIES
      LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib/glibc-hwcaps/x86-64-v4)
    add_dependencies(tessera_core tessera_core_avx512)
  endif()
  add_library(tessera::core ALIAS tessera_core)
endfunction()
