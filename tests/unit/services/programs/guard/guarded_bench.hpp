// A guard with a generator that the test plays, on a bus in memory, in stepped time. One thread.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"
#include "services/programs/guard/exciter_guard.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline programs::guard_tests {

using namespace std::chrono_literals;

inline const ProgramIdentity own{"dyncal-guard", "lab-2", 7, "dyncal 1", "memory"};

struct PlayedOutput {
  bool reachable = true;
  bool is_on = false;
  OutputSettings settings{40.0, 0.8};
  int tries = 0;
};

class PlayedGeneratorOutput : public GuardedOutput {
public:
  explicit PlayedGeneratorOutput(PlayedOutput& output) : output_(output) {}
  Expected<void> switch_off() override {
    ++output_.tries;
    if (!output_.reachable) {
      return fail(ErrorCode::device, "no route to host");
    }
    output_.is_on = false;
    return {};
  }
  void ask() override { asked_ = true; }
  std::optional<Expected<OutputReading>> answer() override {
    if (!std::exchange(asked_, false)) {
      return std::nullopt;
    }
    if (!output_.reachable) {
      return fail(ErrorCode::device, "no route to host");
    }
    OutputReading reading;
    reading.is_on = output_.is_on;
    reading.settings = output_.settings;
    return reading;
  }

private:
  PlayedOutput& output_;
  bool asked_ = false;
};

class GuardedBench : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant bench_side_ = network_.join("bench");
  bus::Participant conductor_ = network_.join("conductor");
  PlayedOutput output_;
  bool& reachable_ = output_.reachable;
  int& tries_ = output_.tries;
  tests::TemporaryFolder folder_;
  bus::Reader<wire::ServiceStatus> status_ =
      conductor_.reader(bus::topics::service_status, "b1", nullptr).value();
  std::unique_ptr<ExciterGuard> guard_ = start();

  std::unique_ptr<ExciterGuard> start() {
    GuardedExciter exciter;
    exciter.bench = "b1";
    exciter.generator = "192.0.2.7:5025";
    exciter.level_per_volt = 50.0;
    return ExciterGuard::create(
               bench_side_, own, exciter, std::make_unique<PlayedGeneratorOutput>(output_),
               DrivenRecord(folder_.path(), exciter.bench, exciter.generator), clock_)
        .value();
  }
  void pass(std::chrono::nanoseconds time) {
    for (; time > 0ns; time -= 100ms) {
      clock_.advance(std::min<std::chrono::nanoseconds>(time, 100ms));
      guard_->work();
    }
  }
  wire::ServiceStatus newest_status() {
    wire::ServiceStatus last;
    status_.take([&](const wire::ServiceStatus& one) { last = one; });
    return last;
  }
};

} // namespace dyncal::inline programs::guard_tests
