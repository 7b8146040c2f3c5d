// A multi-sine that 'dyncal run' excites: its waveform goes to the generator, and each line has its
// result.
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
constexpr const char* lines = "20.5,31.5,63.5,80.5";

LiveBenchSettings settings_of(const std::filesystem::path& folder, const std::string& generator) {
  LiveBenchSettings settings{
      .bench_arguments = {"--seed", "3", "--frequencies", lines, "--levels", "10", "--multisine",
                          "2", "--adc-file", folder / "adc.json"},
      .excitation = "kind = \"multisine\"\n"
                    "frequencies_hz = [\"20.5\", \"31.5\", \"63.5\", \"80.5\"]\nlevel = 10.0\n"
                    "period_s = 2.0\ndropped_periods = 0.5\nrepetitions = 2\n",
      .generator = generator};
  settings.rest = "[corrections.adc]\nfile = \"adc.json\"\nchannel = \"ADC1\"\n";
  return settings;
}

class ExcitedMultisine : public testing::TestWithParam<const char*> {
protected:
  std::filesystem::path folder_ = fresh_folder_of_this_test();
};

TEST_P(ExcitedMultisine, HasAResultALineThatAgreesWithTheTruth) {
  LiveBenchSettings settings = settings_of(folder_, "level_per_volt = 50.0\n");
  settings.dds = GetParam();
  LiveBench bench(folder_, settings);
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder_ / "result.json"});
  ASSERT_EQ(run.wait(patience), 0) << run.errors();
  EXPECT_EQ(points_near_truth(read_json(folder_ / "result.json"), bench.truth(), axis, covered), 8);
}

INSTANTIATE_TEST_SUITE_P(Vendors, ExcitedMultisine, testing::Values("cyclonedds", "fastdds"),
                         [](const auto& one) { return std::string(one.param); });

// The exciter gives 30 % less than the bench file says, and less at some lines than at others.
TEST(ExcitedMultisineLevels, AreBroughtToThePlanByAFirstExcitation) {
  const auto folder = fresh_folder_of_this_test();
  LiveBenchSettings settings =
      settings_of(folder, "level_per_volt = 50.0\nlevel_tolerance_rel = 0.02\n");
  settings.bench_arguments.insert(settings.bench_arguments.end(), {"--exciter-gain", "0.7"});
  LiveBench bench(folder, settings);
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder / "result.json"});
  ASSERT_EQ(run.wait(patience), 0) << run.errors();
  const auto result = read_json(folder / "result.json");
  EXPECT_EQ(points_near_truth(result, bench.truth(), axis, covered), 8);
  for (const auto& point : result["points"]) {
    EXPECT_THAT(point["flag_names"].dump(), testing::Not(HasSubstr("level_off_plan")));
  }
}

TEST(ExcitedMultisineLimits, AreThoseOfTheSumOfAllLines) {
  const auto folder = fresh_folder_of_this_test();
  LiveBench bench(folder, settings_of(folder, "level_per_volt = 50.0\nmaximum_level_m_s2 = 15\n"));
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder / "result.json"});
  EXPECT_NE(run.wait(patience), 0);
  EXPECT_THAT(run.errors(), HasSubstr("above generator.maximum_level_m_s2 = 15"));
}

} // namespace
} // namespace dyncal::tests
