# Asserts that showing progress costs next to nothing, and changes no result.
find_package(nlohmann_json REQUIRED)
add_executable(progress_cost progress_cost.cpp)
target_link_libraries(progress_cost
  PRIVATE dyncal_options dyncal_command dyncal_replay CLI11::CLI11 fmt::fmt
    nlohmann_json::nlohmann_json)
add_test(NAME progress_cost.is_small COMMAND progress_cost --rounds 9 --max-ratio 1.2)
set_tests_properties(progress_cost.is_small PROPERTIES LABELS benchmark TIMEOUT 300 RUN_SERIAL ON)
