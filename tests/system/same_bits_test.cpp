// The same samples give the same bits, whichever DDS implementation carries them, and without any.
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

nlohmann::json result_over(const std::filesystem::path& folder, const std::filesystem::path& bench,
                           const std::string& name, const std::string& acs,
                           const std::string& analysis, const std::string& run) {
  Laboratory laboratory(folder);
  laboratory.start("dyncal-analysis", {}, analysis);
  laboratory.start("dyncal-acs", {bench}, acs);
  const std::filesystem::path json = folder / (name + ".json");
  ProgramRun& command = laboratory.start("dyncal", {"run", bench, "--output", json}, run);
  EXPECT_EQ(command.wait(patience), 0) << name << command.output() << command.errors();
  return read_json(json);
}

TEST(SameBits, ComeOutOverFastDdsOverCycloneDdsOverBothAndWithoutANetwork) {
  const auto folder = fresh_folder("same-bits");
  const auto bench = recorded_bench(folder, "files", "3");
  const auto fast = result_over(folder, bench, "fast", "fastdds", "fastdds", "fastdds");
  const auto cyclone =
      result_over(folder, bench, "cyclone", "cyclonedds", "cyclonedds", "cyclonedds");
  const auto mixed = result_over(folder, bench, "mixed", "cyclonedds", "fastdds", "cyclonedds");
  ProgramRun analyse("dyncal", {"analyse", bench, "--output", folder / "analyse.json"}, folder);
  EXPECT_EQ(analyse.wait(patience), 0) << analyse.errors();
  const auto without_network = read_json(folder / "analyse.json");
  ASSERT_FALSE(fast.is_discarded() || cyclone.is_discarded() || mixed.is_discarded());
  ASSERT_EQ(fast["points"].size(), 18U);
  EXPECT_EQ(fast["points"], cyclone["points"]);
  EXPECT_EQ(fast["points"], mixed["points"]);
  EXPECT_EQ(fast["transfer_function"], cyclone["transfer_function"]);
  EXPECT_EQ(fast["transfer_function"], mixed["transfer_function"]);
  EXPECT_EQ(fast["group_delay"], mixed["group_delay"]);
  EXPECT_EQ(fast["points"], without_network["points"]);
  EXPECT_EQ(fast["transfer_function"], without_network["transfer_function"]);
}

} // namespace
} // namespace dyncal::tests
