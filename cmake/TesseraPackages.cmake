# SPDX-License-Identifier: Apache-2.0
# Packages by CPack: a relocatable tarball (TGZ) and Debian packages (DEB), one for each component:
#
#   tessera              the command line, the example scenes, the documentation
#   tessera-coordinator  the coordinator, its validator and its service
#   tessera-worker       the worker, its scene loader and its service
#   libtessera           the shared library behind them; the package is named after its version, as libtessera0.2
#   libtessera-dev       its header, the CMake package and the pkg-config file
#
# DebianPackage.cmake adds what only Debian packages have.
set(debian_dir ${PROJECT_SOURCE_DIR}/deploy/debian)
set(library_package libtessera${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

set(CPACK_PACKAGE_NAME tessera)
set(CPACK_PACKAGE_VENDOR "The Tessera authors")
set(CPACK_PACKAGE_CONTACT "The Tessera authors <tessera@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_GENERATOR TGZ DEB)
set(CPACK_COMPONENTS_ALL libtessera libtessera-dev tessera)
if(TESSERA_FARM)
  list(APPEND CPACK_COMPONENTS_ALL tessera-coordinator tessera-worker)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_TESSERA_DEBIAN_DIR ${debian_dir})
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/DebianPackage.cmake)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${component})
  if(NOT component STREQUAL "libtessera")
    set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${library_package} (= ${PROJECT_VERSION})")
  endif()
endforeach()

set(CPACK_DEBIAN_LIBTESSERA_PACKAGE_NAME ${library_package})
set(CPACK_DEBIAN_LIBTESSERA_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBTESSERA_PACKAGE_CONTROL_EXTRA ${debian_dir}/triggers)
set(CPACK_DEBIAN_LIBTESSERA-DEV_PACKAGE_SECTION libdevel)
if(TESSERA_FARM)
  # For `tessera demo`.
  set(CPACK_DEBIAN_TESSERA_PACKAGE_RECOMMENDS "tessera-coordinator, tessera-worker")
endif()
set(CPACK_DEBIAN_TESSERA-COORDINATOR_PACKAGE_RECOMMENDS "python3, tessera")

# Services: maintainer scripts, and files of options that belong to the machine.
foreach(service IN ITEMS coordinator worker)
  set(SERVICE tessera-${service})
  set(control ${PROJECT_BINARY_DIR}/package/${SERVICE})
  foreach(script IN ITEMS postinst prerm postrm)
    configure_file(${debian_dir}/service.${script}.in ${control}/${script} @ONLY)
  endforeach()
  file(CONFIGURE OUTPUT ${control}/conffiles CONTENT "/etc/tessera/${service}.conf\n")
  string(TOUPPER ${SERVICE} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA
    ${control}/conffiles ${control}/postinst ${control}/prerm ${control}/postrm)
endforeach()

set(CPACK_COMPONENT_TESSERA_DESCRIPTION "Path tracer with bit-identical results: the command line and example scenes")
set(CPACK_COMPONENT_TESSERA-COORDINATOR_DESCRIPTION "Coordinator of a Tessera render farm")
set(CPACK_COMPONENT_TESSERA-WORKER_DESCRIPTION "Worker of a Tessera render farm")
set(CPACK_COMPONENT_LIBTESSERA_DESCRIPTION "Path-tracing library of Tessera")
set(CPACK_COMPONENT_LIBTESSERA-DEV_DESCRIPTION "Header and CMake package of Tessera's path-tracing library")
include(CPack)
