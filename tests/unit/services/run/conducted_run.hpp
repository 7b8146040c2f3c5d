// A conductor against an analysis service and a generator that the test plays, in stepped time. One
// thread.
#pragma once

#include <algorithm>
#include <string>
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
inline constexpr auto look = 200ms; // between two looks at the messages

class ConductedRun : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  tests::PlayedAnalysis analysis_{network_, bench_name, run_name};
  bus::Participant participant_ = network_.join("runner");
  tests::PlayedInstrument instrument_{clock_};
  BenchFile bench_ = bench();
  std::stop_source stop_;
  std::vector<std::string> phases_;
  std::vector<std::string> notices_;

  static BenchFile bench() {
    BenchFile bench = tests::bench_of_two_steps(bench_name);
    bench.method.dut = {{"dau", "acceleration_x"}, {"dau", "acceleration_y"}};
    return bench;
  }

  Expected<RunOutcome> conduct() {
    RunController controller({participant_, clock_, tests::connect_to(instrument_)}, bench_,
                             run_name, [this](const RunProgress& progress) {
                               phases_.push_back(progress.phase);
                               if (!progress.notice.empty()) {
                                 notices_.push_back(progress.notice);
                               }
                             });
    auto outcome = controller.conduct({}, stop_.get_token());
    EXPECT_FALSE(instrument_.on);
    return outcome;
  }
  [[nodiscard]] bool was_excited() const {
    return std::find(instrument_.settings.begin(), instrument_.settings.end(), "on") !=
           instrument_.settings.end();
  }
  [[nodiscard]] wire::Measurement last_published() {
    const auto measurements = analysis_.measurements();
    return measurements.empty() ? wire::Measurement{} : measurements.back();
  }
  [[nodiscard]] wire::MeasurementState published_state() { return last_published().state(); }
  // Arms at once and reports every second from then on, until `finish` is called.
  void play_analysis() {
    clock_.at(100ms, [this] { analysis_.report(wire::ARM_ARMED); });
    clock_.every(1s, [this] {
      if (!finished_) {
        analysis_.report(wire::ARM_ARMED, failure_);
      }
    });
  }
  void finish() {
    finished_ = true;
    analysis_.report(wire::ARM_FINISHED, failure_);
  }
  bool finished_ = false;
  std::string failure_;
};

} // namespace dyncal::inline run::run_tests
