# SPDX-License-Identifier: Apache-2.0
# Run by CPack before it makes packages: gives each Debian package what Debian expects and the tarball does not need.
if(NOT CPACK_GENERATOR STREQUAL "DEB")
  return()
endif()

# place(FILE DESTINATION): copies a file, readable by all. (file(INSTALL) would prepend CPack's DESTDIR.)
function(place file destination)
  cmake_path(GET destination PARENT_PATH folder)
  file(MAKE_DIRECTORY ${folder})
  file(COPY_FILE ${file} ${destination})
  file(CHMOD ${destination} PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
endfunction()

# compress(FILE): replaces it by FILE.gz, with the same bytes for the same contents.
function(compress file)
  execute_process(COMMAND gzip -9 --no-name --force ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)  # of SOURCE_DATE_EPOCH, if that is set
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/${component})
  set(share ${root}${CPACK_PACKAGING_INSTALL_PREFIX}/share)
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(documents ${share}/doc/${package})

  place(${CPACK_TESSERA_DEBIAN_DIR}/copyright ${documents}/copyright)
  file(WRITE ${documents}/changelog
"tessera (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium

  * Release ${CPACK_PACKAGE_VERSION}. CHANGELOG.md of the package tessera lists the changes.

 -- ${CPACK_PACKAGE_CONTACT}  ${now}
")
  compress(${documents}/changelog)
  file(GLOB pages ${share}/man/man1/*.1)
  foreach(page IN LISTS pages)
    compress(${page})
  endforeach()

  set(overrides ${CPACK_TESSERA_DEBIAN_DIR}/${component}.lintian-overrides)
  if(EXISTS ${overrides})
    place(${overrides} ${share}/lintian/overrides/${package})
  endif()

  # The files of options are configuration of the machine, which upgrades leave as it is.
  if(component MATCHES "^tessera-(coordinator|worker)$")
    set(options ${CMAKE_MATCH_1}.conf)
    place(${CPACK_TESSERA_DEBIAN_DIR}/../systemd/${options} ${root}/etc/tessera/${options})
  endif()
endforeach()
