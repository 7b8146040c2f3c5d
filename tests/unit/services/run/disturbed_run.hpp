// A run of three steps in stepped time, and what is around it: an analysis that reports twice a
// second and publishes a result for each step that is over, another one that may stand by, an
// operator's commands, a generator. Tests make them silent or send them away. One thread.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "services/run/run_controller.hpp"
#include "tests/unit/services/run/played_analysis.hpp"
#include "tests/unit/services/run/played_generator.hpp"
#include "tests/unit/services/run/two_steps.hpp"

namespace dyncal::inline run::run_tests {

using namespace std::chrono_literals;

inline constexpr const char* bench_name = "b";
inline constexpr const char* run_name = "r1";

using Attempt = std::pair<std::uint32_t, std::uint32_t>; // step, attempt

class DisturbedRun : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  tests::PlayedAnalysis analysis_{network_, bench_name, run_name};
  tests::PlayedAnalysis standby_{network_, bench_name, run_name, "analysis@test:2"};
  bus::Participant participant_ = network_.join("runner");
  bus::Participant operator_ = network_.join("operator");
  bus::Writer<wire::Command> commands_ = operator_.writer(bus::topics::command, bench_name).value();
  tests::PlayedInstrument instrument_{clock_};
  BenchFile bench_ = bench();
  std::stop_source stop_;

  // The analysis: reports twice a second unless it is silent, and publishes what `evaluate` makes
  // of a step as soon as its excitation is over.
  bool silent_ = false;
  bool standby_serves_ = false;
  bool finished_ = false;
  wire::HealthState health_ = wire::HEALTH_OK;
  std::string message_;
  std::function<wire::CalibrationResult(Attempt)> evaluate_ = [](Attempt attempt) {
    return good(attempt);
  };
  std::map<std::uint32_t, wire::CalibrationResult> published_; // by step
  std::chrono::nanoseconds reported_{};
  // What was seen on the way.
  std::vector<Attempt> excited_; // every attempt that was announced to be on
  std::vector<Attempt> aborted_;
  std::vector<std::uint32_t> repeated_steps_; // as announced last
  wire::MeasurementState state_ = wire::MEASUREMENT_PLANNED;
  std::vector<std::string> messages_; // of the Measurement
  std::vector<std::string> notices_;
  std::chrono::nanoseconds longest_unattended_{}; // output on, and nothing heard for so long
  bool began_unattended_ = false;
  bool was_on_ = false;

  static BenchFile bench() {
    BenchFile bench = tests::bench_of_two_steps(bench_name);
    bench.excitation.frequencies_hz.push_back("125");
    bench.excitation.levels_m_s2.push_back(10.0);
    return bench;
  }
  static wire::CalibrationResult good(Attempt attempt) {
    wire::CalibrationResult result;
    result.channel("dau/acceleration_x");
    result.step(attempt.first);
    result.attempt(attempt.second);
    result.valid(true);
    return result;
  }
  static wire::CalibrationResult lossy(Attempt attempt) {
    wire::CalibrationResult result = good(attempt);
    result.lost(50);
    return result;
  }

  void SetUp() override {
    clock_.every(100ms, [this] { follow_run(); });
    clock_.every(500ms, [this] { report(); });
    clock_.every(10ms, [this] { watch_output(); });
  }
  void report() {
    if (finished_) {
      return;
    }
    if (!silent_) {
      reported_ = clock_.elapsed();
      analysis_.report(wire::ARM_ARMED, health_, message_);
    } else if (standby_serves_) {
      reported_ = clock_.elapsed();
      standby_.report(wire::ARM_ARMED, health_, message_);
    }
  }
  void follow_run() {
    for (const wire::Measurement& measurement : analysis_.measurements()) {
      state_ = measurement.state();
      if (!measurement.message().empty() &&
          (messages_.empty() || messages_.back() != measurement.message())) {
        messages_.push_back(measurement.message());
      }
    }
    for (const wire::Excitation& excitation : analysis_.excitations()) {
      follow(excitation);
    }
    const bool over = state_ == wire::MEASUREMENT_DONE || state_ == wire::MEASUREMENT_ABORTED;
    if (over && !finished_ && !silent_) {
      finished_ = true;
      analysis_.report(wire::ARM_FINISHED);
    }
  }
  void follow(const wire::Excitation& excitation) {
    const Attempt attempt{excitation.step(), excitation.attempt()};
    repeated_steps_ = excitation.repeated_steps();
    const bool over = excitation.state() == wire::EXCITATION_DONE ||
                      excitation.state() == wire::EXCITATION_ABORTED;
    if (excited_.empty() || excited_.back() != attempt) {
      excited_.push_back(attempt);
    }
    if (excitation.state() == wire::EXCITATION_ABORTED) {
      aborted_.push_back(attempt);
    }
    const auto known = published_.find(attempt.first);
    if (over && (known == published_.end() || known->second.attempt() < attempt.second)) {
      published_[attempt.first] = evaluate_(attempt);
      if (published_[attempt.first].step() != 0) {
        (silent_ && standby_serves_ ? standby_ : analysis_).publish(published_[attempt.first]);
      }
    }
  }
  void watch_output() {
    if (instrument_.on) {
      longest_unattended_ = std::max(longest_unattended_, clock_.elapsed() - reported_);
      began_unattended_ =
          began_unattended_ || (!was_on_ && clock_.elapsed() - reported_ > attention_limit);
    }
    was_on_ = instrument_.on;
  }
  void command(wire::CommandKind kind, std::uint32_t step = 0) {
    wire::Command command;
    command.bench(bench_name);
    command.target("conductor");
    command.kind(kind);
    command.run(run_name);
    command.sender("ada@desk");
    command.step(step);
    commands_.write(command);
  }
  void silent_between(std::chrono::nanoseconds begin, std::chrono::nanoseconds end) {
    clock_.at(begin, [this] { silent_ = true; });
    clock_.at(end, [this] { silent_ = false; });
  }
  void away_between(std::chrono::nanoseconds begin, std::chrono::nanoseconds end) {
    clock_.at(begin, [this] { instrument_.away = true; });
    clock_.at(end, [this] { instrument_.away = false; });
  }
  Expected<RunOutcome> try_to_resume() { return controller().resume({}, stop_.get_token()); }
  RunController controller() {
    return {{participant_, clock_, tests::connect_to(instrument_)},
            bench_,
            run_name,
            [this](const RunProgress& progress) {
              if (!progress.notice.empty()) {
                notices_.push_back(progress.notice);
              }
            }};
  }
  RunOutcome conduct() {
    auto outcome = controller().conduct({}, stop_.get_token());
    EXPECT_TRUE(outcome) << outcome.error().message;
    return outcome.value_or(RunOutcome{});
  }
  [[nodiscard]] static std::vector<std::uint32_t> attempts_of(const RunOutcome& outcome) {
    std::vector<std::uint32_t> attempts;
    for (const StepResult& result : outcome.results) {
      attempts.push_back(result.attempt);
    }
    return attempts;
  }
};

} // namespace dyncal::inline run::run_tests
