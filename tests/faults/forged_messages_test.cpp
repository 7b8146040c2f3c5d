// What somebody who writes on a bench, by a DDS library of his own, does to its runs: while a run
// is attended, and when its conductor is cut off.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/faults/forger.hpp"
#include "tests/system/live_bench.hpp"
#include "tests/system/truth_deviation.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

LiveBenchSettings steps_of(const std::string& dds, const std::string& duration_s) {
  LiveBenchSettings settings;
  settings.bench_arguments = {"--frequencies", "40,80", "--levels", "20"};
  settings.excitation = "frequencies_hz = [\"40\", \"80\"]\nlevel = 20.0\n"
                        "settling_s = 0.5\nduration_s = " +
                        duration_s + "\n";
  settings.rest = "adc_delay_s = 1e-6\n";
  settings.dds = dds;
  return settings;
}

class ForgedMessages : public testing::TestWithParam<std::tuple<std::string, std::string>> {
protected:
  [[nodiscard]] static const std::string& dds() { return std::get<0>(GetParam()); }
  [[nodiscard]] static std::string place(const std::string& name) {
    return name + "_" + dds() + "_" + std::get<1>(GetParam());
  }
  Forger forger_{std::get<1>(GetParam()), own_dds_domain(), "live"};
};

TEST_P(ForgedMessages, HoldNoOutputOnWhoseConductorIsCutOff) {
  LiveBench bench(fresh_folder(place("held_on")), steps_of(dds(), "300.0"));
  ProgramRun& guard = bench.start_service("dyncal-guard");
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_TRUE(run.wait_for_error_text("step 1 of 2", patience)) << run.errors();
  ASSERT_TRUE(bench.wait_for_output("ON"));
  ASSERT_TRUE(guard.wait_for_error_text("watching over run", patience));
  ASSERT_TRUE(forger_.hears_excitation(patience));
  forger_.hold_on();
  ASSERT_TRUE(guard.wait_for_error_text("were passed over", patience)) << "it is heard";
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "ON");
  run.send(SIGSTOP);
  const auto cut_off = std::chrono::steady_clock::now();
  ASSERT_TRUE(bench.wait_for_output("OFF")) << guard.errors();
  const std::chrono::duration<double> on = std::chrono::steady_clock::now() - cut_off;
  RecordProperty("on_for_s", std::to_string(on.count()));
  fmt::print("the output was on for {:.2f} s\n", on.count());
  EXPECT_LT(on, 2s + 1500ms) << "and what a busy machine takes";
  EXPECT_FALSE(guard.wait_for_error_text("MAY BE ON", 3s));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
  forger_.stop();
  run.send(SIGCONT);
  run.send(SIGINT);
  EXPECT_TRUE(run.wait(patience)) << run.errors();
}

TEST_P(ForgedMessages, SwitchNoOutputOffThroughTheGuard) {
  LiveBench bench(fresh_folder(place("switched_off")), steps_of(dds(), "3.0"));
  ProgramRun& guard = bench.start_service("dyncal-guard");
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_TRUE(guard.wait_for_error_text("watching over run", patience));
  ASSERT_TRUE(forger_.hears_excitation(patience));
  forger_.hold_on();
  ASSERT_TRUE(guard.wait_for_error_text("were passed over", patience)) << "it is heard";
  EXPECT_TRUE(run.wait(patience)) << run.errors();
  EXPECT_THAT(guard.errors(), Not(HasSubstr("switched off")));
  EXPECT_THAT(run.errors(), Not(HasSubstr("does not hear this run")));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
}

LiveBenchSettings unrepeated_steps_of(const std::string& dds) {
  LiveBenchSettings settings = steps_of(dds, "3.0");
  settings.excitation += "attempts = 1\n";
  return settings;
}

void expect_true_points(const nlohmann::json& result, const nlohmann::json& truth) {
  ASSERT_EQ(result["points"].size(), 6U);
  for (const auto& point : result["points"]) {
    EXPECT_TRUE(point["valid"].get<bool>()) << point["problem"];
    const std::string channel = point["channel"].get<std::string>().substr(4); // behind "dau/"
    EXPECT_LT(deviation_of_point(point, truth, channel), 5.0) << channel;
  }
}

TEST_P(ForgedMessages, ChangeNoValueAndAreFlaggedWhereTheyAreSamples) {
  const auto folder = fresh_folder(place("samples"));
  LiveBench bench(folder, unrepeated_steps_of(dds()));
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder / "run.json"});
  ASSERT_TRUE(run.wait_for_error_text("step 1 of 2", patience)) << run.errors();
  forger_.send_as("dau");
  ProgramRun& doctor = bench.start({"doctor"});
  EXPECT_TRUE(doctor.wait(patience)) << doctor.errors();
  EXPECT_THAT(doctor.output(),
              testing::ContainsRegex("forger:[0-9]+ on [^ ]+ .* writes samples of bench live "
                                     ".topic DauSamples. and describes no source"));
  EXPECT_TRUE(run.wait(patience)) << run.errors();
  forger_.stop();
  ASSERT_GT(forger_.forged(), 10U);
  const auto result = read_json(folder / "run.json");
  expect_true_points(result, bench.truth());
  EXPECT_THAT(result["points"].dump(), HasSubstr("another program sends in its name"));
  EXPECT_THAT(bench.service("dyncal-analysis").errors(),
              testing::ContainsRegex("two programs send in the name of source 'dau' of bench "
                                     "'live': dyncal-dau:[0-9]+ on [^ ,]+, and later "
                                     "forger:[0-9]+ on [^ ,]+, whose messages are left out"));
}

INSTANTIATE_TEST_SUITE_P(EachVendor, ForgedMessages,
                         testing::Combine(testing::Values("fastdds", "cyclonedds"),
                                          testing::Values("fastdds", "cyclonedds")),
                         [](const auto& vendors) {
                           return std::get<0>(vendors.param) + "_by_" + std::get<1>(vendors.param);
                         });

} // namespace
} // namespace dyncal::tests
