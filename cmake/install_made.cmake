# Runs in cmake --install. Makes man pages from the help of the programs, shell completions, and units with the paths of
# this prefix, in ALOFT_MADE, and installs them.

file(REMOVE_RECURSE "${ALOFT_MADE}")
file(MAKE_DIRECTORY "${ALOFT_MADE}")

function(make_from_output file)
  execute_process(COMMAND ${ARGN} OUTPUT_FILE "${ALOFT_MADE}/${file}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(share "${CMAKE_INSTALL_PREFIX}/share")
foreach(program ${ALOFT_PROGRAMS})
  make_from_output(${program}.1 "${ALOFT_SOURCE}/tools/man_page.sh" "${ALOFT_BIN}/${program}")
  file(INSTALL "${ALOFT_MADE}/${program}.1" DESTINATION "${share}/man/man1")
endforeach()

# Debian's zsh looks for completions of packages elsewhere than for those of the administrator.
set(zsh_folder zsh/site-functions)
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  set(zsh_folder zsh/vendor-completions)
endif()
make_from_output(aloft "${ALOFT_BIN}/aloft" completions bash)
make_from_output(_aloft "${ALOFT_BIN}/aloft" completions zsh)
make_from_output(aloft.fish "${ALOFT_BIN}/aloft" completions fish)
file(INSTALL "${ALOFT_MADE}/aloft" DESTINATION "${share}/bash-completion/completions")
file(INSTALL "${ALOFT_MADE}/_aloft" DESTINATION "${share}/${zsh_folder}")
file(INSTALL "${ALOFT_MADE}/aloft.fish" DESTINATION "${share}/fish/vendor_completions.d")

get_filename_component(prefix "${CMAKE_INSTALL_PREFIX}" ABSOLUTE)
file(GLOB units "${ALOFT_SOURCE}/deploy/systemd/*.service")
foreach(unit ${units})
  file(READ "${unit}" text)
  string(REPLACE "/usr/" "${prefix}/" text "${text}")
  get_filename_component(name "${unit}" NAME)
  file(WRITE "${ALOFT_MADE}/${name}" "${text}")
  file(INSTALL "${ALOFT_MADE}/${name}" DESTINATION "${CMAKE_INSTALL_PREFIX}/lib/systemd/system")
endforeach()
