# SPDX-License-Identifier: Apache-2.0
# `cmake --install`, and packages by CPack: a relocatable tarball (TGZ) and Debian packages (DEB), one for each component:
#
#   tessera              the command line, the example scenes, the documentation
#   tessera-coordinator  the coordinator and its validator
#   tessera-worker       the worker and its scene loader
#   libtessera           the shared library behind them
#   libtessera-dev       its header, the CMake package and the pkg-config file
#
# Programs find libraries and scenes by relative paths, so the installed tree is relocatable.
include(CMakePackageConfigHelpers)

set(private_libdir ${CMAKE_INSTALL_LIBDIR}/tessera)  # libtessera_core: for these programs alone
set_target_properties(tessera_api PROPERTIES INSTALL_RPATH "$ORIGIN/tessera")
install(TARGETS tessera_api EXPORT tessera_targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libtessera NAMELINK_COMPONENT libtessera-dev)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/core/api/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT libtessera-dev)
if(TESSERA_AVX512)
  # Exported too: libtessera needs it, and a consumer's linker follows the dependency.
  install(TARGETS tessera_core EXPORT tessera_targets LIBRARY DESTINATION ${private_libdir} COMPONENT libtessera)
  install(TARGETS tessera_core_avx512 LIBRARY DESTINATION ${private_libdir}/glibc-hwcaps/x86-64-v4 COMPONENT libtessera)
endif()

# tessera_install_program(TARGET COMPONENT)
function(tessera_install_program target component)
  file(RELATIVE_PATH to_libdir ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_PREFIX}/${private_libdir})
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN/${to_libdir}")
  install(TARGETS ${target} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${component})
endfunction()
tessera_install_program(tessera tessera)
if(TESSERA_FARM)
  tessera_install_program(tessera-coordinator tessera-coordinator)
  tessera_install_program(tessera-validator tessera-coordinator)
  tessera_install_program(tessera-worker tessera-worker)
  tessera_install_program(tessera-scene-loader tessera-worker)
  install(FILES ${PROJECT_SOURCE_DIR}/deploy/prometheus/tessera.rules.yml
    DESTINATION ${CMAKE_INSTALL_DATADIR}/tessera COMPONENT tessera-coordinator)
  install(PROGRAMS ${PROJECT_SOURCE_DIR}/deploy/make_certificates.sh
    DESTINATION ${CMAKE_INSTALL_DATADIR}/tessera COMPONENT tessera-coordinator)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/deploy/slurm DESTINATION ${CMAKE_INSTALL_DATADIR}/tessera
    USE_SOURCE_PERMISSIONS COMPONENT tessera-coordinator)
endif()

install(DIRECTORY ${TESSERA_SCENES_DIR}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/tessera/scenes COMPONENT tessera)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/LICENSE
  DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tessera)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tessera)

# find_package(tessera), and pkg-config.
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tessera)
install(EXPORT tessera_targets NAMESPACE tessera:: DESTINATION ${config_dir} COMPONENT libtessera-dev)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/tessera-config.cmake.in
  ${PROJECT_BINARY_DIR}/package/tessera-config.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/tessera-config-version.cmake
  COMPATIBILITY SameMinorVersion)
configure_file(${CMAKE_CURRENT_LIST_DIR}/tessera.pc.in ${PROJECT_BINARY_DIR}/package/tessera.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/package/tessera-config.cmake ${PROJECT_BINARY_DIR}/package/tessera-config-version.cmake
  DESTINATION ${config_dir} COMPONENT libtessera-dev)
install(FILES ${PROJECT_BINARY_DIR}/package/tessera.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
  COMPONENT libtessera-dev)

set(CPACK_PACKAGE_NAME tessera)
set(CPACK_PACKAGE_VENDOR "The Tessera authors")
set(CPACK_PACKAGE_CONTACT "The Tessera authors <tessera@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_GENERATOR TGZ DEB)
set(CPACK_COMPONENTS_ALL libtessera libtessera-dev tessera)
if(TESSERA_FARM)
  list(APPEND CPACK_COMPONENTS_ALL tessera-coordinator tessera-worker)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(this_version "(= ${PROJECT_VERSION})")
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${component})
  if(NOT component STREQUAL "libtessera")
    set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "libtessera ${this_version}")
  endif()
endforeach()
set(CPACK_COMPONENT_TESSERA_DESCRIPTION "Path tracer with bit-identical results: the command line and example scenes")
set(CPACK_COMPONENT_TESSERA-COORDINATOR_DESCRIPTION "Coordinator of a Tessera render farm")
set(CPACK_COMPONENT_TESSERA-WORKER_DESCRIPTION "Worker of a Tessera render farm")
set(CPACK_COMPONENT_LIBTESSERA_DESCRIPTION "Path-tracing library of Tessera")
set(CPACK_COMPONENT_LIBTESSERA-DEV_DESCRIPTION "Header and CMake package of Tessera's path-tracing library")
include(CPack)
