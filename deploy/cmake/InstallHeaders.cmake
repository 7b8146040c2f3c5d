# Part of `cmake --install`: the public headers, under dyncal/ on the include path of who uses them.
#
# Inside the tree a header is included as "analysis/sine/sine_fit.hpp"; installed it is
# dyncal/analysis/sine/sine_fit.hpp (a door: dyncal/sine.hpp), and its includes are rewritten
# accordingly. Everything of analysis/ is public but what is listed here; of services/ and drivers/
# only the headers listed here and what they include.
#
# root: of the source tree; generated: of what is made from the IDL; made: folder for what is
# installed; includedir: where headers go.
cmake_minimum_required(VERSION 3.25)

set(private
  analysis/response/response_residuals.hpp
  analysis/response/response_weights.hpp
  analysis/sine/equidistant_axis.hpp
  analysis/sine/extended_basis.hpp
  analysis/sine/frequency_search.hpp
  analysis/sine/frequency_series.hpp
  analysis/sine/pass_progress.hpp
  analysis/sine/sine_pass.hpp
  analysis/sine/sine_solve.hpp
)
set(kernel "^analysis/sine/kernel/")
# The interferometer has no door yet, since what it offers may change: of it, what others include.
set(without_door "^analysis/interferometer/")
set(public
  services/bus/bus.hpp
  services/contract/channel_name.hpp
  services/contract/digest.hpp
  services/contract/sample_continuity.hpp
  services/contract/topics.hpp
  services/contract/unit.hpp
)

# By these others come in: <dyncal/sine.hpp>.
set(doors analysis/method.hpp analysis/sine.hpp)

foreach(header IN LISTS private public doors)
  if(NOT EXISTS ${root}/${header})
    message(FATAL_ERROR "InstallHeaders.cmake names ${header}, which does not exist")
  endif()
endforeach()
file(GLOB_RECURSE analysis RELATIVE ${root} ${root}/analysis/*.hpp)
list(FILTER analysis EXCLUDE REGEX "${kernel}|${without_door}")
list(REMOVE_ITEM analysis ${private})
list(APPEND public ${analysis})

set(own_include "#include \"((analysis|drivers|services|idl)/[^\"]+)\"")
set(headers)
while(public)
  list(POP_FRONT public header)
  list(APPEND headers ${header})
  set(tree ${root})
  if(header STREQUAL idl/dyncal.h)
    set(tree ${generated})
  endif()
  file(READ ${tree}/${header} text)
  string(REGEX MATCHALL "${own_include}" includes "${text}")
  foreach(include IN LISTS includes)
    string(REGEX REPLACE "${own_include}" "\\1" included ${include})
    if(included MATCHES ${kernel} OR included IN_LIST private)
      message(FATAL_ERROR "${header} is installed, but includes ${included}, which is private")
    endif()
    if(NOT included IN_LIST headers AND NOT included IN_LIST public)
      list(APPEND public ${included})
    endif()
  endforeach()

  string(REGEX REPLACE "${own_include}" "#include \"dyncal/\\1\"" text "${text}")
  set(installed ${header})
  if(header IN_LIST doors)
    cmake_path(GET header FILENAME installed)
  endif()
  set(copy ${made}/include/dyncal/${installed})
  file(WRITE ${copy}.new "${text}")
  file(COPY_FILE ${copy}.new ${copy} ONLY_IF_DIFFERENT) # keeps its time
  cmake_path(GET installed PARENT_PATH folder)
  file(INSTALL ${copy} DESTINATION ${CMAKE_INSTALL_PREFIX}/${includedir}/dyncal/${folder})
endwhile()
