# The version that results carry: project version and, in a checkout, the commit.
set(DYNCAL_COMMIT "")
find_package(Git QUIET)
if(GIT_FOUND AND EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/.git)
  execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --dirty WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}
                  OUTPUT_VARIABLE DYNCAL_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
set(DYNCAL_SOFTWARE "dyncal ${PROJECT_VERSION}")
if(DYNCAL_COMMIT)
  string(APPEND DYNCAL_SOFTWARE " (${DYNCAL_COMMIT})")
endif()
