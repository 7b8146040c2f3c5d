#include "services/network/bus_state.hpp"

#include <gtest/gtest.h>

#include "services/base/printable_text.hpp"
#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"
#include "services/network/bus_readers.hpp"
#include "tests/unit/services/network/messages.hpp"

namespace dyncal::network {
namespace {

using namespace std::chrono_literals;

class BusStateTest : public testing::Test {
protected:
  void pass(std::chrono::nanoseconds time) {
    clock_.advance(time);
    laboratory_.work();
  }
  [[nodiscard]] const Bench& bench(const std::string& name = "acc-1") const {
    const Bench* found = laboratory_.bench(name);
    if (found == nullptr) {
      throw std::runtime_error("the bench " + name + " is not held");
    }
    return *found;
  }
  [[nodiscard]] BenchState state() const { return state_of(bench(), clock_.now()); }
  [[nodiscard]] Condition worst() const { return condition_of(bench(), clock_.now()); }
  void plan(wire::MeasurementState state, const std::string& message = "") {
    wire::Measurement measurement = measurement_of("acc-1", "r1", state);
    measurement.message(message);
    laboratory_.take(measurement);
  }
  void excite(std::uint32_t step, wire::ExcitationState state) {
    laboratory_.take(excitation_of("acc-1", "r1", step, state));
  }
  [[nodiscard]] bool has_event(Severity severity, const std::string& part) const {
    for (const Event& event : bench().events) {
      if (event.severity == severity && event.text.find(part) != std::string::npos) {
        return true;
      }
    }
    return false;
  }

  mutable bus::SteppedClock clock_;
  BusState laboratory_{clock_};
};

TEST_F(BusStateTest, HoldsNothingBeforeAnythingIsHeard) {
  laboratory_.work();
  EXPECT_TRUE(laboratory_.benches().empty());
  EXPECT_EQ(laboratory_.bench("acc-1"), nullptr);
  EXPECT_EQ(laboratory_.number(), 0U);
}

TEST_F(BusStateTest, FollowsARunThroughItsStates) {
  laboratory_.take(status_of("acc-1", "dau"));
  EXPECT_EQ(state(), BenchState::idle);
  plan(wire::MEASUREMENT_PLANNED);
  EXPECT_EQ(state(), BenchState::arming);
  plan(wire::MEASUREMENT_RUNNING);
  EXPECT_EQ(state(), BenchState::running);
  plan(wire::MEASUREMENT_RUNNING, "paused by a command of 'x'");
  EXPECT_EQ(state(), BenchState::paused);
  EXPECT_EQ(worst().severity, Severity::warning);
  EXPECT_EQ(worst().what, "paused: paused by a command of 'x'");
  plan(wire::MEASUREMENT_RUNNING);
  plan(wire::MEASUREMENT_DONE);
  EXPECT_EQ(state(), BenchState::done);
  EXPECT_EQ(worst().severity, Severity::ok) << worst().what;
  EXPECT_TRUE(has_event(Severity::warning, "paused by a command"));
}

TEST_F(BusStateTest, NamesTheReasonOfAnAbortedRun) {
  plan(wire::MEASUREMENT_RUNNING);
  plan(wire::MEASUREMENT_ABORTED, "the source dau is away");
  EXPECT_EQ(state(), BenchState::aborted);
  EXPECT_EQ(worst().severity, Severity::error);
  EXPECT_EQ(worst().what, "run aborted: the source dau is away");
  EXPECT_TRUE(has_event(Severity::error, "the source dau is away"));
}

TEST_F(BusStateTest, PausesWhileTheAnalysisWaits) {
  plan(wire::MEASUREMENT_RUNNING);
  laboratory_.take(analysis_of("acc-1", "r1", wire::ARM_ARMED));
  wire::ServiceStatus status = analysis_of("acc-1", "r1", wire::ARM_ARMED, wire::HEALTH_WAITING);
  status.message("no samples of dau");
  laboratory_.take(status);
  EXPECT_EQ(state(), BenchState::paused);
  EXPECT_EQ(worst().what, "paused: no samples of dau");
  EXPECT_TRUE(has_event(Severity::warning, "no samples of dau"));
  status.health(wire::HEALTH_OK);
  status.message("two programs send as dau");
  laboratory_.take(status);
  EXPECT_EQ(worst().severity, Severity::note);
  EXPECT_EQ(worst().what, "two programs send as dau");
}

TEST_F(BusStateTest, IsSilentBeforeThreeSecondsAndGoneAfterAMinute) {
  laboratory_.take(status_of("acc-1", "dau"));
  pass(2500ms);
  EXPECT_EQ(state(), BenchState::idle);
  pass(100ms);
  EXPECT_EQ(state(), BenchState::silent);
  EXPECT_EQ(worst().severity, Severity::stale);
  EXPECT_EQ(worst().what, "nothing heard for 2 s");
  EXPECT_TRUE(has_event(Severity::stale, "dau has gone silent"));
  pass(58s);
  EXPECT_EQ(state(), BenchState::gone);
  laboratory_.take(status_of("acc-1", "dau"));
  laboratory_.work();
  EXPECT_EQ(state(), BenchState::idle);
  EXPECT_EQ(worst().severity, Severity::ok);
  EXPECT_TRUE(has_event(Severity::note, "dau is heard again"));
}

TEST_F(BusStateTest, ShowsASilentSourceWhileOthersGoOn) {
  laboratory_.take(status_of("acc-1", "acs"));
  laboratory_.take(status_of("acc-1", "dau"));
  const std::uint64_t number = laboratory_.number();
  for (int i = 0; i < 8; ++i) {
    pass(500ms);
    laboratory_.take(status_of("acc-1", "acs"));
  }
  EXPECT_EQ(state(), BenchState::idle);
  EXPECT_TRUE(bench().sources.at("dau").is_silent);
  EXPECT_EQ(worst().severity, Severity::stale);
  EXPECT_EQ(worst().what, "dau: not heard for 4 s");
  EXPECT_GT(laboratory_.number(), number);
}

TEST_F(BusStateTest, DoesNotMindTheSilenceOfAnEndedSource) {
  laboratory_.take(status_of("acc-1", "dau", wire::SOURCE_ENDED));
  for (int i = 0; i < 8; ++i) {
    pass(500ms);
    laboratory_.take(status_of("acc-1", "acs"));
  }
  EXPECT_EQ(worst().severity, Severity::ok) << worst().what;
}

TEST_F(BusStateTest, IsSilentWhenTheConductorIs) {
  plan(wire::MEASUREMENT_RUNNING);
  for (int i = 0; i < 11; ++i) {
    pass(500ms);
    laboratory_.take(status_of("acc-1", "dau"));
  }
  EXPECT_EQ(state(), BenchState::silent);
  EXPECT_EQ(worst().what, "the conductor lab-1:77 has not been heard for 5 s");
  EXPECT_FALSE(bench().current_run()->time_left_s(clock_.now()));
  plan(wire::MEASUREMENT_RUNNING);
  EXPECT_EQ(state(), BenchState::running);
}

TEST_F(BusStateTest, CountsTheTimeThatIsLeft) {
  plan(wire::MEASUREMENT_RUNNING);
  const auto& run = *bench().current_run();
  EXPECT_DOUBLE_EQ(run.time_left_s(clock_.now()).value(), 20.0);
  excite(1, wire::EXCITATION_SETTLING);
  pass(1s);
  excite(1, wire::EXCITATION_STEADY);
  pass(2s);
  excite(1, wire::EXCITATION_STEADY);
  EXPECT_DOUBLE_EQ(run.time_left_s(clock_.now()).value(), 17.0);
  excite(1, wire::EXCITATION_DONE);
  EXPECT_DOUBLE_EQ(run.time_left_s(clock_.now()).value(), 10.0);
  EXPECT_EQ(run.steps_done(), 1U);
  excite(2, wire::EXCITATION_SETTLING);
  plan(wire::MEASUREMENT_RUNNING); // repeated: the steps keep their states
  EXPECT_EQ(run.plan->steps.at(0).state, StepState::done);
  EXPECT_EQ(run.plan->steps.at(1).state, StepState::settling);
  EXPECT_EQ(run.now->step.duration_s, 8.0);
}

TEST_F(BusStateTest, TakesStepsBeforeTheFirstThatIsHeardAsDone) {
  plan(wire::MEASUREMENT_RUNNING);
  excite(2, wire::EXCITATION_STEADY);
  EXPECT_EQ(bench().current_run()->plan->steps.at(0).state, StepState::done);
}

TEST_F(BusStateTest, KeepsTheNewestResultButNoneOfAnEarlierAttempt) {
  laboratory_.take(result_of("acc-1", "r1", 1, 0.9));
  const std::uint64_t first = bench().runs.at("r1").results_number;
  wire::CalibrationResult again = result_of("acc-1", "r1", 1, 1.1);
  again.attempt(2);
  laboratory_.take(again);
  laboratory_.take(result_of("acc-1", "r1", 1, 0.9));
  const auto& run = bench().runs.at("r1");
  ASSERT_EQ(run.results.size(), 1U);
  EXPECT_EQ(run.results.begin()->second.magnitude, 1.1);
  EXPECT_EQ(run.results_number, first + 1);
}

TEST_F(BusStateTest, WarnsOfAResultWithoutAValueOnce) {
  wire::CalibrationResult result = result_of("acc-1", "r1", 1, 0.0);
  result.valid(false);
  result.problem("the step was not found in dau");
  laboratory_.take(result);
  laboratory_.take(result);
  EXPECT_EQ(worst().what, "1 results without a value");
  EXPECT_EQ(bench().events.size(), 1U);
  EXPECT_TRUE(has_event(Severity::warning, "the step was not found in dau"));
}

TEST_F(BusStateTest, TakesTheStateOfARunFromTheAnalysisWhereTheConductorHasLeft) {
  laboratory_.take(result_of("acc-1", "r1", 1, 0.9));
  EXPECT_EQ(state(), BenchState::idle);
  laboratory_.take(analysis_of("acc-1", "r1", wire::ARM_FINISHED));
  EXPECT_EQ(state(), BenchState::done);
  laboratory_.take(analysis_of("acc-1", "r2", wire::ARM_ARMED));
  EXPECT_EQ(state(), BenchState::running) << "its name is the later one";
}

TEST_F(BusStateTest, ShowsTheRunThatIsConductedBeforeNewerOnes) {
  laboratory_.take(measurement_of("acc-1", "a", wire::MEASUREMENT_RUNNING, 10));
  laboratory_.take(measurement_of("acc-1", "b", wire::MEASUREMENT_ABORTED, 20));
  EXPECT_EQ(bench().current_run()->name, "a");
  laboratory_.take(measurement_of("acc-1", "a", wire::MEASUREMENT_DONE, 10));
  EXPECT_EQ(bench().current_run()->name, "b");
}

// The clock of the second one's conductor is an hour behind that of the first one's.
TEST_F(BusStateTest, TheNewestRunIsTheOneHeardOfLastWhateverTheClocksOfConductors) {
  constexpr std::int64_t hour_ns = 3'600'000'000'000;
  laboratory_.take(measurement_of("acc-1", "z", wire::MEASUREMENT_DONE, 2 * hour_ns));
  laboratory_.take(measurement_of("acc-1", "y", wire::MEASUREMENT_RUNNING, hour_ns));
  EXPECT_EQ(bench().current_run()->name, "y");
  laboratory_.take(measurement_of("acc-1", "y", wire::MEASUREMENT_DONE, hour_ns));
  EXPECT_EQ(bench().current_run()->name, "y");
  wire::ServiceStatus ahead = analysis_of("acc-1", "z", wire::ARM_FINISHED); // of a third clock
  ahead.published_utc_ns(5 * hour_ns);
  laboratory_.take(ahead);
  EXPECT_EQ(bench().current_run()->name, "y");
}

TEST_F(BusStateTest, TakesTheOrderOfRunsThatWereOverFromTheirAnalysis) {
  wire::ServiceStatus newer = analysis_of("acc-1", "newer", wire::ARM_FINISHED);
  newer.published_utc_ns(3'000);
  laboratory_.take(newer);
  laboratory_.take(analysis_of("acc-1", "older", wire::ARM_FINISHED));
  EXPECT_EQ(bench().current_run()->name, "newer");
  wire::ServiceStatus behind = analysis_of("acc-1", "another", wire::ARM_FINISHED);
  behind.service("dyncal-analysis:1@lab-2");
  behind.published_utc_ns(1);
  laboratory_.take(behind);
  EXPECT_EQ(bench().current_run()->name, "another") << "two hosts: by when it was heard of";
}

TEST_F(BusStateTest, WarnsOfLossesForAWhile) {
  laboratory_.take(status_of("acc-1", "dau", wire::SOURCE_RUNNING, 5));
  EXPECT_EQ(worst().severity, Severity::note) << "lost before we listened";
  laboratory_.take(status_of("acc-1", "dau", wire::SOURCE_RUNNING, 6));
  EXPECT_EQ(worst().severity, Severity::warning);
  EXPECT_EQ(worst().what, "dau: 6 samples lost");
  for (int i = 0; i < 31; ++i) {
    pass(1s);
    laboratory_.take(status_of("acc-1", "dau", wire::SOURCE_RUNNING, 6));
  }
  EXPECT_EQ(worst().severity, Severity::note);
  EXPECT_EQ(bench().lost(), 6U);
}

TEST_F(BusStateTest, CountsLossesOfARestartedSourceFromItsFirstStatus) {
  laboratory_.take(status_of("acc-1", "dau"));
  wire::SourceDescription description;
  description.bench("acc-1");
  description.source("dau");
  description.session(8);
  laboratory_.take(description); // before the status, as services do
  wire::SourceStatus status = status_of("acc-1", "dau", wire::SOURCE_RUNNING, 5);
  status.session(8);
  laboratory_.take(status);
  EXPECT_EQ(worst().severity, Severity::note) << "lost before we listened to this session";
  const Source& dau = bench().sources.at("dau");
  EXPECT_EQ(dau.first_counts.lost_on_way, 5U);
  EXPECT_FALSE(dau.turns.twins()) << "a restart";
  for (const std::uint64_t session : {7U, 8U, 7U}) {
    status.session(session);
    laboratory_.take(status);
  }
  EXPECT_TRUE(bench().sources.at("dau").turns.twins());
}

TEST_F(BusStateTest, ShowsWhatARecorderMisses) {
  wire::ServiceStatus status;
  status.bench("acc-1");
  status.service("dyncal-recorder:3@lab-1");
  status.recording("/data/acc-1/r1.mcap");
  status.message("the disk is full");
  status.messages_not_stored(3);
  laboratory_.take(status);
  EXPECT_EQ(worst().what, "recorder: the disk is full");
  ASSERT_NE(bench().recorder(), nullptr);
  EXPECT_TRUE(bench().runs.empty()) << "a recorder serves no run";
}

TEST_F(BusStateTest, TakesOfTheTopicOfRecordersNothingButRecorders) {
  wire::ServiceStatus status = analysis_of("acc-1", "r1", wire::ARM_FINISHED);
  laboratory_.take_of_recorder(status);
  EXPECT_EQ(laboratory_.bench("acc-1"), nullptr) << "an analysis";
  status.recording("/data/acc-1/r1.mcap");
  laboratory_.take_of_recorder(status);
  EXPECT_EQ(laboratory_.bench("acc-1"), nullptr) << "in the name of an analysis";
  status.service("recorder@lab-1:3");
  status.guarded_generator("192.0.2.7:5025");
  laboratory_.take_of_recorder(status);
  ASSERT_NE(bench().recorder(), nullptr);
  EXPECT_FALSE(bench().services.at("recorder@lab-1:3").is_guard());
  EXPECT_TRUE(bench().runs.empty()) << "a recorder serves no run";
}

TEST_F(BusStateTest, ShowsAGuardThatCannotSwitchOff) {
  wire::ServiceStatus status;
  status.bench("acc-1");
  status.service("guard@lab-2:7");
  status.guarded_generator("192.0.2.7:5025");
  laboratory_.take(status);
  EXPECT_EQ(worst().severity, Severity::ok);
  status.health(wire::HEALTH_FAILED);
  status.message("the output may be on");
  laboratory_.take(status);
  EXPECT_EQ(worst().severity, Severity::error);
  EXPECT_EQ(worst().what, "guard: the output may be on");
  EXPECT_EQ(bench().events.back().text, "guard: the output may be on");
  EXPECT_TRUE(bench().runs.empty()) << "a guard serves no run";
  EXPECT_EQ(bench().recorder(), nullptr);
}

TEST_F(BusStateTest, HoldsNoMoreBenchesThanItsLimitWhateverIsWritten) {
  const Limits limits;
  laboratory_.take(status_of("acc-1", "dau"));
  for (int i = 0; i < 10'000; ++i) {
    laboratory_.take(status_of("flood-" + std::to_string(i), "dau"));
  }
  EXPECT_EQ(laboratory_.benches().size(), limits.benches);
  EXPECT_EQ(laboratory_.left_out().benches, 10'000 - (limits.benches - 1));
  EXPECT_NE(laboratory_.bench("acc-1"), nullptr);
  pass(61s);
  laboratory_.take(status_of("acc-2", "dau"));
  EXPECT_NE(laboratory_.bench("acc-2"), nullptr) << "takes the place of one that is gone";
  EXPECT_EQ(laboratory_.benches().size(), limits.benches);
}

TEST_F(BusStateTest, HoldsNoMoreOfABenchThanItsLimits) {
  const Limits limits{.sources = 3,
                      .services = 2,
                      .runs = 2,
                      .results_of_run = 4,
                      .results = 6,
                      .channels = 5,
                      .steps = 1,
                      .events = 3};
  BusState small(clock_, limits);
  for (std::uint32_t i = 1; i <= 50; ++i) {
    const std::string name = std::to_string(i);
    small.take(status_of("acc-1", name));
    small.take(measurement_of("acc-1", "r1", wire::MEASUREMENT_RUNNING));
    small.take(result_of("acc-1", "r1", i, 1.0));
    small.take(result_of("acc-1", "flood" + name, i, 1.0));
    wire::ServiceStatus service;
    service.bench("acc-1");
    service.service(name);
    small.take(service);
  }
  const Bench& bench = *small.bench("acc-1");
  EXPECT_EQ(bench.sources.size(), 3U);
  EXPECT_EQ(bench.services.size(), 2U);
  EXPECT_EQ(bench.runs.size(), 2U);
  ASSERT_TRUE(bench.runs.contains("r1")) << "a run that is conducted stays";
  EXPECT_EQ(bench.runs.at("r1").results.size(), 4U);
  EXPECT_EQ(bench.runs.at("r1").plan->steps.size(), 1U);
  EXPECT_EQ(bench.events.size(), 3U);
  EXPECT_EQ(small.left_out().sources, 47U);
  EXPECT_EQ(small.left_out().services, 48U);
  EXPECT_GT(small.left_out().results, 0U);
  EXPECT_EQ(small.left_out().runs, 49U);
}

// Services have the number of their process in their names: each restart brings a new one.
TEST_F(BusStateTest, LetsServicesAndSourcesThatAreGoneMakeWay) {
  const Limits limits;
  const auto service_of = [](const std::string& name) {
    wire::ServiceStatus service;
    service.bench("acc-1");
    service.service(name);
    return service;
  };
  for (std::size_t i = 0; i < limits.sources; ++i) {
    laboratory_.take(service_of("analysis@lab-1:" + std::to_string(i)));
    laboratory_.take(status_of("acc-1", "dau-" + std::to_string(i)));
  }
  const std::uint64_t first_left_out = limits.sources - limits.services;
  EXPECT_EQ(laboratory_.left_out().services, first_left_out);
  pass(59s);
  laboratory_.take(service_of("early"));
  laboratory_.take(status_of("acc-1", "early"));
  EXPECT_FALSE(bench().services.contains("early")) << "none is gone";
  EXPECT_FALSE(bench().sources.contains("early"));
  laboratory_.take(service_of("analysis@lab-1:1"));
  laboratory_.take(status_of("acc-1", "dau-1"));
  pass(2s);
  laboratory_.take(service_of("late"));
  laboratory_.take(status_of("acc-1", "late"));
  EXPECT_TRUE(bench().services.contains("late"));
  EXPECT_TRUE(bench().sources.contains("late"));
  EXPECT_TRUE(bench().services.contains("analysis@lab-1:1")) << "heard 2 s ago";
  EXPECT_TRUE(bench().sources.contains("dau-1"));
  EXPECT_EQ(bench().services.size(), limits.services);
  EXPECT_EQ(bench().sources.size(), limits.sources);
  EXPECT_EQ(laboratory_.left_out().services, first_left_out + 2);
  EXPECT_EQ(laboratory_.left_out().sources, 2U);
}

// Of 100 kB, with lines of its own and what steers a terminal.
TEST_F(BusStateTest, HoldsATextOfOthersAsOneShortLine) {
  std::string hostile;
  while (hostile.size() < 100'000) {
    hostile += "\x1b[2Jdone\r\nerror: \xff";
  }
  wire::ServiceStatus guard;
  guard.bench("acc-1");
  guard.service("guard");
  guard.guarded_generator("10.0.0.9:5025");
  guard.message(hostile);
  guard.host(hostile);
  laboratory_.take(guard);
  auto run = measurement_of("acc-1", "r1", wire::MEASUREMENT_RUNNING);
  run.message(hostile);
  laboratory_.take(run);
  std::vector<std::string> texts{bench().services.at("guard").message,
                                 bench().services.at("guard").host, bench().runs.at("r1").message};
  for (const Event& event : bench().events) {
    texts.push_back(event.text);
  }
  EXPECT_GE(texts.size(), 4U);
  for (const std::string& text : texts) {
    EXPECT_LE(text.size(), max_line_bytes);
    EXPECT_EQ(text.find_first_of("\r\n\x1b\xff"), std::string::npos);
    EXPECT_FALSE(text.empty());
  }
}

TEST_F(BusStateTest, RefusesNamesThatNoBenchHas) {
  laboratory_.take(status_of("", "dau"));
  laboratory_.take(status_of("acc-*", "dau"));
  EXPECT_TRUE(laboratory_.benches().empty());
  EXPECT_EQ(laboratory_.left_out().benches, 2U);
}

TEST(BusReaders, FeedALateListenerWithAllThatIsThere) {
  bus::SteppedClock clock;
  bus::MemoryNetwork network{clock};
  bus::Participant there = network.join("there");
  const auto write = [&](const auto& topic, const auto& message) {
    auto writer = there.writer(topic, "acc-1").value();
    writer.write(message);
    return writer;
  };
  const auto status = write(bus::topics::source_status, status_of("acc-1", "dau"));
  const auto plan =
      write(bus::topics::measurement, measurement_of("acc-1", "r1", wire::MEASUREMENT_RUNNING));
  const auto result = write(bus::topics::calibration_result, result_of("acc-1", "r1", 1, 0.9));
  bus::Participant here = network.join("here");
  BusState laboratory(clock);
  auto readers = BusReaders::open(here, "*", {"dyncal-web", "lab-1", 1, "dyncal", "memory"}, clock,
                                  std::make_shared<bus::WakeUp>());
  ASSERT_TRUE(readers);
  readers->work(laboratory);
  const Bench* bench = laboratory.bench("acc-1");
  ASSERT_NE(bench, nullptr);
  EXPECT_EQ(bench->sources.size(), 1U);
  EXPECT_EQ(bench->runs.at("r1").results.size(), 1U);
  EXPECT_EQ(state_of(*bench, clock.now()), BenchState::running);
}

} // namespace
} // namespace dyncal::network
