# SPDX-License-Identifier: Apache-2.0
# `cmake --install`, by the components of which TesseraPackages.cmake makes packages. Programs find libraries and scenes by
# relative paths, so the installed tree is relocatable.
include(CMakePackageConfigHelpers)

set(private_libdir ${CMAKE_INSTALL_LIBDIR}/tessera)  # libtessera_core: for these programs alone
set_target_properties(tessera_api PROPERTIES INSTALL_RPATH "$ORIGIN/tessera")
install(TARGETS tessera_api EXPORT tessera_targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libtessera NAMELINK_COMPONENT libtessera-dev)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/core/api/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT libtessera-dev)
if(TESSERA_VARIANTS)
  # Exported too: libtessera needs it, and a consumer's linker follows the dependency.
  install(TARGETS tessera_core EXPORT tessera_targets LIBRARY DESTINATION ${private_libdir} COMPONENT libtessera)
endif()
if(TESSERA_AVX512)
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
  foreach(service IN ITEMS coordinator worker)
    install(FILES ${PROJECT_SOURCE_DIR}/deploy/systemd/tessera-${service}.service
      DESTINATION lib/systemd/system COMPONENT tessera-${service})
    file(GLOB drop_ins ${PROJECT_SOURCE_DIR}/deploy/systemd/${service}*.conf)
    install(FILES ${drop_ins} DESTINATION ${CMAKE_INSTALL_DATADIR}/tessera/systemd COMPONENT tessera-${service})
  endforeach()
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
