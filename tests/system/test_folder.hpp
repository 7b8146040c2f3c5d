// A folder for what several tests share a name for: tests of one fixture run side by side, and each
// clears its folder before it begins. Any thread.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/system/program_run.hpp"

namespace dyncal::tests {

// A fresh folder that has the name of the test that is running.
[[nodiscard]] inline std::filesystem::path fresh_folder_of_this_test() {
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string(test->test_suite_name()) + "." + test->name();
  std::replace(name.begin(), name.end(), '/', '_');
  return fresh_folder(name);
}

} // namespace dyncal::tests
