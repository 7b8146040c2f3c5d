# Headers of the standard library and of GoogleTest, which most sources include, are compiled once
# and not again in each source: that saves a quarter of a full build's time.
#
# Only headers that never change with this tree are among them, so that no change of ours rebuilds
# what does not include it. Every source still includes what it uses: Style.Tidy reads it without.
# DYNCAL_PRECOMPILED_HEADERS=OFF builds without.
include_guard(DIRECTORY)

set(dyncal_standard_headers
  <algorithm>
  <array>
  <chrono>
  <cmath>
  <complex>
  <cstddef>
  <cstdint>
  <deque>
  <filesystem>
  <functional>
  <map>
  <memory>
  <mutex>
  <numbers>
  <optional>
  <set>
  <span>
  <string>
  <string_view>
  <thread>
  <utility>
  <variant>
  <vector>)

# A set of headers can only be shared by targets that are compiled alike: that link OPTIONS.
function(dyncal_header_set name)
  cmake_parse_arguments(SET "" "OPTIONS" "HEADERS" ${ARGN})
  file(CONFIGURE OUTPUT ${name}.cpp CONTENT "// The headers alone.\n")
  add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE ${SET_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${SET_HEADERS})
endfunction()

function(dyncal_targets_below directory result)
  get_property(targets DIRECTORY ${directory} PROPERTY BUILDSYSTEM_TARGETS)
  get_property(folders DIRECTORY ${directory} PROPERTY SUBDIRECTORIES)
  foreach(folder IN LISTS folders)
    dyncal_targets_below(${folder} more)
    list(APPEND targets ${more})
  endforeach()
  set(${result} ${targets} PARENT_SCOPE)
endfunction()

# Which set is for the target: none for generated code, for a target with headers of its own, and
# where other flags would not let it be used.
function(dyncal_header_set_of target result)
  set(${result} "" PARENT_SCOPE)
  get_target_property(type ${target} TYPE)
  if(NOT type MATCHES "^(STATIC_LIBRARY|OBJECT_LIBRARY|EXECUTABLE)$")
    return()
  endif()
  get_target_property(own_headers ${target} PRECOMPILE_HEADERS)
  get_target_property(own_options ${target} COMPILE_OPTIONS)
  get_target_property(libraries ${target} LINK_LIBRARIES)
  if(own_headers OR own_options MATCHES "-O"
     OR NOT libraries MATCHES "dyncal_options|dyncal_test_options")
    return()
  endif()
  get_target_property(position_independent ${target} POSITION_INDEPENDENT_CODE)
  if(position_independent)
    set(${result} dyncal_library_headers PARENT_SCOPE)
  elseif(libraries MATCHES "dyncal_test_options")
    set(${result} dyncal_test_headers PARENT_SCOPE)
  else()
    set(${result} dyncal_program_headers PARENT_SCOPE)
  endif()
endfunction()

# After all targets of the tree have been added.
function(dyncal_precompile_headers)
  dyncal_targets_below(${CMAKE_CURRENT_SOURCE_DIR} targets)
  foreach(name IN ITEMS dyncal_program_headers dyncal_library_headers)
    dyncal_header_set(${name} HEADERS ${dyncal_standard_headers} OPTIONS dyncal_options)
  endforeach()
  set_target_properties(dyncal_library_headers PROPERTIES POSITION_INDEPENDENT_CODE ON)
  foreach(target IN LISTS targets)
    dyncal_header_set_of(${target} headers)
    if(headers)
      target_precompile_headers(${target} REUSE_FROM ${headers})
    endif()
  endforeach()
endfunction()
