# Fuzzers need Clang; everything else stays with the compiler of the build.
include_guard(GLOBAL)

find_program(DYNCAL_FUZZ_CXX NAMES clang++-14 clang++ DOC "Clang for the fuzzers")
set(DYNCAL_FUZZ_SECONDS 20 CACHE STRING "How long each fuzzer runs in ctest")

# dyncal_fuzzer(name TEST what_holds SOURCES a.cpp ...): a program of libFuzzer with the address and
# undefined-behaviour sanitizers, and its test.
#
#   OPTIONS     of the compiler
#   LIBRARIES   of the linker
#   SEEDS       folder with files to begin with
#   CORPUS      program that writes such a folder, given its name
#   BUILT       target that has to be built before
#   MAX_LENGTH  of what is tried, in bytes; 8192 where nothing is said
#   MAX_ALLOCATION_MB  of one allocation; 1024 where nothing is said
function(dyncal_fuzzer name)
  cmake_parse_arguments(FUZZ "" "TEST;SEEDS;CORPUS;BUILT;MAX_LENGTH;MAX_ALLOCATION_MB"
    "SOURCES;OPTIONS;LIBRARIES" ${ARGN})
  set(work ${CMAKE_CURRENT_BINARY_DIR}/${name})
  file(MAKE_DIRECTORY ${work}/found)
  set(sanitizers -fsanitize=fuzzer,address,undefined)
  set(objects)
  foreach(source IN LISTS FUZZ_SOURCES)
    string(MAKE_C_IDENTIFIER ${source} object)
    set(object ${work}/${object}.o)
    add_custom_command(OUTPUT ${object}
      COMMAND ${DYNCAL_FUZZ_CXX} -std=c++20 -O1 -g1 ${sanitizers} -fno-sanitize-recover=undefined
        ${FUZZ_OPTIONS} -I ${PROJECT_SOURCE_DIR} -MD -MF ${object}.d -MT ${object}
        -c ${PROJECT_SOURCE_DIR}/${source} -o ${object}
      DEPENDS ${PROJECT_SOURCE_DIR}/${source} ${FUZZ_BUILT}
      DEPFILE ${object}.d
      COMMENT "Compiling ${source} for ${name}"
      VERBATIM)
    list(APPEND objects ${object})
  endforeach()
  set(program ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/${name})
  add_custom_command(OUTPUT ${program}
    COMMAND ${DYNCAL_FUZZ_CXX} ${sanitizers} ${objects} ${FUZZ_LIBRARIES} -o ${program}
    DEPENDS ${objects}
    COMMENT "Linking ${name}"
    VERBATIM)
  add_custom_target(${name} ALL DEPENDS ${program})

  set(test ${name}.${FUZZ_TEST})
  if(FUZZ_CORPUS)
    set(FUZZ_SEEDS ${work}/seeds)
    add_test(NAME ${name}.corpus COMMAND ${FUZZ_CORPUS} ${FUZZ_SEEDS})
    set_tests_properties(${name}.corpus PROPERTIES FIXTURES_SETUP ${FUZZ_CORPUS})
  endif()
  if(NOT FUZZ_MAX_LENGTH)
    set(FUZZ_MAX_LENGTH 8192)
  endif()
  if(NOT FUZZ_MAX_ALLOCATION_MB)
    set(FUZZ_MAX_ALLOCATION_MB 1024)
  endif()
  add_test(NAME ${test}
    COMMAND ${program} -max_total_time=${DYNCAL_FUZZ_SECONDS} -max_len=${FUZZ_MAX_LENGTH}
      -rss_limit_mb=1024 -malloc_limit_mb=${FUZZ_MAX_ALLOCATION_MB} -timeout=10
      -print_final_stats=1 -artifact_prefix=${work}/ ${work}/found ${FUZZ_SEEDS})
  math(EXPR limit "${DYNCAL_FUZZ_SECONDS} + 120")
  set_tests_properties(${test}
    PROPERTIES LABELS fuzz TIMEOUT ${limit} FIXTURES_REQUIRED "${FUZZ_CORPUS}")
endfunction()
