# Manual pages and completion for shells, made by the programs themselves from the description that
# their --help has as well: `all` makes them below build/described, `cmake --install` brings them to
# where man, bash, zsh and fish look. Pages of subcommands are made with that of their program.
set(described ${CMAKE_BINARY_DIR}/described)
set(described_files "")
foreach(program dyncal dyncal-acs dyncal-analysis dyncal-can dyncal-dau dyncal-dso dyncal-guard
                dyncal-recorder dyncal-virtual-bench)
  set(pages ${described}/man/${program})
  set(files ${described}/${program}.stamp ${pages}/${program}.1 ${described}/bash/${program}
    ${described}/zsh/_${program} ${described}/fish/${program}.fish)
  add_custom_command(OUTPUT ${files}
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${pages}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${described}/bash ${described}/zsh ${described}/fish
    COMMAND ${program} --write-man ${pages}
    COMMAND ${program} --print-completion bash > ${described}/bash/${program}
    COMMAND ${program} --print-completion zsh > ${described}/zsh/_${program}
    COMMAND ${program} --print-completion fish > ${described}/fish/${program}.fish
    COMMAND ${CMAKE_COMMAND} -E touch ${described}/${program}.stamp
    DEPENDS ${program}
    COMMENT "Writing manual pages and completion of ${program}"
    VERBATIM)
  list(APPEND described_files ${files})
  install(DIRECTORY ${pages}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
endforeach()
add_custom_target(dyncal_described ALL DEPENDS ${described_files})

install(DIRECTORY ${described}/bash/
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT programs)
install(DIRECTORY ${described}/zsh/
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT programs)
install(DIRECTORY ${described}/fish/
  DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT programs)
