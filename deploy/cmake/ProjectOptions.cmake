# What can be chosen when dyncal is built, and the compiler settings of all its targets.
option(DYNCAL_FAST_DDS "Build the adapter for Fast DDS" ON)
option(DYNCAL_CYCLONE_DDS "Build the adapter for Cyclone DDS" ON)
option(DYNCAL_BUILD_TESTS "Build the tests" ON)
option(DYNCAL_SANITIZE "Build with address and undefined-behaviour sanitizers" OFF)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
# Asserts stay on in release builds: a wrong number must never be published silently.
set(CMAKE_CXX_FLAGS_RELEASE "-O2")
set(CMAKE_C_FLAGS_RELEASE "-O2")
# The same bits everywhere: no fused or reordered arithmetic unless the code asks for it by name.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off>)

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()
find_program(MOLD mold)
if(MOLD)
  add_link_options(-fuse-ld=mold)
endif()

if(DYNCAL_SANITIZE)
  set(CMAKE_CXX_FLAGS_RELEASE "-O1") # with -O2 and more, single files take minutes
  set(CMAKE_C_FLAGS_RELEASE "-O1")
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=address,undefined)
endif()

# Link this into every target of our own (generated code keeps its own warnings): includes are written from the top of the project.
add_library(dyncal_options INTERFACE)
target_include_directories(dyncal_options INTERFACE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_options(dyncal_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wconversion
                                               -Wno-sign-conversion -Werror)
# GCC 12 sees an overflow in fmt's headers, and an overlap in "text" + std::string, that are not there.
target_compile_options(dyncal_options INTERFACE -Wno-stringop-overflow -Wno-restrict)
