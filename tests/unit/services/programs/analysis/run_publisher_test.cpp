#include "services/programs/analysis/run_publisher.hpp"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/memory/stepped_clock.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline programs {
namespace {

using Events = std::vector<std::string>;

class NotedWriter final : public bus::UntypedWriter {
public:
  NotedWriter(std::shared_ptr<Events> events, std::string topic)
      : events_(std::move(events)), topic_(std::move(topic)) {}
  bus::WriteOutcome write(const bus::EncodedMessage& /*message*/,
                          std::chrono::nanoseconds /*limit*/) override {
    events_->push_back("write " + topic_);
    return bus::WriteOutcome::written;
  }
  [[nodiscard]] int matched_readers() const override { return 1; }
  bool wait_for_acknowledgments(std::chrono::nanoseconds /*limit*/) override {
    events_->push_back("acknowledged " + topic_);
    return true;
  }

private:
  std::shared_ptr<Events> events_;
  std::string topic_;
};

class NotedParticipant final : public bus::UntypedParticipant {
public:
  explicit NotedParticipant(std::shared_ptr<Events> events) : events_(std::move(events)) {}
  Expected<std::unique_ptr<bus::UntypedWriter>>
  writer(const bus::TypeSupport& /*type*/, const std::string& topic, bus::Profile /*profile*/,
         const std::vector<std::string>& /*partitions*/) override {
    return std::make_unique<NotedWriter>(events_, topic);
  }
  Expected<std::unique_ptr<bus::UntypedReader>>
  reader(const bus::TypeSupport& /*type*/, const std::string& /*topic*/, bus::Profile /*profile*/,
         const std::string& /*partition*/, std::shared_ptr<bus::WakeUp> /*wake_up*/) override {
    return fail(ErrorCode::network, "it publishes only");
  }
  [[nodiscard]] std::uint64_t malformed_messages() const override { return 0; }

private:
  std::shared_ptr<Events> events_;
};

// What is published of a run with these results, and FINISHED behind it.
Events published(const EvaluationOutput& output) {
  const auto events = std::make_shared<Events>();
  bus::Participant participant(std::make_unique<NotedParticipant>(events));
  bus::SteppedClock clock;
  auto publisher = RunPublisher::open(participant, clock, {}, "b", "r");
  EXPECT_TRUE(publisher) << publisher.error().message;
  publisher->publish(Recipe{}, output);
  publisher->publish({.arm = wire::ARM_FINISHED, .health = wire::HEALTH_OK, .message = {}});
  return *events;
}

StepResult result_of_step_1() {
  StepResult result;
  result.channel = "dau/z";
  result.step = result.repetition = 1;
  result.valid = true;
  return result;
}

const std::string write_result = std::string("write ") + bus::topics::calibration_result.name;
const std::string write_status = std::string("write ") + bus::topics::service_status.name;

// Nothing tells a reader of FINISHED that a result which it has comes once more.
TEST(RunPublisher, SendsFinishedWhenTheResultsThatComeOnceMoreAreAcknowledged) {
  EvaluationOutput output;
  output.results = {result_of_step_1()};
  output.settled = {result_of_step_1()};
  EXPECT_THAT(published(output), testing::ElementsAre(write_result, write_result,
                                                      std::string("acknowledged ") +
                                                          bus::topics::calibration_result.name,
                                                      write_status));
}

TEST(RunPublisher, WaitsForNobodyWhereNoResultComesOnceMore) {
  EvaluationOutput output;
  output.results = {result_of_step_1()};
  EXPECT_THAT(published(output), testing::ElementsAre(write_result, write_status));
}

} // namespace
} // namespace dyncal::inline programs
