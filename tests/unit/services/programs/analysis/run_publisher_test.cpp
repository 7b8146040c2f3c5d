#include "services/programs/analysis/run_publisher.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/memory/stepped_clock.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline programs {
namespace {

struct Network {
  std::vector<std::string> events;
  bool acknowledges = true;
};

class NotedWriter final : public bus::UntypedWriter {
public:
  NotedWriter(std::shared_ptr<Network> network, std::string topic)
      : network_(std::move(network)), topic_(std::move(topic)) {}
  bus::WriteOutcome write(const bus::EncodedMessage& /*message*/,
                          std::chrono::nanoseconds /*limit*/) override {
    network_->events.push_back("write " + topic_);
    return bus::WriteOutcome::written;
  }
  [[nodiscard]] int matched_readers() const override { return 1; }
  bool wait_for_acknowledgments(std::chrono::nanoseconds /*limit*/) override {
    if (network_->acknowledges) {
      network_->events.push_back("acknowledged " + topic_);
    }
    return network_->acknowledges;
  }

private:
  std::shared_ptr<Network> network_;
  std::string topic_;
};

class NotedParticipant final : public bus::UntypedParticipant {
public:
  explicit NotedParticipant(std::shared_ptr<Network> network) : network_(std::move(network)) {}
  Expected<std::unique_ptr<bus::UntypedWriter>>
  writer(const bus::TypeSupport& /*type*/, const std::string& topic, bus::Profile /*profile*/,
         const std::vector<std::string>& /*partitions*/) override {
    return std::make_unique<NotedWriter>(network_, topic);
  }
  Expected<std::unique_ptr<bus::UntypedReader>>
  reader(const bus::TypeSupport& /*type*/, const std::string& /*topic*/, bus::Profile /*profile*/,
         const std::string& /*partition*/, std::shared_ptr<bus::WakeUp> /*wake_up*/) override {
    return fail(ErrorCode::network, "it publishes only");
  }
  [[nodiscard]] std::uint64_t malformed_messages() const override { return 0; }

private:
  std::shared_ptr<Network> network_;
};

StepResult result_of_step(std::uint32_t step) {
  StepResult result;
  result.channel = "dau/z";
  result.step = step;
  result.repetition = 1;
  result.valid = true;
  return result;
}

EvaluationOutput once_more(std::uint32_t results) {
  EvaluationOutput output;
  for (std::uint32_t step = 1; step <= results; ++step) {
    output.settled.push_back(result_of_step(step));
  }
  output.transfer_functions.emplace_back().channel = "dau/z";
  return output;
}

const std::string write_result = std::string("write ") + bus::topics::calibration_result.name;
const std::string acknowledged =
    std::string("acknowledged ") + bus::topics::calibration_result.name;
const std::string write_mean = std::string("write ") + bus::topics::transfer_function.name;

class RunPublisherTest : public testing::Test {
protected:
  std::shared_ptr<Network> network_ = std::make_shared<Network>();
  bus::SteppedClock clock_;

  RunPublisher open() {
    bus::Participant participant(std::make_unique<NotedParticipant>(network_));
    auto publisher = RunPublisher::open(participant, clock_, {}, "b", "r");
    EXPECT_TRUE(publisher) << publisher.error().message;
    return std::move(*publisher);
  }
  std::size_t written() const {
    return static_cast<std::size_t>(std::ranges::count(network_->events, write_result));
  }
};

// Nothing tells a reader of FINISHED that a result which it has comes once more.
TEST_F(RunPublisherTest, HasPublishedAllWhenTheResultsThatComeOnceMoreAreAcknowledged) {
  RunPublisher publisher = open();
  EvaluationOutput output = once_more(1);
  output.results = {result_of_step(1)};
  publisher.publish(Recipe{}, output);
  EXPECT_TRUE(publisher.has_published_all());
  EXPECT_THAT(network_->events,
              testing::ElementsAre(write_result, write_result, acknowledged, write_mean));
  EXPECT_EQ(publisher.results(), 1U);
}

TEST_F(RunPublisherTest, WaitsForNobodyWhereFewResultsComeAndNoneOnceMore) {
  RunPublisher publisher = open();
  EvaluationOutput output;
  output.results = {result_of_step(1)};
  publisher.publish(Recipe{}, output);
  EXPECT_THAT(network_->events, testing::ElementsAre(write_result));
  EXPECT_TRUE(publisher.has_published_all());
}

// Of a run whose results come at once, a socket would hold a part.
TEST_F(RunPublisherTest, SendsNoMoreAtOnceThanAreAcknowledged) {
  constexpr std::size_t at_once = RunPublisher::results_at_once;
  RunPublisher publisher = open();
  publisher.publish(Recipe{}, once_more(3 * at_once + 1));
  EXPECT_TRUE(publisher.has_published_all());
  std::size_t since = 0;
  std::size_t most = 0;
  for (const std::string& event : network_->events) {
    since = event == write_result ? since + 1 : 0;
    most = std::max(most, since);
  }
  EXPECT_EQ(most, at_once);
  EXPECT_EQ(written(), 3 * at_once + 1);
  EXPECT_EQ(network_->events.back(), write_mean);
}

TEST_F(RunPublisherTest, KeepsTheRestForWhoIsSlow) {
  constexpr std::size_t at_once = RunPublisher::results_at_once;
  RunPublisher publisher = open();
  network_->acknowledges = false;
  publisher.publish(Recipe{}, once_more(2 * at_once));
  EXPECT_FALSE(publisher.has_published_all());
  EXPECT_EQ(written(), at_once);
  network_->acknowledges = true;
  publisher.publish(Recipe{}, {});
  EXPECT_TRUE(publisher.has_published_all());
  EXPECT_EQ(written(), 2 * at_once);
}

TEST_F(RunPublisherTest, WaitsNoLongerForWhoIsDeaf) {
  RunPublisher publisher = open();
  network_->acknowledges = false;
  publisher.publish(Recipe{}, once_more(100));
  clock_.advance(RunPublisher::acknowledgment_limit);
  publisher.publish(Recipe{}, {});
  EXPECT_TRUE(publisher.has_published_all());
  EXPECT_EQ(written(), 100U);
  EXPECT_EQ(network_->events.back(), write_mean);
}

} // namespace
} // namespace dyncal::inline programs
