# The full form is run by hand (step_latency); the short one asserts that results are there when the
# end of a step is found.
add_executable(step_latency step_latency.cpp)
target_link_libraries(step_latency
  PRIVATE dyncal_options dyncal_evaluation CLI11::CLI11 fmt::fmt)
add_test(NAME step_latency.results_are_ready COMMAND step_latency --short --runs 1)
set_tests_properties(step_latency.results_are_ready PROPERTIES LABELS benchmark TIMEOUT 120)
