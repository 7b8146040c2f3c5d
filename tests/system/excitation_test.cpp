// How a run excites: the level in closed loop and its limits, the output off however the run ends,
// the generator set by hand.
#include <array>
#include <cmath>
#include <csignal>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

LiveBenchSettings settings_with(const std::string& generator, const std::string& speed = "max") {
  return {.bench_arguments = {"--speed", speed, "--seed", "12", "--frequencies", "40,200",
                              "--levels", "20"},
          .excitation = "frequencies_hz = [\"40\", \"200\"]\nlevel = 20.0\nrepetitions = "
                        "2\nsettling_s = 0.4\nduration_s = 1.5\n",
          .generator = generator,
          .source_dau = "time_base = \"local\"",
          .rest = ""};
}

double exciter_response(double frequency_hz) { // of the virtual bench: m/s^2 per V
  return 50.0 * (1.0 + 0.1 * std::pow(frequency_hz / 900.0, 2));
}

TEST(Excitation, ClosedLoopBringsTheLevelToItsValue) {
  const auto folder = fresh_folder("excitation-level");
  // The bench file is wrong by 60 % about the exciter.
  LiveBench bench(
      folder,
      settings_with(
          "level_per_volt = 80.0\nlevel_tolerance_rel = 0.005\nmaximum_level_m_s2 = 40.0\n"));
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder / "result.json"});
  ASSERT_EQ(run.wait(patience), 0) << run.errors();
  const double amplitude_v =
      0.5 * std::stod(bench.ask_generator(":SOURce1:VOLTage?")); // of the last step, 200 Hz
  EXPECT_NEAR(amplitude_v * exciter_response(200.0), 20.0,
              20.0 * (0.005 + 4e-3)); // 4 u of the ACS's reference
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
  const auto result = read_json(folder / "result.json");
  EXPECT_EQ(result["points"].size(), 3U * 4U);
  const auto truth = bench.truth();
  int compared = 0;
  for (const auto& point : result["transfer_function"]) {
    for (const auto& known : truth["transfer_function"]) {
      if ("dau/" + known["channel"].get<std::string>() != point["channel"].get<std::string>() ||
          known["frequency_hz"] != point["frequency_hz"]) {
        continue;
      }
      const double phase =
          std::remainder(point["phase_rad"].get<double>() - known["phase_rad"].get<double>(),
                         2.0 * std::numbers::pi);
      EXPECT_LE(std::abs(phase), 4.0 * point["u_phase_rad"].get<double>() + 6e-4)
          << point; // the ADC's lag is not corrected here
      EXPECT_NEAR(point["magnitude"].get<double>(), known["magnitude"].get<double>(),
                  4.0 * point["u_magnitude"].get<double>())
          << point;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 6);
}

TEST(Excitation, ALevelThatNeedsTooMuchVoltageIsRefusedBeforeTheOutputIsOn) {
  const auto folder = fresh_folder("excitation-voltage");
  LiveBench bench(folder, settings_with("level_per_volt = 50.0\nmaximum_voltage_v = 0.3\n"));
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  EXPECT_EQ(run.wait(patience), 1);
  EXPECT_THAT(run.errors(), HasSubstr("key 'excitation.level' of 20 m/s^2 at 40 Hz needs 0.4 V, "
                                      "above generator.maximum_voltage_v = 0.3"));
}

// Above the limit of the bench file, although not far above the plan.
TEST(Excitation, AnExciterThatIsTooLivelyIsSwitchedOff) {
  const auto folder = fresh_folder("excitation-lively");
  LiveBench bench(
      folder,
      settings_with(
          "level_per_volt = 20.0\nlevel_tolerance_rel = 0.01\nmaximum_level_m_s2 = 24.0\n"));
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  EXPECT_NE(run.wait(patience).value_or(0), 0);
  EXPECT_THAT(run.errors(), HasSubstr("above generator.maximum_level_m_s2 = 24"));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
}

// The amplifier is off as far as the reference shows: nothing is in danger, so the step has another
// attempt, and the run ends with a line that names it.
TEST(Excitation, ALevelThatIsNotReachedIsTriedAgainAndThenNamed) {
  const auto folder = fresh_folder("excitation-not-reached");
  LiveBenchSettings settings =
      settings_with("level_per_volt = 5000.0\nlevel_tolerance_rel = 0.01\n");
  settings.excitation = "frequencies_hz = [\"40\"]\nlevel = 20.0\nsettling_s = 0.4\n"
                        "duration_s = 1.5\nattempts = 2\n";
  LiveBench bench(folder, settings);
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  EXPECT_EQ(run.wait(patience).value_or(0), 1);
  EXPECT_THAT(run.errors(), HasSubstr("step 1 is excited again, attempt 2: its excitation was "
                                      "broken off"));
  EXPECT_THAT(run.errors(),
              testing::ContainsRegex("step 1, 40 Hz: the reference shows .*is the "
                                     "amplifier on.*\\(attempts: 2\\); 0 of 1 steps"));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
}

// What the reference shows is not believed where it would drive the exciter ever further.
class BadReference : public testing::TestWithParam<std::pair<std::string, std::string>> {};

INSTANTIATE_TEST_SUITE_P(
    Excitation, BadReference,
    testing::Values(std::pair("hum=0.6,at=reference,frequency=40",
                              "acs/reference shows .* at this frequency while the output is off"),
                    std::pair("over-range=12,at=reference",
                              "acs/reference is at an end of its range")));

TEST_P(BadReference, IsRefusedByName) {
  const auto& [fault, refusal] = GetParam();
  const auto folder = fresh_folder("excitation-" + fault.substr(0, fault.find('=')));
  LiveBenchSettings settings = settings_with("level_per_volt = 50.0\nlevel_tolerance_rel = 0.05\n");
  settings.bench_arguments.insert(settings.bench_arguments.end(), {"--fault", fault});
  settings.excitation = "frequencies_hz = [\"40\"]\nlevel = 20.0\nsettling_s = 0.4\n"
                        "duration_s = 1.5\nattempts = 2\n";
  LiveBench bench(folder, settings);
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  EXPECT_EQ(run.wait(patience).value_or(0), 1);
  EXPECT_THAT(run.errors(), testing::ContainsRegex("step 1, 40 Hz: " + refusal));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
  const double amplitude_v = 0.5 * std::stod(bench.ask_generator(":SOURce1:VOLTage?"));
  EXPECT_LE(amplitude_v, 1.5 * 20.0 / 50.0);
}

// Without a level tolerance and without any limit in the bench file.
TEST(Excitation, AnAmplifierThatIsTurnedUpStopsTheRunWithinTheFirstStep) {
  const auto folder = fresh_folder("excitation-turned-up");
  LiveBenchSettings settings = settings_with("level_per_volt = 50.0\n", "1");
  settings.bench_arguments.insert(settings.bench_arguments.end(), {"--fault", "exciter-gain=50"});
  LiveBench bench(folder, settings);
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  EXPECT_EQ(run.wait(patience).value_or(0), 1);
  EXPECT_THAT(run.errors(), HasSubstr("step 1, 40 Hz: acs/reference shows"));
  EXPECT_THAT(run.errors(), HasSubstr("where 20 m/s^2 are planned"));
  EXPECT_THAT(run.errors(), testing::Not(HasSubstr("step 2 of 4")));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
}

TEST(Excitation, ALevelThatIsOffThePlanIsFlagged) {
  const auto folder = fresh_folder("excitation-off-plan");
  LiveBenchSettings settings = settings_with("level_per_volt = 50.0\n");
  settings.bench_arguments.insert(settings.bench_arguments.end(), {"--exciter-gain", "1.3"});
  LiveBench bench(folder, settings);
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder / "result.json"});
  ASSERT_EQ(run.wait(patience), 0) << run.errors();
  const auto result = read_json(folder / "result.json");
  ASSERT_EQ(result["points"].size(), 3U * 4U);
  for (const auto& point : result["points"]) {
    EXPECT_THAT(point["flags"].dump(), HasSubstr("level off plan: 26")) << point;
  }
}

class ExcitationKilled : public testing::TestWithParam<int> {};

TEST_P(ExcitationKilled, LeavesTheOutputOff) {
  const auto folder = fresh_folder("excitation-killed-" + std::to_string(GetParam()));
  LiveBench bench(folder, settings_with("level_per_volt = 50.0\n", "1"));
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_TRUE(run.wait_for_error_text("step 1 of 4", patience)) << run.errors();
  ASSERT_TRUE(bench.wait_for_output("ON"));
  run.send(GetParam());
  ASSERT_TRUE(run.wait(patience));
  EXPECT_TRUE(bench.wait_for_output("OFF"));
}

INSTANTIATE_TEST_SUITE_P(Signals, ExcitationKilled,
                         testing::Values(SIGINT, SIGTERM, SIGKILL, SIGSEGV),
                         [](const auto& signal) {
                           return "Signal" + std::to_string(signal.param);
                         });

// The bench stands still, as when its link is down: nothing answers, and the output stays on.
class LinkDown : public testing::TestWithParam<int> {};

TEST_P(LinkDown, IsSaidAndTheGuardSwitchesOffWhenTheLinkIsBack) {
  const auto folder = fresh_folder("excitation-link-down-" + std::to_string(GetParam()));
  LiveBench bench(folder, settings_with("level_per_volt = 50.0\n", "1"));
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_TRUE(run.wait_for_error_text("step 1 of 4", patience)) << run.errors();
  ASSERT_TRUE(bench.wait_for_output("ON"));
  bench.signal_bench(SIGSTOP);
  run.send(GetParam());
  ASSERT_TRUE(run.wait(patience));
  EXPECT_TRUE(run.wait_for_error_text("MAY BE ON", patience)) << run.errors();
  EXPECT_THAT(run.errors(), testing::Not(HasSubstr("the excitation is off")));
  if (GetParam() == SIGINT) { // a run that is killed says nothing, only its guard does
    EXPECT_THAT(run.errors(),
                testing::ContainsRegex("interrupted; 0 of 4 steps were measured and kept; THE "
                                       "OUTPUT OF THE GENERATOR MAY BE ON: .*; switch it off by "
                                       "hand. A guard goes on trying"));
  }
  bench.signal_bench(SIGCONT);
  EXPECT_TRUE(bench.wait_for_output("OFF"));
}

INSTANTIATE_TEST_SUITE_P(Signals, LinkDown, testing::Values(SIGINT, SIGKILL),
                         [](const auto& signal) {
                           return "Signal" + std::to_string(signal.param);
                         });

// As when a process group or a systemd unit is ended while the generator cannot be reached.
TEST(Excitation, TheGuardOutlivesWhatEndsTheRunAndAllOfItsProcesses) {
  const auto folder = fresh_folder("excitation-group-ended");
  LiveBench bench(folder, settings_with("level_per_volt = 50.0\n", "1"));
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_TRUE(run.wait_for_error_text("step 1 of 4", patience)) << run.errors();
  ASSERT_TRUE(bench.wait_for_output("ON"));
  bench.signal_bench(SIGSTOP);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    EXPECT_TRUE(run.send_to_child("dyncal", signal));
  }
  run.send(SIGKILL);
  ASSERT_TRUE(run.wait(patience));
  EXPECT_TRUE(
      run.wait_for_error_text("the run has ended and the output of the generator", patience))
      << run.errors();
  bench.signal_bench(SIGCONT);
  EXPECT_TRUE(bench.wait_for_output("OFF"));
}

// Standard input of the programs that a test starts.
class OperatorLine {
public:
  OperatorLine() : before_(dup(STDIN_FILENO)) {
    EXPECT_EQ(pipe(ends_.data()), 0);
    dup2(ends_[0], STDIN_FILENO);
  }
  ~OperatorLine() {
    dup2(before_, STDIN_FILENO);
    for (const int number : {before_, ends_[0], ends_[1]}) {
      close(number);
    }
  }
  OperatorLine(const OperatorLine&) = delete;
  OperatorLine& operator=(const OperatorLine&) = delete;
  void confirm(int times = 1) const {
    EXPECT_EQ(write(ends_[1], "\n\n", static_cast<std::size_t>(times)), times);
  }

private:
  int before_;
  std::array<int, 2> ends_{};
};

TEST(Excitation, ByHandFollowsTheOperator) {
  const auto folder = fresh_folder("excitation-by-hand");
  LiveBench bench(folder, settings_with("level_per_volt = 50.0\n", "1"));
  std::ofstream(folder / "hand.toml") << [&] {
    std::ifstream in(bench.bench_file());
    std::string text((std::istreambuf_iterator<char>(in)), {});
    text.replace(text.find("driver = \"scpi\""), 15, "driver = \"by-hand\"");
    text.replace(text.find("[\"40\", \"200\"]"), 13, "[\"40\"]");
    return text.replace(text.find("repetitions = 2"), 15, "repetitions = 1");
  }();
  const OperatorLine operator_line;
  ProgramRun& run = bench.start({"run", folder / "hand.toml", "--output", folder / "result.json"});
  ASSERT_TRUE(
      run.wait_for_error_text("set sine, 40 Hz, 0.4 V amplitude (0.8 V peak to peak)", patience))
      << run.errors();
  for (const char* line : {":SOURce1:FREQuency 40", ":SOURce1:VOLTage 0.8", ":OUTPut1 ON"}) {
    bench.tell_generator(line);
  }
  ASSERT_TRUE(bench.wait_for_output("ON"));
  operator_line.confirm();
  ASSERT_TRUE(run.wait_for_error_text("switch the output off", patience)) << run.errors();
  bench.tell_generator(":OUTPut1 OFF");
  operator_line.confirm();
  EXPECT_EQ(run.wait(patience), 0) << run.errors();
  EXPECT_EQ(read_json(folder / "result.json")["points"].size(), 3U);
}

std::string last_line(const std::string& text) {
  const auto end = text.find_last_not_of('\n');
  return text.substr(text.rfind('\n', end) + 1, end - text.rfind('\n', end));
}

TEST(Excitation, ByHandSaysThatTheOutputMayBeOnUntilTheOperatorHasConfirmed) {
  const auto folder = fresh_folder("excitation-by-hand-interrupted");
  LiveBench bench(folder, settings_with("level_per_volt = 50.0\n", "1"));
  const OperatorLine operator_line;
  ProgramRun& run = bench.start(
      {"run", bench.changed_bench_file("hand.toml", "driver = \"scpi\"", "driver = \"by-hand\"")});
  ASSERT_TRUE(run.wait_for_error_text("switch the output on", patience)) << run.errors();
  run.send(SIGINT);
  EXPECT_EQ(run.wait(patience), 1) << run.errors();
  EXPECT_THAT(run.errors(), HasSubstr("generator: switch the output off, then press Enter"));
  EXPECT_THAT(last_line(run.errors()),
              testing::EndsWith("interrupted; 0 of 4 steps were measured and kept; THE OUTPUT OF "
                                "THE GENERATOR MAY BE ON: nobody has confirmed that it is off; "
                                "switch it off at the generator"));
}

TEST(Excitation, ByHandEndsCleanlyWhenTheOperatorConfirmsAfterAnInterruption) {
  const auto folder = fresh_folder("excitation-by-hand-confirmed");
  LiveBench bench(folder, settings_with("level_per_volt = 50.0\n", "1"));
  const OperatorLine operator_line;
  ProgramRun& run = bench.start(
      {"run", bench.changed_bench_file("hand.toml", "driver = \"scpi\"", "driver = \"by-hand\"")});
  ASSERT_TRUE(run.wait_for_error_text("switch the output on", patience)) << run.errors();
  run.send(SIGINT);
  // That it was switched on after all, and that it is off.
  operator_line.confirm(2);
  EXPECT_EQ(run.wait(patience), 130) << run.errors();
  EXPECT_THAT(last_line(run.errors()), testing::EndsWith("interrupted: the excitation is off; 0 of "
                                                         "4 steps were measured and kept"));
}

} // namespace
} // namespace dyncal::tests
