// What `dyncal analyse` makes of the recording of a run, to hold against what came live: the same
// samples give the same bits. Any thread.
#pragma once

#include <filesystem>

#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"
#include "tests/system/program_run.hpp"

namespace dyncal::tests {

// The points of the only run that is recorded below `folder`.
[[nodiscard]] inline nlohmann::json points_evaluated_again(const std::filesystem::path& folder) {
  std::filesystem::path run;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().filename() == "recording.mcap") {
      EXPECT_TRUE(run.empty()) << "two runs: " << run << " and " << entry.path();
      run = entry.path().parent_path();
    }
  }
  const auto again =
      run_to_end("dyncal", {"analyse", run, "--output", folder / "evaluated-again.json"}, folder);
  EXPECT_EQ(again.status, 0) << again.errors;
  return read_json(folder / "evaluated-again.json")["points"];
}

} // namespace dyncal::tests
