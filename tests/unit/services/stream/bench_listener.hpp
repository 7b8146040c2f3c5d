// Reads what sources of a bench publish, and speaks to them as a run does. For tests.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "services/bus/bus.hpp"
#include "services/contract/topics.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"

namespace dyncal::tests {

// In the test's own domain.
inline bus::Participant participant(bus::Vendor vendor) {
  bus::ParticipantOptions options;
  options.vendor = vendor;
  options.domain = own_dds_domain();
  options.name = "test";
  auto participant = bus::Participant::create(options);
  EXPECT_TRUE(participant) << participant.error().message;
  return std::move(*participant);
}

class BenchListener {
public:
  BenchListener(bus::Participant& network, std::string bench, const char* sample_topic)
      : bench_(std::move(bench)),
        descriptions_(*network.reader<wire::SourceDescription>(
            bus::topics::source_description, bus::Profile::state, bench_, wake_up_)),
        statuses_(*network.reader<wire::SourceStatus>(bus::topics::source_status,
                                                      bus::Profile::state, bench_, wake_up_)),
        samples_(*network.reader<wire::SampleBlock>(sample_topic, bus::Profile::samples, bench_,
                                                    wake_up_)),
        commands_(
            *network.writer<wire::Command>(bus::topics::command, bus::Profile::command, bench_)),
        measurements_(*network.writer<wire::Measurement>(bus::topics::measurement,
                                                         bus::Profile::state, bench_)) {}

  // Reads until the condition holds. False when it does not within the time.
  bool until(const std::function<bool()>& condition, std::chrono::seconds limit = patience) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (true) {
      take();
      if (condition()) {
        return true;
      }
      if (std::chrono::steady_clock::now() > deadline) {
        return false;
      }
      wake_up_->wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(50));
    }
  }

  void arm(const std::string& source, const std::string& run) {
    wire::Command command;
    command.target(source);
    command.kind(wire::COMMAND_ARM);
    command.bench(bench_);
    command.run(run);
    commands_.write(command);
  }

  // Asks for an answer until it has come.
  bool armed(const std::string& source, const std::string& run) {
    auto asked = std::chrono::steady_clock::time_point{};
    return until([&] {
      if (std::chrono::steady_clock::now() - asked > std::chrono::milliseconds(250)) {
        arm(source, run);
        asked = std::chrono::steady_clock::now();
      }
      for (const auto& block : blocks) {
        if (block.acknowledged_run() == run) {
          return true;
        }
      }
      return false;
    });
  }

  void set_state(const std::string& run, wire::MeasurementState state) {
    wire::Measurement measurement;
    measurement.bench(bench_);
    measurement.run(run);
    measurement.state(state);
    measurements_.write(measurement);
  }

  // Samples of one source in the order they came; fails the test on a gap that the numbers of
  // blocks and samples do not explain.
  [[nodiscard]] std::uint64_t samples_of(const std::string& source) const {
    std::uint64_t count = 0;
    for (const auto& block : blocks) {
      count += source == block.source().c_str() ? block.sample_count() : 0;
    }
    return count;
  }

  // The block that closes the first stream; nothing if none has come. An answer to a repeated
  // request may stand behind it.
  [[nodiscard]] const wire::SampleBlock* end_of_stream() const {
    const auto end =
        std::ranges::find_if(blocks, [](const auto& block) { return block.end_of_stream(); });
    return end == blocks.end() ? nullptr : &*end;
  }

  [[nodiscard]] std::optional<wire::SourceStatus> last_status(const std::string& source) const {
    std::optional<wire::SourceStatus> last;
    for (const auto& status : statuses) {
      if (source == status.source().c_str()) {
        last = status;
      }
    }
    return last;
  }

  [[nodiscard]] bool saw_state(const std::string& source, wire::SourceState state) const {
    for (const auto& status : statuses) {
      if (source == status.source().c_str() && status.state() == state) {
        return true;
      }
    }
    return false;
  }

  std::vector<wire::SourceDescription> descriptions;
  std::vector<wire::SourceStatus> statuses;
  std::vector<wire::SampleBlock> blocks;

private:
  void take() {
    descriptions_.take(
        [&](const wire::SourceDescription& message) { descriptions.push_back(message); });
    statuses_.take([&](const wire::SourceStatus& message) { statuses.push_back(message); });
    samples_.take([&](const wire::SampleBlock& message) { blocks.push_back(message); });
  }

  std::string bench_;
  std::shared_ptr<bus::WakeUp> wake_up_ = std::make_shared<bus::WakeUp>();
  bus::Reader<wire::SourceDescription> descriptions_;
  bus::Reader<wire::SourceStatus> statuses_;
  bus::Reader<wire::SampleBlock> samples_;
  bus::Writer<wire::Command> commands_;
  bus::Writer<wire::Measurement> measurements_;
};

} // namespace dyncal::tests
