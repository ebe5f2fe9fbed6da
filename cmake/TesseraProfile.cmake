# SPDX-License-Identifier: Apache-2.0
# Profile-guided optimisation of core with GCC. Results stay bit-identical.
#
#   off      nothing of the kind
#   record   core counts what it does, and writes it to TESSERA_PROFILE_DIR
#   use      a build of its own, in the folder `recording` of this one, records scenes of this repository first
#            (bench/samples/record_profile.sh), again whenever core has changed
set(TESSERA_PROFILE "off" CACHE STRING "Optimise core by a profile: off, record or use")
set_property(CACHE TESSERA_PROFILE PROPERTY STRINGS off record use)
set(TESSERA_PROFILE_DIR "${PROJECT_BINARY_DIR}/profile" CACHE PATH "Where the profile is written, or lies")
if(NOT TESSERA_PROFILE MATCHES "^(off|record|use)$")
  message(FATAL_ERROR "TESSERA_PROFILE is '${TESSERA_PROFILE}': it must be off, record or use")
endif()

set(profile_mode ${TESSERA_PROFILE})
if(NOT profile_mode STREQUAL "off" AND NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  message(STATUS "Building without a profile: that takes GCC")
  set(profile_mode off)
endif()

if(profile_mode STREQUAL "record")
  add_link_options(-fprofile-generate)
elseif(profile_mode STREQUAL "use")
  set(recording ${PROJECT_BINARY_DIR}/recording)
  file(GLOB_RECURSE profiled_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/core/*.cpp ${PROJECT_SOURCE_DIR}/core/*.hpp)
  set(record_profile ${PROJECT_SOURCE_DIR}/bench/samples/record_profile.sh)
  # Files that are compiled as one there must be here, or their profiles are not found.
  add_custom_command(OUTPUT ${recording}/recorded
    COMMAND ${CMAKE_COMMAND} -S ${PROJECT_SOURCE_DIR} -B ${recording} -G ${CMAKE_GENERATOR}
            -DCMAKE_TOOLCHAIN_FILE=${CMAKE_TOOLCHAIN_FILE} "-DCMAKE_PREFIX_PATH=${CMAKE_PREFIX_PATH}"
            -DCMAKE_C_COMPILER=${CMAKE_C_COMPILER} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} -DCMAKE_CXX_FLAGS=${CMAKE_CXX_FLAGS} -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}
            -DCMAKE_UNITY_BUILD=${CMAKE_UNITY_BUILD} -DCMAKE_UNITY_BUILD_BATCH_SIZE=${CMAKE_UNITY_BUILD_BATCH_SIZE}
            -DTESSERA_FARM=OFF -DTESSERA_TESTS=OFF -DTESSERA_PROFILE=record -DTESSERA_PROFILE_DIR=${TESSERA_PROFILE_DIR}
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${TESSERA_PROFILE_DIR}
    COMMAND ${CMAKE_COMMAND} --build ${recording} --target render_samples scene_files
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${TESSERA_PROFILE_DIR}
    COMMAND ${record_profile} ${recording}/bin/render_samples ${recording}/share/tessera/scenes
    COMMAND ${CMAKE_COMMAND} -E touch ${recording}/recorded
    DEPENDS ${profiled_sources} ${record_profile} ${PROJECT_SOURCE_DIR}/bench/samples/render_samples.cpp
    COMMENT "Recording a profile of renders"
    VERBATIM)
  add_custom_target(tessera_recording DEPENDS ${recording}/recorded)
endif()

# Records a library's profile, or uses it, under a name. Code that no recorded render executes is optimised
# as without a profile.
function(tessera_profile target name)
  if(NOT profile_mode STREQUAL "off")
    # The prefix of the profiles' names. Functions are found by it, too.
    target_compile_options(${target} PRIVATE "SHELL:-dumpdir ${name}-" -fprofile-prefix-path=${PROJECT_BINARY_DIR})
  endif()
  if(profile_mode STREQUAL "record")
    target_compile_options(${target} PRIVATE
      -fprofile-generate=${TESSERA_PROFILE_DIR} -fprofile-update=single)
  elseif(profile_mode STREQUAL "use")
    add_dependencies(${target} tessera_recording)
    target_compile_options(${target} PRIVATE
      -fprofile-use=${TESSERA_PROFILE_DIR} -fprofile-correction -fprofile-partial-training
      -Wno-missing-profile -Wno-coverage-mismatch)
  endif()
endfunction()
