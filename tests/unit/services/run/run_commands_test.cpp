// Commands come more than once and late; each is obeyed once, and answered.
#include "services/run/run_commands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;

class RunCommandsTest : public testing::Test {
protected:
  void command(wire::CommandKind kind, std::uint64_t id = 0, std::uint32_t step = 0,
               bool excites = true) {
    wire::Command command;
    command.bench("b");
    command.target("conductor");
    command.kind(kind);
    command.run("r1");
    command.sender(comment_);
    command.step(step);
    command.id(id);
    writer_.write(command);
    commands_.take(excites);
  }
  std::string comment_ = "ada@desk";
  // The answer to this command, which is the only one that is to be given.
  std::string answer_to(std::uint64_t id) {
    const auto answer = commands_.take_answer();
    EXPECT_TRUE(answer) << id;
    EXPECT_FALSE(commands_.take_answer());
    EXPECT_EQ(answer.value_or(RunCommands::Answer{}).command, id);
    return answer.value_or(RunCommands::Answer{}).refusal;
  }

  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant runner_ = network_.join("runner");
  bus::Participant other_ = network_.join("other");
  RunCommands commands_ =
      RunCommands::open(runner_, clock_, "b", "r1", {1, 2, 4}, std::make_shared<bus::WakeUp>())
          .value();
  bus::Writer<wire::Command> writer_ = other_.writer(bus::topics::command, "b").value();
};

TEST_F(RunCommandsTest, ALatePauseDoesNotPauseAgainWhatWasContinued) {
  command(wire::COMMAND_PAUSE, 7);
  EXPECT_EQ(answer_to(7), "");
  ASSERT_TRUE(commands_.paused_by());
  EXPECT_EQ(commands_.paused_by()->sentence, "other: 'ada@desk'") << "who it is, and its comment";
  command(wire::COMMAND_CONTINUE, 8);
  EXPECT_EQ(answer_to(8), "");
  for (int i = 0; i < 3; ++i) {
    clock_.advance(10s);
    command(wire::COMMAND_PAUSE, 7);
    EXPECT_EQ(answer_to(7), "") << "who did not hear it asks again";
    EXPECT_FALSE(commands_.paused_by());
  }
  command(wire::COMMAND_PAUSE, 9);
  EXPECT_TRUE(commands_.paused_by());
}

TEST_F(RunCommandsTest, AStepIsRepeatedOnceForEveryCommand) {
  command(wire::COMMAND_REPEAT, 7, 4);
  command(wire::COMMAND_REPEAT, 7, 4);
  EXPECT_EQ(commands_.take_repeats(), (std::set<std::uint32_t>{4}));
  command(wire::COMMAND_REPEAT, 7, 4);
  EXPECT_TRUE(commands_.take_repeats().empty());
  command(wire::COMMAND_REPEAT, 8, 4);
  EXPECT_EQ(commands_.take_repeats(), (std::set<std::uint32_t>{4}));
}

TEST_F(RunCommandsTest, SayWhyTheyAreNotObeyed) {
  command(wire::COMMAND_REPEAT, 7, 3);
  EXPECT_EQ(answer_to(7), "the run's plan has no step 3");
  EXPECT_TRUE(commands_.take_repeats().empty());
  command(static_cast<wire::CommandKind>(99), 8);
  EXPECT_NE(answer_to(8), "");
  command(wire::COMMAND_PAUSE, 9, 0, false);
  EXPECT_EQ(answer_to(9), "the run excites no step any more");
  EXPECT_FALSE(commands_.paused_by());
  command(wire::COMMAND_ABORT, 10, 0, false);
  EXPECT_EQ(answer_to(10), "");
  EXPECT_TRUE(commands_.aborted_by());
}

// Of a run against a table.
TEST_F(RunCommandsTest, RepeatNoStepWhereNoneMayBeExcitedAgain) {
  commands_ =
      RunCommands::open(runner_, clock_, "b", "r1", {}, std::make_shared<bus::WakeUp>()).value();
  command(wire::COMMAND_REPEAT, 7, 1);
  EXPECT_THAT(answer_to(7), testing::HasSubstr("rows of the reference's table"));
  EXPECT_TRUE(commands_.take_repeats().empty());
  command(wire::COMMAND_PAUSE, 8);
  EXPECT_EQ(answer_to(8), "");
  EXPECT_TRUE(commands_.paused_by());
}

TEST_F(RunCommandsTest, OfProgramsWithoutIdsAreObeyedWithoutAnAnswer) {
  command(wire::COMMAND_PAUSE);
  EXPECT_TRUE(commands_.paused_by());
  EXPECT_FALSE(commands_.take_answer());
}

TEST_F(RunCommandsTest, RememberNoMoreThanTheirBound) {
  for (std::uint64_t id = 1; id <= 10 * RunCommands::remembered; ++id) {
    command(wire::COMMAND_PAUSE, id);
  }
  std::size_t answers = 0;
  while (commands_.take_answer()) {
    ++answers;
  }
  EXPECT_EQ(answers, RunCommands::remembered);
}

TEST_F(RunCommandsTest, AStepThatIsAskedForAgainAndAgainIsAskedForOnce) {
  command(wire::COMMAND_REPEAT, 0, 4);
  command(wire::COMMAND_REPEAT, 0, 2);
  command(wire::COMMAND_REPEAT, 0, 4);
  EXPECT_EQ(commands_.take_repeats(), (std::set<std::uint32_t>{2, 4}));
  EXPECT_TRUE(commands_.take_repeats().empty());
}

TEST_F(RunCommandsTest, ACommandThatIsStillRepeatedAsksForNoSecondRepeat) {
  command(wire::COMMAND_REPEAT, 0, 4);
  EXPECT_EQ(commands_.take_repeats().size(), 1U);
  for (int i = 0; i < 10; ++i) { // the step is being excited meanwhile
    clock_.advance(RunCommands::repetition_limit);
    command(wire::COMMAND_REPEAT, 0, 4);
  }
  EXPECT_TRUE(commands_.take_repeats().empty());
  clock_.advance(RunCommands::repetition_limit + 1ns);
  command(wire::COMMAND_REPEAT, 0, 4);
  EXPECT_EQ(commands_.take_repeats().size(), 1U) << "a wish of its own";
}

TEST_F(RunCommandsTest, WhoAsksForARepeatIsAProgramWhateverItCallsItself) {
  command(wire::COMMAND_REPEAT, 0, 4);
  comment_ = "mallory";
  command(wire::COMMAND_REPEAT, 0, 4);
  EXPECT_EQ(commands_.take_repeats().size(), 1U);
  clock_.advance(RunCommands::repetition_limit);
  comment_ = "carol";
  command(wire::COMMAND_REPEAT, 0, 4);
  EXPECT_TRUE(commands_.take_repeats().empty()) << "it is the same command of the same program";
  writer_ = network_.join("third").writer(bus::topics::command, "b").value();
  command(wire::COMMAND_REPEAT, 0, 4);
  EXPECT_EQ(commands_.take_repeats().size(), 1U) << "of another program, by the same words";
}

} // namespace
} // namespace dyncal::inline run
