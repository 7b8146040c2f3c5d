// The faults of the memory bus. That it otherwise behaves as the vendors do, bus_exchange_test and
// bus_evolution_test show.
#include "services/bus/memory/memory_network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>

#include "services/contract/topics.hpp"

namespace dyncal::bus {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

// The commands of these tests are numbered by the name of their run.
std::uint32_t number_of(const wire::Command& command) {
  return static_cast<std::uint32_t>(std::stoul(command.run()));
}

class MemoryNetworkTest : public testing::Test {
protected:
  SteppedClock clock_;
  MemoryNetwork network_{clock_};
  Participant sender_ = network_.join("sender");
  std::vector<std::string> warnings_;
  Participant receiver_ =
      network_.join("receiver", [this](const std::string& text) { warnings_.push_back(text); });
  std::shared_ptr<WakeUp> bell_ = std::make_shared<WakeUp>();

  Writer<wire::Command> writer(Profile profile = Profile::command) {
    return sender_.writer<wire::Command>(topics::command, profile, "b").value();
  }
  Reader<wire::Command> reader(Profile profile = Profile::command) {
    return receiver_.reader<wire::Command>(topics::command, profile, "b", bell_).value();
  }
  static wire::Command command(std::uint32_t step, const std::string& target = "dau") {
    wire::Command command;
    command.target(target);
    command.run(std::to_string(step));
    return command;
  }
  static std::vector<std::uint32_t> take(Reader<wire::Command>& reader) {
    std::vector<std::uint32_t> steps;
    reader.take([&](const wire::Command& one) { steps.push_back(number_of(one)); });
    return steps;
  }
  bool rang() { return bell_->wait_until(Clock::Instant::min()); }
};

TEST_F(MemoryNetworkTest, LosesWhatARuleNames) {
  auto writer = this->writer();
  auto reader = this->reader();
  network_.lose([](const MessageInTransit& message) {
    return message.receiver == "receiver" && number_of(message.as<wire::Command>()) == 2;
  });
  for (const std::uint32_t step : {1U, 2U, 3U}) {
    EXPECT_EQ(writer.write(command(step)), WriteOutcome::written);
  }
  EXPECT_TRUE(writer.wait_for_acknowledgments(0s));
  EXPECT_THAT(take(reader), ElementsAre(1U, 3U));
  network_.lose({});
  EXPECT_EQ(writer.write(command(2)), WriteOutcome::written);
  EXPECT_THAT(take(reader), ElementsAre(2U));
}

TEST_F(MemoryNetworkTest, LosesTheSameMessagesForTheSameSeed) {
  const auto arrived = [this](std::uint64_t seed) {
    network_.lose_randomly(0.5, seed);
    auto writer = this->writer();
    auto reader = this->reader();
    for (std::uint32_t step = 0; step < 200; ++step) {
      EXPECT_EQ(writer.write(command(step)), WriteOutcome::written);
    }
    return take(reader);
  };
  const auto first = arrived(7);
  EXPECT_GT(first.size(), 70U);
  EXPECT_LT(first.size(), 130U);
  EXPECT_EQ(arrived(7), first);
  EXPECT_NE(arrived(8), first);
}

TEST_F(MemoryNetworkTest, DeliversADelayedMessageWhenItsTimeHasComeAndRings) {
  auto writer = this->writer();
  auto reader = this->reader();
  EXPECT_TRUE(rang()); // at the beginning
  network_.delay([](const MessageInTransit& message) { return message.number == 0 ? 3s : 1s; });
  ASSERT_EQ(writer.write(command(1)), WriteOutcome::written);
  ASSERT_EQ(writer.write(command(2)), WriteOutcome::written);
  clock_.advance(3s - 1ns);
  EXPECT_FALSE(rang());
  EXPECT_THAT(take(reader), ElementsAre());
  EXPECT_FALSE(writer.wait_for_acknowledgments(0s));
  EXPECT_TRUE(clock_.wait(*bell_, clock_.now() + 10s));
  EXPECT_EQ(clock_.elapsed(), 3s);
  EXPECT_THAT(take(reader), ElementsAre(1U, 2U)); // in order, however quick the second is
  EXPECT_TRUE(writer.wait_for_acknowledgments(0s));
}

TEST_F(MemoryNetworkTest, HoldsAWriterUpForItsLimitWhileItsReaderIsStopped) {
  auto writer = this->writer();
  auto reader = this->reader();
  network_.stop_reading("receiver");
  std::uint32_t written = 0;
  while (writer.write(command(written), 2s) == WriteOutcome::written) {
    ++written;
  }
  EXPECT_EQ(written, 1000U); // the depth of a command's writer
  EXPECT_EQ(clock_.elapsed(), 2s);
  EXPECT_EQ(writer.matched_readers(), 1);
  EXPECT_THAT(take(reader), ElementsAre());
  clock_.at(3s, [&] { network_.resume_reading("receiver"); });
  EXPECT_EQ(writer.write(command(written), 10s), WriteOutcome::written);
  EXPECT_EQ(clock_.elapsed(), 3s);
}

TEST_F(MemoryNetworkTest, KeepsTheNewestStateForAStoppedReader) {
  auto writer = this->writer(Profile::state);
  auto reader = this->reader(Profile::state);
  network_.stop_reading("receiver");
  for (std::uint32_t step = 1; step <= 5000; ++step) {
    ASSERT_EQ(writer.write(command(step), 0s), WriteOutcome::written);
  }
  network_.resume_reading("receiver");
  EXPECT_THAT(take(reader), ElementsAre(5000U));
}

TEST_F(MemoryNetworkTest, KeepsTheNewestProbesForAReaderThatDoesNotTakeThem) {
  auto writer = this->writer(Profile::probe);
  auto reader = this->reader(Profile::probe);
  for (std::uint32_t step = 1; step <= 500; ++step) {
    ASSERT_EQ(writer.write(command(step), 0s), WriteOutcome::written) << "it waits for nobody";
  }
  const auto taken = take(reader);
  ASSERT_EQ(taken.size(), 200U);
  EXPECT_EQ(taken.front(), 301U);
  EXPECT_EQ(taken.back(), 500U);
}

TEST_F(MemoryNetworkTest, TimesAFullWriterOut) {
  auto writer = this->writer();
  auto reader = this->reader();
  network_.fill_writers(topics::command);
  EXPECT_EQ(writer.write(command(1), 10s), WriteOutcome::timed_out);
  EXPECT_EQ(clock_.elapsed(), 10s);
  clock_.at(11s, [&] { network_.empty_writers(topics::command); });
  EXPECT_EQ(writer.write(command(2), 10s), WriteOutcome::written);
  EXPECT_EQ(clock_.elapsed(), 11s);
  EXPECT_THAT(take(reader), ElementsAre(2U));
}

TEST_F(MemoryNetworkTest, LetsAReaderCountAMalformedMessageAndGoOn) {
  auto writer = this->writer();
  auto reader = this->reader();
  network_.inject(topics::command, "b", "these are not bytes of a command");
  network_.inject(topics::command, "other", "nobody reads these");
  ASSERT_EQ(writer.write(command(1)), WriteOutcome::written);
  EXPECT_THAT(take(reader), ElementsAre(1U));
  EXPECT_EQ(receiver_.malformed_messages(), 1U);
  EXPECT_EQ(sender_.malformed_messages(), 0U);
  EXPECT_THAT(warnings_, ElementsAre(testing::HasSubstr("dyncal::wire::Command")));
}

TEST_F(MemoryNetworkTest, CarriesMessagesBetweenThreads) {
  MemoryNetwork network;
  constexpr std::uint32_t messages = 20'000; // many times what the two ends hold
  const auto write = [&](const char* target) {
    Participant participant = network.join("sender");
    auto writer = participant.writer<wire::Command>(topics::command, Profile::command, "b").value();
    while (writer.matched_readers() == 0) {
      std::this_thread::yield();
    }
    for (std::uint32_t step = 0; step < messages; ++step) {
      ASSERT_EQ(writer.write(command(step, target)), WriteOutcome::written);
    }
    EXPECT_TRUE(writer.wait_for_acknowledgments(10s));
  };
  std::jthread first(write, "first");
  std::jthread second(write, "second");
  Participant participant = network.join("receiver");
  auto reader =
      participant.reader<wire::Command>(topics::command, Profile::command, "b", bell_).value();
  std::map<std::string, std::uint32_t> next;
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while ((next["first"] < messages || next["second"] < messages) && bell_->wait_until(deadline)) {
    reader.take([&](const wire::Command& one) {
      EXPECT_EQ(number_of(one), next[one.target().to_string()]++);
    });
  }
  EXPECT_EQ(next["first"], messages);
  EXPECT_EQ(next["second"], messages);
}

} // namespace
} // namespace dyncal::bus
