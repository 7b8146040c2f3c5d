# Part of `cmake --install`: the units of systemd, which start the programs where they are now.
#
# root: of the source tree; made: folder for what is installed; bindir: of the programs.
cmake_minimum_required(VERSION 3.25)

cmake_path(ABSOLUTE_PATH bindir BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} NORMALIZE)
file(GLOB templates ${root}/deploy/systemd/*.service.in)
# The bridge is a Python program: deploy/python/install.sh brings it and its unit.
list(FILTER templates EXCLUDE REGEX "dyncal-bridge")
foreach(template IN LISTS templates)
  cmake_path(GET template STEM LAST_ONLY unit)
  configure_file(${template} ${made}/systemd/${unit} @ONLY)
  file(INSTALL ${made}/systemd/${unit} DESTINATION ${CMAKE_INSTALL_PREFIX}/lib/systemd/system)
endforeach()
