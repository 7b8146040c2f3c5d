// Runs whose reference is a system that evaluates itself: the virtual bench's ACS writes its table
// while the run goes on, and dyncal-acs hands the steps out.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"
#include "tests/system/test_folder.hpp"
#include "tests/system/truth_deviation.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

constexpr double covered = 4.0; // standard uncertainties
constexpr const char* axis = "acceleration_z";

LiveBenchSettings settings_of(const std::filesystem::path& folder, const std::string& dds) {
  LiveBenchSettings settings{
      .bench_arguments = {"--seed", "5", "--frequencies", "20,40,80", "--levels", "10",
                          "--acs-table", folder / "table.csv", "--adc-file", folder / "adc.json"},
      .excitation = "frequencies_hz = [\"20\", \"40\", \"80\"]\nlevel = 10.0\nrepetitions = 2\n"
                    "settling_s = 0.5\nduration_s = 1.0\n"};
  settings.source_acs = fmt::format("driver = \"table\"\npath = \"{}\"\n"
                                    "phase = \"sync-minus-reference\"\ncoverage = 2\n",
                                    (folder / "table.csv").string());
  settings.reference = "reference_table = \"acs\"\n";
  settings.rest = "[corrections.adc]\nfile = \"adc.json\"\nchannel = \"ADC1\"\n";
  settings.dds = dds;
  return settings;
}

class TableRun : public testing::TestWithParam<const char*> {
protected:
  std::filesystem::path folder_ = fresh_folder_of_this_test();
};

TEST_P(TableRun, AgreesWithTheTruth) {
  LiveBench bench(folder_, settings_of(folder_, GetParam()));
  // Of an earlier run: rows of the same steps that are none of this one's.
  std::ofstream(folder_ / "table.csv", std::ios::app) << "0;20;99;1;45;1\n0;40;99;1;45;1\n"
                                                         "0;80;99;1;45;1\n";
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder_ / "result.json"});
  ASSERT_EQ(run.wait(patience), 0) << run.errors();
  const auto result = read_json(folder_ / "result.json");
  EXPECT_EQ(points_near_truth(result, bench.truth(), axis, covered), 6);
  for (const auto& point : result["points"]) {
    EXPECT_FALSE(point.contains("attempt")) << point.dump(); // of the first
  }
  EXPECT_EQ(result.dump().find("step_number_uncertain"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Vendors, TableRun, testing::Values("cyclonedds", "fastdds"),
                         [](const auto& one) { return std::string(one.param); });

TEST(TableRunWithoutRows, EndsWithAReasonForEveryStep) {
  const auto folder = fresh_folder_of_this_test();
  LiveBenchSettings settings = settings_of(folder, "cyclonedds");
  const std::string other = (folder / "nobody-writes-it.csv").string();
  settings.source_acs = fmt::format("driver = \"table\"\npath = \"{}\"\n"
                                    "phase = \"sync-minus-reference\"\ncoverage = 2\n",
                                    other);
  settings.excitation = "frequencies_hz = [\"20\"]\nlevel = 10.0\nsettling_s = 0.5\n"
                        "duration_s = 1.0\n";
  LiveBench bench(folder, settings);
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder / "result.json"});
  EXPECT_NE(run.wait(patience), 0);
  const auto result = read_json(folder / "result.json");
  ASSERT_EQ(result["points"].size(), 3U) << run.errors();
  for (const auto& point : result["points"]) {
    EXPECT_FALSE(point["valid"].get<bool>());
    EXPECT_THAT(point["problem"].get<std::string>(), HasSubstr("no row for this step, of 20 Hz"));
  }
}

} // namespace
} // namespace dyncal::tests
