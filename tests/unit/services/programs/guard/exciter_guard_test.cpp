// When the guard of an exciter switches it off, and when not; no real time passes.
#include "services/programs/guard/exciter_guard.hpp"

#include "tests/unit/services/programs/guard/guarded_bench.hpp"

namespace dyncal::inline programs::guard_tests {
namespace {

class ExciterGuardTest : public GuardedBench {
protected:
  bus::Writer<wire::Excitation> excitation_ =
      conductor_.writer(bus::topics::excitation, "b1").value();
  bus::Writer<wire::Measurement> measurement_ =
      conductor_.writer(bus::topics::measurement, "b1").value();

  void announce(wire::ExcitationState state, const std::string& bench = "b1") {
    wire::Excitation excitation;
    excitation.bench(bench);
    excitation.run("r1");
    excitation.state(state);
    excitation.frequency_text_hz("40");
    excitation.level_m_s2(20.0);
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
  EXPECT_EQ(guard_->figures().switched_off, 1U);
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
  EXPECT_EQ(guard_->figures().switched_off, 0U);
  EXPECT_TRUE(guard_->figures().may_be_on);
  reachable_ = true;
  pass(2s);
  EXPECT_EQ(guard_->figures().switched_off, 1U);
  EXPECT_FALSE(guard_->figures().may_be_on);
  EXPECT_EQ(guard_->figures().bench, "b1");
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
  guard_ = start();
  pass(3s);
  EXPECT_EQ(tries_, 1);
}

// One power cut takes the conductor's host and its own.
TEST_F(ExciterGuardTest, SwitchesOffWhatWasDrivenBeforeItsHostWentDown) {
  announce(wire::EXCITATION_STEADY);
  pass(1s);
  output_.is_on = true;
  guard_.reset();
  excitation_ = conductor_.writer(bus::topics::excitation, "b2").value(); // what it wrote is gone
  guard_ = start();
  pass(1900ms);
  EXPECT_TRUE(output_.is_on);
  pass(300ms);
  EXPECT_FALSE(output_.is_on);
  pass(121s);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path())) << "nothing is driven any more";
}

TEST_F(ExciterGuardTest, WritesOnceAStepWhatIsDrivenAndThatTheRunHasPaused) {
  const std::filesystem::path file = folder_.path() / "b1.json";
  report(wire::MEASUREMENT_RUNNING);
  for (int step = 0; step < 5; ++step) {
    announce(wire::EXCITATION_STEADY);
    pass(300ms);
    report(wire::MEASUREMENT_RUNNING);
    pass(300ms);
    const auto written = std::filesystem::last_write_time(file);
    announce(wire::EXCITATION_DONE);
    pass(1500ms);
    EXPECT_EQ(std::filesystem::last_write_time(file), written) << "step " << step;
  }
  const DrivenRecord record(folder_.path(), "b1", "192.0.2.7:5025");
  EXPECT_FALSE(record.read().has_ended);
  pass(1s); // it pauses
  EXPECT_TRUE(record.read().has_ended);
  announce(wire::EXCITATION_STEADY);
  pass(300ms);
  EXPECT_FALSE(record.read().has_ended);
  announce(wire::EXCITATION_DONE);
  report(wire::MEASUREMENT_DONE);
  pass(300ms);
  EXPECT_TRUE(record.read().has_ended) << "at once where the run is over";
}

// The power fails between two steps.
TEST_F(ExciterGuardTest, SwitchesOffWhatWasAboutToBeDrivenWhenItsHostWentDown) {
  report(wire::MEASUREMENT_RUNNING);
  announce(wire::EXCITATION_STEADY);
  pass(500ms);
  report(wire::MEASUREMENT_RUNNING);
  pass(300ms);
  announce(wire::EXCITATION_DONE);
  pass(500ms);
  for (const bool is_on : {false, true}) {
    output_.is_on = is_on;
    guard_.reset();
    excitation_ = conductor_.writer(bus::topics::excitation, "b2").value(); // what it wrote is gone
    measurement_ = conductor_.writer(bus::topics::measurement, "b2").value();
    guard_ = start();
    pass(3500ms);
    EXPECT_FALSE(output_.is_on);
    EXPECT_EQ(tries_, is_on ? 1 : 0);
  }
}

TEST_F(ExciterGuardTest, SaysWhatItLeavesOn) {
  announce(wire::EXCITATION_STEADY);
  pass(100ms);
  announce(wire::EXCITATION_DONE);
  output_.is_on = true;
  output_.settings = {100.0, 0.8};
  pass(2s);
  wire::ServiceStatus last;
  status_.take([&](const wire::ServiceStatus& one) { last = one; });
  EXPECT_EQ(last.message(), "the output of the generator is on (100 Hz, 0.8 V peak to peak), which "
                            "is not what run r1 drove: it is left on");
  EXPECT_EQ(last.health(), wire::HEALTH_OK);
  EXPECT_EQ(tries_, 0);
}

TEST_F(ExciterGuardTest, NamesTheRunThatItDoesNotHear) {
  const auto newest = [this] {
    wire::ServiceStatus last;
    status_.take([&](const wire::ServiceStatus& one) { last = one; });
    return last.run().to_string();
  };
  announce(wire::EXCITATION_STEADY);
  pass(1900ms);
  EXPECT_EQ(newest(), "");
  pass(300ms);
  EXPECT_EQ(newest(), "r1");
  announce(wire::EXCITATION_DONE);
  pass(100ms);
  EXPECT_EQ(newest(), "");
}

TEST_F(ExciterGuardTest, SaysEverySecondThatItIsThere) {
  int heard = 0;
  for (int i = 0; i < 100; ++i) {
    pass(100ms);
    status_.take([&](const wire::ServiceStatus& status) {
      ++heard;
      EXPECT_EQ(status.service().to_string(), "guard@lab-2:7");
      EXPECT_EQ(status.run().to_string(), "");
      EXPECT_EQ(status.guarded_generator(), "192.0.2.7:5025");
      EXPECT_EQ(status.health(), wire::HEALTH_OK);
      EXPECT_EQ(status.published_utc_ns(), clock_.utc_now_ns());
    });
  }
  EXPECT_EQ(heard, 10);
}

TEST_F(ExciterGuardTest, TellsOfAnOutputThatItCannotSwitchOffUntilItIs) {
  const auto newest = [this] {
    wire::ServiceStatus last;
    status_.take([&](const wire::ServiceStatus& one) { last = one; });
    return last;
  };
  reachable_ = false;
  announce(wire::EXCITATION_STEADY);
  pass(3s);
  wire::ServiceStatus status = newest();
  EXPECT_EQ(status.health(), wire::HEALTH_FAILED);
  EXPECT_EQ(status.message(), "nothing is heard of run r1, and THE OUTPUT OF THE GENERATOR MAY BE "
                              "ON: switch it off by hand if you can; trying again until it is off "
                              "(no route to host)");
  reachable_ = true;
  pass(2s);
  status = newest();
  EXPECT_EQ(status.health(), wire::HEALTH_OK);
  EXPECT_EQ(status.message(), "nothing was heard of run r1 while its exciter was driven; the "
                              "output of the generator was switched off");
  announce(wire::EXCITATION_SETTLING);
  pass(100ms);
  EXPECT_EQ(newest().message(), "");
}

TEST_F(ExciterGuardTest, DoesNotTakeAnotherBenchsExcitationForItsOwn) {
  announce(wire::EXCITATION_STEADY, "b2"); // in the partition of b1
  pass(10s);
  EXPECT_EQ(tries_, 0);
}

} // namespace
} // namespace dyncal::inline programs::guard_tests
