# Manual pages, which help2man makes of each command's --help, and completion for shells, which the
# programs themselves make of the same description: `all` makes them below build/described,
# `cmake --install` brings them to where man, bash, zsh and fish look.
find_program(HELP2MAN help2man)
if(NOT HELP2MAN)
  message(STATUS "help2man is not there: no manual pages are made (Debian: help2man)")
endif()
set(write_man_pages ${CMAKE_CURRENT_LIST_DIR}/write-man-pages.sh)
set(described ${CMAKE_BINARY_DIR}/described)
set(described_files "")
set(programs dyncal dyncal-acs dyncal-analysis dyncal-can dyncal-dau dyncal-dso dyncal-guard
  dyncal-recorder dyncal-virtual-bench)
if(TARGET dyncal-web)
  list(APPEND programs dyncal-web)
endif()
foreach(program IN LISTS programs)
  set(pages ${described}/man/${program})
  set(files ${described}/bash/${program} ${described}/zsh/_${program}
    ${described}/fish/${program}.fish)
  add_custom_command(OUTPUT ${files}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${described}/bash ${described}/zsh ${described}/fish
    COMMAND ${program} --print-completion bash > ${described}/bash/${program}
    COMMAND ${program} --print-completion zsh > ${described}/zsh/_${program}
    COMMAND ${program} --print-completion fish > ${described}/fish/${program}.fish
    DEPENDS ${program}
    COMMENT "Writing completion of ${program}"
    VERBATIM)
  list(APPEND described_files ${files})
  if(HELP2MAN)
    add_custom_command(OUTPUT ${pages}/${program}.1
      COMMAND ${write_man_pages} $<TARGET_FILE:${program}> ${pages}
      DEPENDS ${program} ${write_man_pages}
      COMMENT "Writing manual pages of ${program}"
      VERBATIM)
    list(APPEND described_files ${pages}/${program}.1)
    install(DIRECTORY ${pages}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
  endif()
endforeach()
add_custom_target(dyncal_described ALL DEPENDS ${described_files})

install(DIRECTORY ${described}/bash/
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT programs)
install(DIRECTORY ${described}/zsh/
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT programs)
install(DIRECTORY ${described}/fish/
  DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT programs)
