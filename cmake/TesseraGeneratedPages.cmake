# SPDX-License-Identifier: Apache-2.0
# Manual pages and completions of the programs, printed by the programs themselves from their tables of options, so that
# they always match. They lie in the build folder as they are installed.

# tessera_generated_pages(TARGET COMPONENT)
function(tessera_generated_pages program component)
  set(share ${PROJECT_BINARY_DIR}/share)
  set(man ${share}/man/man1/${program}.1)
  set(bash ${share}/bash-completion/completions/${program})
  set(zsh ${share}/zsh/site-functions/_${program})
  set(fish ${share}/fish/vendor_completions.d/${program}.fish)
  foreach(file IN ITEMS ${man} ${bash} ${zsh} ${fish})
    cmake_path(GET file PARENT_PATH folder)
    file(MAKE_DIRECTORY ${folder})
  endforeach()
  add_custom_command(TARGET ${program} POST_BUILD
    COMMAND ${program} --print-man-page > ${man}
    COMMAND ${program} --print-completion bash > ${bash}
    COMMAND ${program} --print-completion zsh > ${zsh}
    COMMAND ${program} --print-completion fish > ${fish}
    BYPRODUCTS ${man} ${bash} ${zsh} ${fish}
    VERBATIM)
  if(NOT TESSERA_INSTALL)
    return()
  endif()
  install(FILES ${man} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
  install(FILES ${bash} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT ${component})
  install(FILES ${zsh} DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT ${component})
  install(FILES ${fish} DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT ${component})
endfunction()
