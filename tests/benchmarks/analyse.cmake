# The full form is run by hand (analyse_speed); the short one asserts that every result is there.
add_executable(analyse_speed analyse_speed.cpp)
target_link_libraries(analyse_speed
  PRIVATE dyncal_options dyncal_program_run dyncal_acs dyncal_files CLI11::CLI11 fmt::fmt)
target_compile_options(analyse_speed PRIVATE -O3) # for what only reads
target_compile_definitions(analyse_speed PRIVATE DYNCAL="$<TARGET_FILE:dyncal>")
add_dependencies(analyse_speed dyncal)
add_test(NAME analyse_speed.gives_every_result
  COMMAND analyse_speed --step-s 3 --runs 1 --disturbed)
set_tests_properties(analyse_speed.gives_every_result PROPERTIES LABELS benchmark TIMEOUT 600)
