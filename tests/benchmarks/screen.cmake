# The full form is run by hand (screen_cost); the short one asserts that the screen costs little
# beside Fast DDS itself.
add_executable(screen_cost screen_cost.cpp)
target_link_libraries(screen_cost PRIVATE dyncal_options dyncal_bus CLI11::CLI11 fmt::fmt)
add_test(NAME screen_cost.is_small COMMAND screen_cost --blocks 2000)
set_tests_properties(screen_cost.is_small PROPERTIES LABELS benchmark TIMEOUT 300 RUN_SERIAL ON)
