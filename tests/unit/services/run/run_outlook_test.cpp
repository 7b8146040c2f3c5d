#include "services/run/run_outlook.hpp"

#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;
using Kind = RunOutlook::Kind;

class RunOutlookTest : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant runner_ = network_.join("runner");
  bus::Participant other_ = network_.join("other");
  RunCommands commands_ =
      RunCommands::open(runner_, clock_, "b", "r1", {1, 2, 4}, std::make_shared<bus::WakeUp>())
          .value();
  bus::Writer<wire::Command> writer_ = other_.writer(bus::topics::command, "b").value();

  static wire::ServiceStatus status(wire::ArmState arm, wire::HealthState health = wire::HEALTH_OK,
                                    const std::string& message = "") {
    wire::ServiceStatus status;
    status.service("analysis@lab:7");
    status.arm(arm);
    status.health(health);
    status.message(message);
    return status;
  }
  void command(wire::CommandKind kind, const std::string& run = "r1",
               const std::string& target = "conductor", std::uint32_t step = 0) {
    wire::Command command;
    command.bench("b");
    command.target(target);
    command.kind(kind);
    command.run(run);
    command.sender("ada@desk");
    command.step(step);
    writer_.write(command);
    commands_.take();
  }
  [[nodiscard]] RunOutlook look(const wire::ServiceStatus& analysis,
                                std::chrono::nanoseconds unheard = 0s) const {
    return run_outlook(analysis, "of the analysis", unheard, commands_);
  }
};

TEST_F(RunOutlookTest, IsWellWithAnArmedAnalysisThatWasHeardLately) {
  EXPECT_EQ(look(status(wire::ARM_ARMED), attention_limit).kind, Kind::well);
}

TEST_F(RunOutlookTest, WaitsForAnAnalysisThatIsSilentAndForNoneThatHasEndedTheRun) {
  const RunOutlook silent = look(status(wire::ARM_ARMED), attention_limit + 1ns);
  EXPECT_EQ(silent.kind, Kind::waits);
  EXPECT_EQ(silent.reason.code, ErrorCode::no_analysis);
  EXPECT_EQ(silent.reason.message, "the analysis service analysis@lab:7 has gone silent");
  EXPECT_EQ(look(status(wire::ARM_FINISHED)).kind, Kind::over);
  const auto refused = status(wire::ARM_REFUSED, wire::HEALTH_FAILED, "in use");
  EXPECT_EQ(look(refused).kind, Kind::over);
  EXPECT_EQ(look(refused, attention_limit + 1ns).kind, Kind::over); // its last word
  EXPECT_EQ(look(refused, attention_limit + 1ns).reason.message, "in use");
}

TEST_F(RunOutlookTest, WaitsForWhatTheAnalysisWaitsForAndEndsWithWhatHasFailed) {
  const RunOutlook waits =
      look(status(wire::ARM_ARMED, wire::HEALTH_WAITING, "source 'dau' is away"));
  EXPECT_EQ(waits.kind, Kind::waits);
  EXPECT_EQ(waits.reason.message, "source 'dau' is away");
  EXPECT_EQ(look(status(wire::ARM_WAITING)).kind, Kind::waits); // it takes the run over
  const RunOutlook failed =
      look(status(wire::ARM_ARMED, wire::HEALTH_FAILED, "step 1: 90 m/s^2 where 10 are planned"));
  EXPECT_EQ(failed.kind, Kind::over);
  EXPECT_EQ(failed.reason.message, "step 1: 90 m/s^2 where 10 are planned");
  // A value of a later contract: whatever it is, it is not known to be well.
  EXPECT_EQ(look(status(wire::ARM_ARMED, static_cast<wire::HealthState>(7))).kind, Kind::over);
}

TEST_F(RunOutlookTest, IsPausedFromThePauseToTheContinuation) {
  command(wire::COMMAND_PAUSE);
  const RunOutlook paused = look(status(wire::ARM_ARMED));
  EXPECT_EQ(paused.kind, Kind::paused);
  EXPECT_EQ(paused.reason.message, "paused by a command of other: 'ada@desk'");
  EXPECT_EQ(look(status(wire::ARM_ARMED), 4s).kind, Kind::waits); // what is limited counts first
  command(wire::COMMAND_CONTINUE);
  EXPECT_EQ(look(status(wire::ARM_ARMED)).kind, Kind::well);
}

TEST_F(RunOutlookTest, IsOverByCommandWhateverElseThereIs) {
  command(wire::COMMAND_ABORT);
  const RunOutlook over = look(status(wire::ARM_ARMED), 100s);
  EXPECT_EQ(over.kind, Kind::over);
  EXPECT_EQ(over.reason.message, "ended by a command of other: 'ada@desk'");
}

TEST_F(RunOutlookTest, LeavesOutCommandsToOthersAndAboutOtherRuns) {
  command(wire::COMMAND_ABORT, "r2");
  command(wire::COMMAND_PAUSE, "r1", "dau");
  command(static_cast<wire::CommandKind>(99));
  command(wire::COMMAND_REPEAT, "r2", "conductor", 4);
  EXPECT_EQ(look(status(wire::ARM_ARMED)).kind, Kind::well);
  EXPECT_TRUE(commands_.take_repeats().empty());
}

} // namespace
} // namespace dyncal::inline run
