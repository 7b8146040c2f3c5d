#include "services/run/run_messages.hpp"

#include <deque>
#include <functional>
#include <map>
#include <memory>

#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/bus/memory/stepped_clock.hpp"

namespace dyncal::inline run {
namespace {

// What came of each topic, and something that happens when the next one is taken.
class Inbox {
public:
  template <class T>
  void come(const bus::Topic<T>& topic, const T& message) {
    messages_[topic.name].push_back(std::make_shared<T>(message));
  }
  void after_next_take(std::function<void()> action) { action_ = std::move(action); }

  std::size_t take(const std::string& topic, const bus::UntypedReader::Consume& consume) {
    const auto taken = std::exchange(messages_[topic], {});
    for (const auto& message : taken) {
      consume(message.get(), {}, {});
    }
    const bool of_analysis =
        topic == bus::topics::service_status.name || topic == bus::topics::calibration_result.name;
    if (of_analysis && action_) {
      std::exchange(action_, nullptr)();
    }
    return taken.size();
  }

private:
  std::map<std::string, std::deque<std::shared_ptr<const void>>> messages_;
  std::function<void()> action_;
};

class InboxReader final : public bus::UntypedReader {
public:
  InboxReader(std::shared_ptr<Inbox> inbox, std::string topic)
      : inbox_(std::move(inbox)), topic_(std::move(topic)) {}
  std::size_t take(const Consume& consume) override { return inbox_->take(topic_, consume); }
  [[nodiscard]] int matched_writers() const override { return 1; }

private:
  std::shared_ptr<Inbox> inbox_;
  std::string topic_;
};

class SilentWriter final : public bus::UntypedWriter {
public:
  bus::WriteOutcome write(const bus::EncodedMessage& /*message*/,
                          std::chrono::nanoseconds /*limit*/) override {
    return bus::WriteOutcome::written;
  }
  [[nodiscard]] int matched_readers() const override { return 0; }
  bool wait_for_acknowledgments(std::chrono::nanoseconds /*limit*/) override { return true; }
};

class InboxParticipant final : public bus::UntypedParticipant {
public:
  explicit InboxParticipant(std::shared_ptr<Inbox> inbox) : inbox_(std::move(inbox)) {}
  Expected<std::unique_ptr<bus::UntypedWriter>>
  writer(const bus::TypeSupport& /*type*/, const std::string& /*topic*/, bus::Profile /*profile*/,
         const std::vector<std::string>& /*partitions*/) override {
    return std::make_unique<SilentWriter>();
  }
  Expected<std::unique_ptr<bus::UntypedReader>>
  reader(const bus::TypeSupport& /*type*/, const std::string& topic, bus::Profile /*profile*/,
         const std::string& /*partition*/, std::shared_ptr<bus::WakeUp> /*wake_up*/) override {
    return std::make_unique<InboxReader>(inbox_, topic);
  }
  [[nodiscard]] std::uint64_t malformed_messages() const override { return 0; }

private:
  std::shared_ptr<Inbox> inbox_;
};

wire::CalibrationResult result_of_step_1(bool provisional) {
  wire::CalibrationResult result;
  result.bench("b");
  result.run("r");
  result.channel("dau/z");
  result.step(1);
  result.repetition(1);
  result.provisional(provisional);
  return result;
}

wire::ServiceStatus status_of(wire::ArmState arm) {
  wire::ServiceStatus status;
  status.service("analysis@test:1");
  status.bench("b");
  status.run("r");
  status.arm(arm);
  status.contract_version(wire::CONTRACT_VERSION);
  return status;
}

// A chain each for what it plans and what it excites.
TEST(RunMessages, ShowsItsGuardALinkInEveryMessage) {
  bus::SteppedClock clock;
  bus::MemoryNetwork network(clock);
  bus::Participant conductor = network.join("conductor");
  bus::Participant guard = network.join("guard");
  auto plans = guard.reader(bus::topics::measurement, "b", nullptr).value();
  auto excitations = guard.reader(bus::topics::excitation, "b", nullptr).value();
  auto messages = RunMessages::open(conductor, clock, "b", "r", "192.0.2.7:5025", nullptr);
  ASSERT_TRUE(messages) << messages.error().message;
  wire::Measurement plan;
  plan.bench("b");
  plan.run("r");
  wire::PlannedStep step;
  step.step(1);
  std::optional<ChainFollower> planned;
  std::optional<ChainFollower> excited;
  for (std::uint64_t round = 1; round <= 5; ++round) {
    messages->publish(plan);
    messages->announce(step, 1, wire::EXCITATION_STEADY);
    plans.take([&](const wire::Measurement& message) {
      const NumberedLink shown{message.link_number(), parse_chain_link(message.link()).value()};
      if (!planned) {
        planned.emplace(shown);
        excited.emplace(NumberedLink{0, parse_chain_link(message.excitation_anchor()).value()});
      } else {
        EXPECT_TRUE(planned->accept(shown, 1));
      }
    });
    clock.advance(std::chrono::milliseconds(500));
    const auto take = [&] {
      return excitations.take([&](const wire::Excitation& message) {
        EXPECT_TRUE(
            excited->accept({message.link_number(), parse_chain_link(message.link()).value()}, 1));
      });
    };
    EXPECT_EQ(take(), 1U);
    messages->repeat_announcement();
    EXPECT_EQ(take(), 1U);
  }
  EXPECT_EQ(planned->latest().number, 5U);
  EXPECT_EQ(excited->latest().number, 10U);
}

bool has_finished(const RunMessages& messages) {
  return messages.analysis() && messages.analysis()->arm() == wire::ARM_FINISHED;
}

// The analysis sends FINISHED when a result that comes once more is there. Both may come between
// any two looks of the conductor, who must never see FINISHED and still hold the provisional one.
TEST(RunMessages, HasTheSettledResultsOnceItSeesFinished) {
  const auto inbox = std::make_shared<Inbox>();
  bus::Participant participant(std::make_unique<InboxParticipant>(inbox));
  bus::SteppedClock clock;
  auto messages = RunMessages::open(participant, clock, "b", "r", "", nullptr);
  ASSERT_TRUE(messages) << messages.error().message;
  RunOutcome outcome;
  inbox->come(bus::topics::service_status, status_of(wire::ARM_ARMED));
  inbox->come(bus::topics::calibration_result, result_of_step_1(true));
  messages->take(outcome);
  ASSERT_EQ(outcome.results.size(), 1U);
  ASSERT_TRUE(outcome.results.front().provisional);

  inbox->after_next_take([&] {
    inbox->come(bus::topics::calibration_result, result_of_step_1(false));
    inbox->come(bus::topics::service_status, status_of(wire::ARM_FINISHED));
  });
  for (int look = 0; look < 3; ++look) {
    messages->take(outcome);
    ASSERT_EQ(outcome.results.size(), 1U);
    EXPECT_FALSE(has_finished(*messages) && outcome.results.front().provisional) << look;
  }
  EXPECT_TRUE(has_finished(*messages));
  EXPECT_FALSE(outcome.results.front().provisional);
}

} // namespace
} // namespace dyncal::inline run
