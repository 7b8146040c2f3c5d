// Five levels at one frequency, through all that shows or compares results: five points everywhere.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr int levels = 5;

std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class Levels : public testing::Test {
protected:
  std::filesystem::path folder_ = fresh_folder(
      std::string("levels-") + testing::UnitTest::GetInstance()->current_test_info()->name());

  EndedRun run(const std::string& program, const std::vector<std::string>& arguments) {
    return run_to_end(program, arguments, folder_);
  }

  // A result of five levels at 80 Hz, excited along z, whose bench is named by the seed.
  std::filesystem::path measured(int seed) {
    const std::filesystem::path place = folder_ / fmt::format("{}", seed);
    std::filesystem::create_directories(place);
    const EndedRun recorded =
        run("dyncal-virtual-bench",
            {"--seed", fmt::format("{}", seed), "--record-csv", place, "--adc-file",
             place / "adc.json", "--frequencies", "80,80,80,80,80", "--levels", "2,4,8,12,15",
             "--repetitions", "2", "--settling", "0.5", "--duration-per-step", "1.5"});
    EXPECT_EQ(recorded.status, 0) << recorded.errors;
    std::ofstream(place / "bench.toml") << fmt::format(R"(bench = "levels-{}"
[excitation]
frequencies_hz = ["80", "80", "80", "80", "80"]
level = [2, 4, 8, 12, 15]
axis = "z"
repetitions = 2
settling_s = 0.5
duration_s = 1.0
[sources.dau]
driver = "file"
path = "dau.csv"
time_base = "utc"
units = {{ acceleration_z = "m/s^2", sync = "V" }}
[sources.acs]
driver = "file"
path = "acs.csv"
units = {{ reference = "m/s^2", sync = "V" }}
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_z"]
[corrections.adc]
file = "adc.json"
channel = "ADC1"
[uncertainty]
reference_magnitude_rel = 1e-3
reference_phase_rad = 1.7e-3
acs_delay_s = 1e-7
)",
                                                       seed);
    table_ = run("dyncal", {"analyse", place / "bench.toml", "--output", place / "result.json",
                            "--figures", place / "figures"});
    EXPECT_EQ(table_.status, 0) << table_.errors;
    return place / "result.json";
  }

  EndedRun table_; // of the newest
};

TEST_F(Levels, AreFivePointsInTableFigureAndCsv) {
  const auto result = read_json(measured(1));
  ASSERT_EQ(result["transfer_function"].size(), 5U);
  for (const auto& value : result["transfer_function"]) {
    EXPECT_EQ(value["repetitions"], 2);
    EXPECT_EQ(value["excited_axis"], "z");
    EXPECT_NEAR(value["magnitude"], 1.0, 0.1);
  }
  EXPECT_THAT(table_.output, HasSubstr("excited axis z"));
  EXPECT_THAT(table_.output, HasSubstr("level / (m/s^2)"));
  const auto figures = folder_ / "1/figures";
  const std::string svg = text_of(figures / "transfer-function-dau-acceleration_z.svg");
  const std::string csv = text_of(figures / "transfer-function-dau-acceleration_z.csv");
  EXPECT_THAT(csv, HasSubstr(",level_m_s2,excited_axis,attempt\n"));
  for (const int level : {2, 4, 8, 12, 15}) {
    EXPECT_THAT(svg, HasSubstr(fmt::format(">{} m/s²: mean ± u<", level)));
    EXPECT_THAT(csv, HasSubstr(fmt::format(",{},z,1\n", level)));
    EXPECT_THAT(csv, HasSubstr(fmt::format(",{},z,\n", level)));
  }
  EXPECT_THAT(text_of(figures / "closures.csv"),
              HasSubstr("\"dau/acceleration_z\",repetitions,\"repetitions of a point\",\"80 Hz, "));
}

TEST_F(Levels, ArePairedByCompareOneByOne) {
  const auto first = measured(1);
  const auto second = measured(2);
  const EndedRun all = run("dyncal", {"compare", first, second});
  EXPECT_THAT(all.output, HasSubstr(" of 5 points agree")) << all.errors;
  EXPECT_THAT(all.output, Not(HasSubstr("no partner")));
  const EndedRun same = run("dyncal", {"compare", first, first});
  EXPECT_EQ(same.status, 0) << same.output << same.errors;
  EXPECT_THAT(all.output, HasSubstr("dau/acceleration_z, axis z\n"));
  const EndedRun single = run("dyncal", {"compare", first, second, "--single"});
  EXPECT_THAT(single.output, HasSubstr(" of 10 points agree"));

  // Another plan: one level is missing, one is different.
  auto other = read_json(second);
  auto& values = other["transfer_function"];
  values.erase(0);
  values[0]["level_m_s2"] = 5.0;
  std::ofstream(folder_ / "other.json") << other;
  const EndedRun some = run("dyncal", {"compare", first, folder_ / "other.json"});
  EXPECT_EQ(some.status, 3);
  EXPECT_THAT(some.output, HasSubstr(" of 3 points agree"));
  EXPECT_THAT(some.output, HasSubstr("3 points have no partner and are not compared:"));
  EXPECT_THAT(some.output, HasSubstr("result.json: dau/acceleration_z at 80 Hz, 2 m/s^2, axis z; "
                                     "80 Hz, 4 m/s^2, axis z\n"));
  EXPECT_THAT(some.output, HasSubstr("other.json: dau/acceleration_z at 80 Hz, 5 m/s^2, axis z\n"));
  EXPECT_THAT(some.output, HasSubstr("the levels differ: 2, 4, 8, 12, 15 m/s^2 in the first, "
                                     "5, 8, 12, 15 m/s^2 in the second"));
  const EndedRun one = run("dyncal", {"compare", first, folder_ / "other.json", "--level", "4",
                                      "--other-level", "5", "--json"});
  const auto json = nlohmann::json::parse(one.output, nullptr, false);
  ASSERT_EQ(json["points"].size(), 1U);
  EXPECT_EQ(json["points"][0]["level_m_s2"], 4.0);
  EXPECT_EQ(json["points"][0]["other_level_m_s2"], 5.0);
  EXPECT_EQ(json["only_first"].size(), 0U);
  const EndedRun none = run("dyncal", {"compare", first, folder_ / "other.json", "--level", "2"});
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.errors, HasSubstr("no channel and frequency in common"));
}

TEST_F(Levels, AreLinesOfTheirOwnInStoreAndHistory) {
  const std::vector<std::string> store{"--store", folder_ / "store.sqlite"};
  for (const int seed : {1, 2}) {
    std::vector<std::string> add{"store", "add", measured(seed)};
    add.insert(add.end(), store.begin(), store.end());
    const EndedRun added = run("dyncal", add);
    ASSERT_EQ(added.status, 0) << added.errors;
  }
  const auto history = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"history", "dau"});
    options.insert(options.end(), store.begin(), store.end());
    return run("dyncal", options);
  };
  const auto json = nlohmann::json::parse(history({"--json"}).output, nullptr, false);
  ASSERT_EQ(json["lines"].size(), static_cast<std::size_t>(levels));
  for (const auto& line : json["lines"]) {
    EXPECT_EQ(line["excited_axis"], "z");
    ASSERT_EQ(line["values"].size(), 2U) << line;
    EXPECT_EQ(line["values"][0]["level_m_s2"], line["values"][1]["level_m_s2"]);
    EXPECT_TRUE(line["values"][1]["en_magnitude"].is_number());
  }
  const EndedRun table = history({"--figures", folder_ / "drift"});
  EXPECT_THAT(table.output, HasSubstr("dau/acceleration_z at 80 Hz, 15 m/s^2, magnitude in"));
  EXPECT_THAT(table.output, HasSubstr("of 5 values agree with the calibration before"));
  EXPECT_THAT(text_of(folder_ / "drift/drift-dau-acceleration_z.svg"),
              HasSubstr("80 Hz, 12 m/s^2"));
  const EndedRun one = history({"--level", "8"});
  EXPECT_THAT(one.output, HasSubstr("dau/acceleration_z at 80 Hz, magnitude in"));
  EXPECT_THAT(one.output, HasSubstr("of 1 values agree"));
}

} // namespace
} // namespace dyncal::tests
