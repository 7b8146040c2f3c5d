# What can be chosen when dyncal is built, and the compiler settings of all its targets.
include_guard(DIRECTORY)
include(GNUInstallDirs)

cmake_path(SET dyncal_root NORMALIZE ${CMAKE_CURRENT_LIST_DIR}/../..)
string(REGEX REPLACE "/$" "" dyncal_root ${dyncal_root})

option(DYNCAL_FAST_DDS "Build the adapter for Fast DDS" ON)
option(DYNCAL_CYCLONE_DDS "Build the adapter for Cyclone DDS" ON)
option(DYNCAL_MODELS "Build the parametric models, which need Ceres; all programs need them" ON)
option(DYNCAL_BUILD_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(DYNCAL_PRECOMPILED_HEADERS "Compile the headers of libraries once" ${PROJECT_IS_TOP_LEVEL})
option(DYNCAL_JOINED_SOURCES "Compile eight sources as one: quick from nothing, slow after a change"
  OFF)
option(DYNCAL_PYTHON_TESTS "Run the tests that take minutes to get packages of PyPI" OFF)
option(DYNCAL_INSTALL "Install programs and library" ${PROJECT_IS_TOP_LEVEL})
option(DYNCAL_WARNINGS_AS_ERRORS "Stop at the first compiler warning, as the presets do" OFF)
set(DYNCAL_SANITIZE OFF CACHE STRING "Sanitizers: OFF, address (with undefined behaviour), thread")
set_property(CACHE DYNCAL_SANITIZE PROPERTY STRINGS OFF address thread)
if(NOT DYNCAL_SANITIZE MATCHES "^(OFF|address|thread)$")
  message(FATAL_ERROR "DYNCAL_SANITIZE = ${DYNCAL_SANITIZE}: must be OFF, address or thread")
endif()

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
# Asserts stay on in release builds: a wrong number must never be published silently.
set(CMAKE_CXX_FLAGS_RELEASE "-O2")
set(CMAKE_C_FLAGS_RELEASE "-O2")
# The same bits everywhere: no fused or reordered arithmetic unless the code asks for it by name.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off>)

if(PROJECT_IS_TOP_LEVEL)
  include(${CMAKE_CURRENT_LIST_DIR}/Hardening.cmake)
  dyncal_harden()
endif()

find_program(CCACHE ccache)
if(CCACHE AND NOT DEFINED ENV{CCACHE_DISABLE}) # ccache then leaves paths as they are
  # What was compiled in one clone is found in another: ccache makes the paths relative. The other
  # two settings are what it needs for precompiled headers.
  set(CMAKE_C_COMPILER_LAUNCHER env CCACHE_BASEDIR=${dyncal_root}
    CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_C_COMPILER_LAUNCHER})
  add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess>)
  cmake_path(RELATIVE_PATH dyncal_root BASE_DIRECTORY ${CMAKE_BINARY_DIR}
    OUTPUT_VARIABLE dyncal_place)
else()
  set(dyncal_place ${dyncal_root})
endif()
# Asserts name files as this tree does, not where it was built.
add_compile_options(-fmacro-prefix-map=${dyncal_place}/=)
if(DYNCAL_JOINED_SOURCES) # which CMake joins by their whole paths
  add_compile_options(-fmacro-prefix-map=${dyncal_root}/=)
endif()
find_program(MOLD mold)
if(MOLD)
  add_link_options(-fuse-ld=mold)
endif()

if(DYNCAL_SANITIZE)
  set(CMAKE_CXX_FLAGS_RELEASE "-O1") # with -O2 and more, single files take minutes
  set(CMAKE_C_FLAGS_RELEASE "-O1")
  set(sanitizers thread)
  if(DYNCAL_SANITIZE STREQUAL "address")
    set(sanitizers address,undefined)
    add_compile_options(-fno-sanitize-recover=undefined)
    # With the sanitizer Eigen would align memory by itself, but not in the Ceres library, which has
    # the same functions of Eigen in it: memory of one would be freed by the other.
    add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
  endif()
  # GCC itself says that its warning of what may be uninitialized is often wrong with sanitizers:
  # it finds faults in <regex> that are none.
  add_compile_options(-fsanitize=${sanitizers} -fno-omit-frame-pointer -g1
      $<$<COMPILE_LANGUAGE:CXX>:-Wno-maybe-uninitialized>)
  add_link_options(-fsanitize=${sanitizers})
endif()

# Link this into every target of our own (generated code keeps its own warnings): includes are
# written from the top of the project. Libraries that are exported take it as
# $<BUILD_INTERFACE:dyncal_options>.
if(NOT TARGET dyncal_options)
  add_library(dyncal_options INTERFACE)
  target_include_directories(dyncal_options INTERFACE ${dyncal_root})
  target_compile_options(dyncal_options INTERFACE
    -Wall
    -Wextra
    -Wpedantic
    -Wshadow
    -Wnon-virtual-dtor
    -Wold-style-cast
    -Wconversion
    -Wno-sign-conversion
    # GCC 12 reports an overflow in fmt's headers, and an overlap in "text" + std::string, that are
    # not there; where headers are precompiled it takes the latter for reading out of bounds, too.
    -Wno-stringop-overflow
    -Wno-restrict
    "$<$<BOOL:${DYNCAL_PRECOMPILED_HEADERS}>:-Wno-array-bounds;-Wno-stringop-overread>"
    # A source that is joined to others is no header, though GCC takes it for one.
    $<$<AND:$<BOOL:${DYNCAL_JOINED_SOURCES}>,$<CXX_COMPILER_ID:GNU>>:-Wno-subobject-linkage>
    $<$<BOOL:${DYNCAL_WARNINGS_AS_ERRORS}>:-Werror>)
endif()

# dyncal_library(target name): makes a library one that others may link, as dyncal::name, whether
# they add this tree to theirs or find what was installed. Either way they include
# <dyncal/sine.hpp>, <dyncal/analysis/...>, <dyncal/services/...>: in the tree by links to it in the
# build folder.
set(dyncal_include ${CMAKE_BINARY_DIR}/dyncal-include)
if(IS_SYMLINK ${dyncal_include}/dyncal) # of an older build: what is made in it would be in the tree
  file(REMOVE ${dyncal_include}/dyncal)
endif()
file(MAKE_DIRECTORY ${dyncal_include}/dyncal)
foreach(part analysis drivers idl services)
  file(CREATE_LINK ${dyncal_root}/${part} ${dyncal_include}/dyncal/${part} SYMBOLIC)
endforeach()
foreach(door method.hpp sine.hpp)
  file(CREATE_LINK ${dyncal_root}/analysis/${door} ${dyncal_include}/dyncal/${door} SYMBOLIC)
endforeach()
function(dyncal_library target name)
  add_library(dyncal::${name} ALIAS ${target})
  get_target_property(type ${target} TYPE)
  set(scope PUBLIC)
  if(type STREQUAL INTERFACE_LIBRARY)
    set(scope INTERFACE)
  endif()
  target_compile_features(${target} ${scope} cxx_std_20)
  target_include_directories(${target} ${scope}
    $<BUILD_INTERFACE:${dyncal_root}>
    $<BUILD_INTERFACE:${dyncal_include}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  # Shared libraries of others may hold it.
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
endfunction()
