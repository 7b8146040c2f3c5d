// When the guard of an exciter switches it off, and when not; no real time passes.
#include "services/guard/exciter_guard.hpp"

#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;

class ExciterGuardTest : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant bench_side_ = network_.join("bench");
  bus::Participant conductor_ = network_.join("conductor");
  bus::Writer<wire::Excitation> excitation_ =
      conductor_.writer(bus::topics::excitation, "b1").value();
  bus::Writer<wire::Measurement> measurement_ =
      conductor_.writer(bus::topics::measurement, "b1").value();
  bool reachable_ = true;
  int tries_ = 0;
  std::unique_ptr<ExciterGuard> guard_ = ExciterGuard::create(
                                             bench_side_, "b1", 2s,
                                             [this]() -> Expected<void> {
                                               ++tries_;
                                               if (!reachable_) {
                                                 return fail(ErrorCode::device, "no route to host");
                                               }
                                               return {};
                                             },
                                             clock_)
                                             .value();

  void announce(wire::ExcitationState state, const std::string& bench = "b1") {
    wire::Excitation excitation;
    excitation.bench(bench);
    excitation.run("r1");
    excitation.state(state);
    excitation.window_end_utc_ns(state == wire::EXCITATION_DONE ? 2 : 0);
    excitation_.write(excitation);
  }
  void report(wire::MeasurementState state) {
    wire::Measurement measurement;
    measurement.bench("b1");
    measurement.run("r1");
    measurement.state(state);
    measurement_.write(measurement);
  }
  void pass(std::chrono::nanoseconds time) {
    for (; time > 0ns; time -= 100ms) {
      clock_.advance(std::min<std::chrono::nanoseconds>(time, 100ms));
      guard_->work();
    }
  }
};

TEST_F(ExciterGuardTest, LeavesAnExciterAloneThatIsAttended) {
  for (int i = 0; i < 100; ++i) {
    announce(i < 50 ? wire::EXCITATION_SETTLING : wire::EXCITATION_STEADY);
    pass(1900ms);
  }
  EXPECT_EQ(tries_, 0);
}

TEST_F(ExciterGuardTest, SwitchesOffJustAfterItsLimitAndOnce) {
  announce(wire::EXCITATION_STEADY);
  guard_->work();
  clock_.advance(2s);
  guard_->work();
  EXPECT_EQ(tries_, 0);
  clock_.advance(1ns);
  guard_->work();
  EXPECT_EQ(tries_, 1);
  EXPECT_EQ(guard_->times_switched_off(), 1);
  pass(60s);
  EXPECT_EQ(tries_, 1);
}

TEST_F(ExciterGuardTest, LeavesAnExciterAloneThatIsOff) {
  announce(wire::EXCITATION_STEADY);
  guard_->work();
  announce(wire::EXCITATION_DONE);
  pass(60s);
  EXPECT_EQ(tries_, 0);
}

TEST_F(ExciterGuardTest, SwitchesOffWhereABrokenOffStepIsNotKnownToBeOff) {
  announce(wire::EXCITATION_STEADY);
  guard_->work();
  announce(wire::EXCITATION_ABORTED); // without the end of its window
  pass(3s);
  EXPECT_EQ(tries_, 1);
}

// It hears DDS, but not its generator.
TEST_F(ExciterGuardTest, IsNotContentWithAConductorThatHasLostHoldOfTheGenerator) {
  announce(wire::EXCITATION_STEADY);
  for (int i = 0; i < 3; ++i) {
    pass(1s);
    report(wire::MEASUREMENT_RUNNING);
  }
  EXPECT_EQ(tries_, 1);
}

TEST_F(ExciterGuardTest, GoesOnTryingUntilTheGeneratorAnswers) {
  reachable_ = false;
  announce(wire::EXCITATION_STEADY);
  pass(12s);
  EXPECT_GE(tries_, 9);
  EXPECT_LE(tries_, 11);
  EXPECT_EQ(guard_->times_switched_off(), 0);
  reachable_ = true;
  pass(2s);
  EXPECT_EQ(guard_->times_switched_off(), 1);
}

TEST_F(ExciterGuardTest, StopsTryingWhenTheConductorIsBack) {
  reachable_ = false;
  announce(wire::EXCITATION_STEADY);
  pass(5s);
  const int before = tries_;
  announce(wire::EXCITATION_DONE);
  pass(60s);
  EXPECT_EQ(tries_, before);
}

TEST_F(ExciterGuardTest, WatchesAgainAfterItHasSwitchedOff) {
  for (int silence = 1; silence <= 3; ++silence) {
    announce(wire::EXCITATION_STEADY);
    pass(3s);
    EXPECT_EQ(tries_, silence);
  }
}

TEST_F(ExciterGuardTest, FindsAnExciterThatWasDrivenBeforeItBegan) {
  announce(wire::EXCITATION_STEADY);
  guard_ = ExciterGuard::create(
               bench_side_, "b1", 2s,
               [this]() -> Expected<void> {
                 ++tries_;
                 return {};
               },
               clock_)
               .value();
  pass(3s);
  EXPECT_EQ(tries_, 1);
}

TEST_F(ExciterGuardTest, DoesNotTakeAnotherBenchsExcitationForItsOwn) {
  announce(wire::EXCITATION_STEADY, "b2"); // in the partition of b1
  pass(10s);
  EXPECT_EQ(tries_, 0);
}

} // namespace
} // namespace dyncal::services
