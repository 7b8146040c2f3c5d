// What is wrong with a bench is seen by whoever reads the result of a live run: the value is
// covered by its uncertainty, carries a flag, or is refused with the reason.
#include <algorithm>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"
#include "tests/system/truth_deviation.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

constexpr const char* axis = "acceleration_z";

struct Case {
  const char* name;
  std::vector<std::string> faults; // of the virtual bench
  enum class Seen { covered, flagged, refused };
  Seen seen = Seen::covered;
  const char* flag = "";     // its name, as in the legend
  const char* sentence = ""; // of the flag, or of the refusal
  bool is_covered = true;    // beside the flag
};

LiveBenchSettings settings_of(const std::filesystem::path& folder,
                              const std::vector<std::string>& faults,
                              const std::string& frequency = "40") {
  LiveBenchSettings settings{.bench_arguments = {"--speed", "8", "--seed", "12", "--frequencies",
                                                 frequency + ",125", "--levels", "20", "--adc-file",
                                                 folder / "adc.json"},
                             .excitation = "frequencies_hz = [\"" + frequency +
                                           "\", \"125\"]\nlevel = "
                                           "20.0\nsettling_s = 0.4\nduration_s = 2.0\n",
                             .source_dau = "time_base = \"local\"",
                             .rest = "[corrections]\nadc = { file = \"adc.json\", channel = "
                                     "\"ADC1\" }\n"};
  for (const std::string& fault : faults) {
    settings.bench_arguments.insert(settings.bench_arguments.end(), {"--fault", fault});
  }
  return settings;
}

void expect_seen(const Case& fault, const nlohmann::json& point, const nlohmann::json& truth) {
  ASSERT_EQ(point["valid"].get<bool>(), fault.seen != Case::Seen::refused) << point;
  if (fault.seen == Case::Seen::refused) {
    EXPECT_THAT(point["problem"].get<std::string>(), HasSubstr(fault.sentence));
    return;
  }
  if (fault.seen == Case::Seen::flagged) {
    EXPECT_THAT(point["flag_names"].dump(), HasSubstr(fault.flag)) << point;
    EXPECT_THAT(point["flags"].dump(), HasSubstr(fault.sentence)) << point;
  } else {
    EXPECT_EQ(point["flags"], nlohmann::json::array()) << point;
  }
  if (fault.is_covered) {
    EXPECT_LE(deviation_of_point(point, truth, axis), 4.0) << point;
  }
}

// The legend of flags breaks its lines where the terminal ends.
std::string without_line_breaks(const std::string& output) {
  return std::regex_replace(output, std::regex("\\n +"), " ");
}

// On the terminal too.
void expect_told(const Case& fault, const std::string& printed) {
  const std::string output = without_line_breaks(printed);
  if (fault.seen == Case::Seen::refused) {
    EXPECT_THAT(output, HasSubstr(fault.sentence));
  } else if (fault.seen == Case::Seen::flagged) {
    EXPECT_THAT(output, HasSubstr(std::string(fault.flag) + " (")); // the legend
    EXPECT_THAT(output, HasSubstr(fault.sentence));
  }
}

class BenchFault : public testing::TestWithParam<Case> {};

TEST_P(BenchFault, IsSeenInTheResult) {
  const Case& fault = GetParam();
  const auto folder = fresh_folder(std::string("bench-fault-") + fault.name);
  const LiveBench bench(folder, settings_of(folder, fault.faults));
  ProgramRun run("dyncal",
                 {"run", bench.bench_file(), "--output", folder / "result.json", "--domain",
                  std::to_string(own_dds_domain()), "--dds", "fastdds"},
                 folder);
  const auto status = run.wait(patience);
  ASSERT_TRUE(status) << run.errors();
  const auto result = read_json(folder / "result.json");
  const auto truth = bench.truth();
  ASSERT_FALSE(result.is_discarded() || truth.is_discarded());
  std::size_t points = 0;
  for (const auto& point : result["points"]) {
    if (point["channel"] == std::string("dau/") + axis) {
      expect_seen(fault, point, truth);
      ++points;
    }
  }
  EXPECT_EQ(points, 2U);
  expect_told(fault, run.output());
}

INSTANTIATE_TEST_SUITE_P(
    Live, BenchFault,
    testing::Values(Case{.name = "none", .faults = {}},
                    Case{.name = "sensor_over_range",
                         .faults = {"over-range=27,at=sensor"},
                         .seen = Case::Seen::refused,
                         .sentence = "dau/acceleration_z is over its range"},
                    Case{.name = "reference_over_range",
                         .faults = {"over-range=19,at=reference"},
                         .seen = Case::Seen::refused,
                         .sentence = "acs/reference is over its range"},
                    Case{.name = "sync_over_range",
                         .faults = {"over-range=9,at=sync_acs"},
                         .seen = Case::Seen::flagged,
                         .flag = "over_range",
                         .sentence = "acs/sync: over range"},
                    Case{.name = "sensor_stuck",
                         .faults = {"stuck=50,at=sensor"},
                         .seen = Case::Seen::refused,
                         .sentence = "dau/acceleration_z repeats the same value"},
                    Case{.name = "reference_stuck",
                         .faults = {"stuck=1000,at=reference"},
                         .seen = Case::Seen::refused,
                         .sentence = "acs/reference repeats the same value"},
                    // At another phase each time, at both frequencies: where the sine turns around,
                    // a repeat is nothing, and the value behind it may be the same by itself.
                    Case{.name = "sensor_repeats_values",
                         .faults = {"stuck=3,at=sensor,every=0.0937"},
                         .seen = Case::Seen::flagged,
                         .flag = "values_stuck",
                         .sentence = "dau/acceleration_z: values stuck: up to ",
                         .is_covered = false},
                    Case{.name = "drift",
                         .faults = {"drift=0.02,at=sensor", "drift=0.02,at=reference"}},
                    Case{.name = "lost_and_counted",
                         .faults = {"loss=0.01,at=sensor"},
                         .seen = Case::Seen::flagged,
                         .flag = "samples_lost",
                         .sentence = "dau: samples lost"},
                    // The unit numbers what it has; its stamps then show what it lacks.
                    Case{.name = "lost_and_not_counted",
                         .faults = {"loss=0.01,at=sensor,counted=no"},
                         .seen = Case::Seen::flagged,
                         .flag = "samples_lost",
                         .sentence = "dau: samples lost"},
                    Case{.name = "frames_of_the_acs_lost",
                         .faults = {"loss=0.3,at=acs"},
                         .seen = Case::Seen::flagged,
                         .flag = "samples_lost",
                         .sentence = "acs: samples lost"}),
    [](const auto& one) { return std::string(one.param.name); });

// Mains hum at the frequency of a step: no sine fit can tell one from the other.
class HumAtAStep : public testing::TestWithParam<const char*> {};

TEST_P(HumAtAStep, IsCoveredOrSeen) {
  const std::string channel = GetParam();
  const auto folder = fresh_folder("bench-fault-hum-" + channel);
  LiveBench bench(folder, settings_of(folder, {"hum=0.02,at=" + channel}, "50"));
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder / "result.json"});
  ASSERT_TRUE(run.wait(patience)) << run.errors();
  const auto result = read_json(folder / "result.json");
  const auto truth = bench.truth();
  ASSERT_FALSE(result.is_discarded() || truth.is_discarded());
  std::size_t points = 0;
  for (const auto& point : result["points"]) {
    if (point["channel"] != std::string("dau/") + axis) {
      continue;
    }
    ++points;
    if (point["valid"].get<bool>() && point["flags"].empty()) {
      EXPECT_LE(deviation_of_point(point, truth, axis), 4.0) << point;
    }
  }
  EXPECT_EQ(points, 2U);
}

INSTANTIATE_TEST_SUITE_P(Channels, HumAtAStep,
                         testing::Values("sensor", "reference", "sync_acs", "sync_dau"));

// Flags of results and of the sample clock reach whoever watches.
TEST(BenchFaultWatched, FlagsAreOnTheBus) {
  const auto folder = fresh_folder("bench-fault-watched");
  LiveBench bench(folder, settings_of(folder, {"loss=0.01,at=sensor"}));
  std::filesystem::create_directories(folder / "watch");
  ProgramRun watch("dyncal",
                   {"watch", "--bench", "live", "--domain", std::to_string(own_dds_domain()),
                    "--dds", "cyclonedds"},
                   folder / "watch");
  ASSERT_TRUE(watch.wait_for_output_text("live/dau: running", patience));
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_EQ(run.wait(patience), 0) << run.errors();
  ASSERT_TRUE(watch.wait_for_output_text("sample clock of dau", patience)) << watch.output();
  ASSERT_TRUE(watch.wait_for_output_text("flag samples_lost", patience)) << watch.output();
  const std::string output = watch.output();
  const std::string from_clock = output.substr(output.find("sample clock of dau"));
  EXPECT_THAT(from_clock.substr(0, from_clock.find('\n')),
              testing::AllOf(HasSubstr(" lost, "), HasSubstr("clock_uncertainty_unknown"),
                             HasSubstr("samples_lost (samples lost)")));
  EXPECT_THAT(output, HasSubstr("samples_lost (dau: samples lost)"));
}

// A sensor that somebody has published, and a generator that goes where nobody knows it.
TEST(BenchResponse, ResultOfASensorFromAFileAgreesWithItAndOutsideItNothingIsExcited) {
  const auto folder = fresh_folder("bench-response");
  std::ofstream(folder / "response.csv")
      << "frequency_hz,magnitude,phase_rad\n20,0.82,-0.21\n40,0.80,-0.43\n80,0.75,-0.9\n"
         "125,0.66,-1.5\n";
  LiveBenchSettings settings = settings_of(folder, {});
  settings.bench_arguments.insert(settings.bench_arguments.end(),
                                  {"--response", folder / "response.csv"});
  LiveBench bench(folder, settings);
  bench.tell_generator(":SOURce1:FREQuency 126");
  EXPECT_THAT(bench.ask_generator(":SYSTem:ERRor?"), HasSubstr("Data out of range"));
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder / "result.json"});
  ASSERT_EQ(run.wait(patience), 0) << run.errors();
  std::size_t points = 0;
  const auto result = read_json(folder / "result.json");
  for (const auto& point : result["points"]) {
    if (point["channel"] == std::string("dau/") + axis) {
      const bool at_40 = point["frequency_hz"] == 40.0;
      EXPECT_NEAR(point["magnitude"].get<double>(), at_40 ? 0.80 : 0.66,
                  4.0 * point["u_magnitude"].get<double>());
      EXPECT_NEAR(point["phase_rad"].get<double>(), at_40 ? -0.43 : -1.5,
                  4.0 * point["u_phase_rad"].get<double>());
      ++points;
    }
  }
  EXPECT_EQ(points, 2U);
}

} // namespace
} // namespace dyncal::tests
