# SPDX-License-Identifier: Apache-2.0
# Manual pages and completions of the programs, printed by the programs themselves from their tables of options, so that
# they always match. They lie in the build folder as they are installed.

# tessera_manual_page(TARGET COMPONENT)
function(tessera_manual_page program component)
  set(folder ${PROJECT_BINARY_DIR}/share/man/man1)
  set(page ${folder}/${program}.1)
  file(MAKE_DIRECTORY ${folder})
  add_custom_command(TARGET ${program} POST_BUILD
    COMMAND ${program} --print-man-page > ${page}
    BYPRODUCTS ${page}
    VERBATIM)
  if(TESSERA_INSTALL)
    install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
  endif()
endfunction()

# tessera_generated_pages(TARGET COMPONENT): the manual page, and completions for shells.
function(tessera_generated_pages program component)
  tessera_manual_page(${program} ${component})
  set(share ${PROJECT_BINARY_DIR}/share)
  set(bash ${share}/bash-completion/completions/${program})
  set(zsh ${share}/zsh/site-functions/_${program})
  set(fish ${share}/fish/vendor_completions.d/${program}.fish)
  foreach(file IN ITEMS ${bash} ${zsh} ${fish})
    cmake_path(GET file PARENT_PATH folder)
    file(MAKE_DIRECTORY ${folder})
  endforeach()
  add_custom_command(TARGET ${program} POST_BUILD
    COMMAND ${program} --print-completion bash > ${bash}
    COMMAND ${program} --print-completion zsh > ${zsh}
    COMMAND ${program} --print-completion fish > ${fish}
    BYPRODUCTS ${bash} ${zsh} ${fish}
    VERBATIM)
  if(NOT TESSERA_INSTALL)
    return()
  endif()
  install(FILES ${bash} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT ${component})
  install(FILES ${zsh} DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT ${component})
  install(FILES ${fish} DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT ${component})
endfunction()
