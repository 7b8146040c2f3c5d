# Recordings: beside a program that only writes. `recording_load FOLDER 2000 --strict` asserts half
# of its speed, and nothing lost at 100 MB/s; the short form asserts that nothing is lost at 20.
add_executable(recording_load recording_load.cpp)
target_link_libraries(recording_load
  PRIVATE dyncal_memory_bus dyncal_recording dyncal_options fmt::fmt)
add_test(NAME recording_load.nothing_is_lost
  COMMAND recording_load ${CMAKE_BINARY_DIR}/test-output/recording_load 50)
set_tests_properties(recording_load.nothing_is_lost
  PROPERTIES
  LABELS benchmark
  TIMEOUT 600
  RUN_SERIAL ON)
