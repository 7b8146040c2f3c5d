// The sources of a bench, and its runner, as an analysis service meets them: on the memory bus, in
// stepped time, each message when the test wants it.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/source_kind.hpp"
#include "services/contract/topics.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::tests {

constexpr const char* played_bench = "synthetic"; // that of SyntheticRun
constexpr const char* played_run = "r1";

// One source: what it publishes, and the commands it got.
class PlayedSource {
public:
  PlayedSource(bus::MemoryNetwork& network, const wire::SourceDescription& description)
      : PlayedSource(network, description, description.source().to_string()) {}
  PlayedSource(bus::MemoryNetwork& network, const wire::SourceDescription& description,
               const std::string& host)
      : description_(description), participant_(network.join(host)),
        descriptions_(participant_
                          .writer<wire::SourceDescription>(bus::topics::source_description,
                                                           bus::Profile::state, bench())
                          .value()),
        statuses_(participant_
                      .writer<wire::SourceStatus>(bus::topics::source_status, bus::Profile::state,
                                                  bench())
                      .value()),
        samples_(participant_
                     .writer<wire::SampleBlock>(
                         contract::sample_topic(contract::from_wire(description.kind())),
                         bus::Profile::samples, bench())
                     .value()),
        commands_(participant_
                      .reader<wire::Command>(bus::topics::command, bus::Profile::command, bench(),
                                             nullptr)
                      .value()),
        requests_(participant_.reader(bus::topics::catch_up_request, bench(), nullptr).value()) {}

  [[nodiscard]] std::string bench() const { return description_.bench().to_string(); }
  [[nodiscard]] std::string name() const { return description_.source().to_string(); }
  [[nodiscard]] const wire::SourceDescription& description() const { return description_; }

  void describe() { descriptions_.write(description_); }
  void report(wire::SourceState state, const std::string& message = "") {
    statuses_.write(status(state, message));
  }

  // An empty block that answers every run that asked; returns how many commands came.
  std::size_t answer_commands() {
    std::set<std::string> runs;
    const std::size_t commands = commands_.take([&](const wire::Command& command) {
      if (command.target().to_string() == name() && command.kind() == wire::COMMAND_ARM) {
        runs.insert(command.run());
      }
    });
    for (const std::string& run : runs) {
      answer(run);
    }
    return commands;
  }
  void answer(const std::string& run) {
    wire::SampleBlock block = empty_block();
    block.acknowledged_run(run);
    write(block);
  }
  void send_nothing() { write(empty_block()); }
  // An evaluated step of the run, of a source that hands out those.
  void hand_out(wire::AcsStep step) {
    step.bench(bench());
    step.source(name());
    step.run(played_run);
    if (!steps_) {
      steps_.emplace(
          participant_.writer<wire::AcsStep>(bus::topics::acs_step, bus::Profile::results, bench())
              .value());
    }
    steps_->write(step);
  }
  void end_stream() {
    wire::SampleBlock block = empty_block();
    block.end_of_stream(true);
    write(block);
  }
  void send(const std::vector<wire::SampleBlock>& blocks) {
    for (wire::SampleBlock block : blocks) {
      block.session(description_.session());
      block.block(number_++);
      write(block);
    }
  }
  // Numbered and kept, but lost on the way.
  void lose(wire::SampleBlock block) {
    block.block(number_++);
    kept_.push_back(block);
  }

  // As if it had been too long ago.
  void forget_what_was_sent() { kept_.clear(); }
  // Numbers begin anew, and what was kept is gone.
  void restart() { restart(description_); }
  void restart(const wire::SourceDescription& as) {
    const std::uint64_t session = description_.session() + 1;
    description_ = as;
    description_.session(session);
    number_ = 0;
    kept_.clear();
  }

  // Requests that came, without repeats; each is answered with what is kept behind its message, or
  // from the answer to ARM on.
  std::vector<wire::CatchUpRequest> answer_requests() {
    std::vector<wire::CatchUpRequest> answered;
    requests_.take([&](const wire::CatchUpRequest& request) {
      if (request.source().to_string() == name() && names_.insert(request.request()).second) {
        answered.push_back(request);
      }
    });
    for (const wire::CatchUpRequest& request : answered) {
      give_again(request);
    }
    return answered;
  }

private:
  [[nodiscard]] wire::SourceStatus status(wire::SourceState state,
                                          const std::string& message) const {
    wire::SourceStatus status;
    status.bench(bench());
    status.source(name());
    status.state(state);
    status.message(message);
    return status;
  }
  wire::SampleBlock empty_block() {
    wire::SampleBlock block;
    block.bench(bench());
    block.source(name());
    block.session(description_.session());
    block.block(number_++);
    return block;
  }

  void write(const wire::SampleBlock& block) {
    samples_.write(block);
    kept_.push_back(block);
  }
  void give_again(const wire::CatchUpRequest& request) {
    if (!again_ || asker_ != request.asker().to_string()) {
      asker_ = request.asker().to_string();
      again_.emplace(participant_.writer(bus::topics::catch_up_samples, asker_).value());
    }
    auto begin = std::find_if(kept_.begin(), kept_.end(), [&](const wire::SampleBlock& block) {
      return request.session() == 0 ? block.acknowledged_run() == request.run()
                                    : block.block() > request.after();
    });
    if (begin == kept_.end() && request.session() == 0) {
      begin = kept_.begin();
    }
    std::for_each(begin, kept_.end(),
                  [&](const wire::SampleBlock& block) { again_->write(block); });
    wire::SampleBlock end = empty_block();
    --number_; // not one of the stream
    end.acknowledged_run(request.request());
    again_->write(end);
  }

  wire::SourceDescription description_;
  bus::Participant participant_;
  bus::Writer<wire::SourceDescription> descriptions_;
  bus::Writer<wire::SourceStatus> statuses_;
  bus::Writer<wire::SampleBlock> samples_;
  bus::Reader<wire::Command> commands_;
  bus::Reader<wire::CatchUpRequest> requests_;
  std::optional<bus::Writer<wire::SampleBlock>> again_;
  std::optional<bus::Writer<wire::AcsStep>> steps_;
  std::string asker_;
  std::set<std::string> names_; // of requests that were answered
  std::vector<wire::SampleBlock> kept_;
  std::uint64_t number_ = 0;
};

// What an analysis service publishes about runs, in the order in which it came.
class PublishedByAnalysis {
public:
  explicit PublishedByAnalysis(bus::MemoryNetwork& network, const std::string& name = "runner",
                               std::string bench = played_bench)
      : bench_(std::move(bench)), participant_(network.join(name)) {}

  [[nodiscard]] const std::vector<wire::ServiceStatus>& statuses() {
    take(status_reader_, statuses_);
    return statuses_;
  }
  [[nodiscard]] wire::ServiceStatus newest_status() {
    return statuses().empty() ? wire::ServiceStatus() : statuses_.back();
  }
  [[nodiscard]] const std::vector<wire::CalibrationResult>& results() {
    take(result_reader_, results_);
    return results_;
  }
  [[nodiscard]] const std::vector<wire::TransferFunction>& transfer_functions() {
    take(transfer_reader_, transfer_functions_);
    return transfer_functions_;
  }

private:
  template <class T>
  bus::Reader<T> reader(const char* topic, bus::Profile profile) {
    return participant_.reader<T>(topic, profile, bench_, nullptr).value();
  }
  template <class T>
  static void take(bus::Reader<T>& reader, std::vector<T>& all) {
    reader.take([&](const T& message) { all.push_back(message); });
  }

  std::string bench_;
  bus::Participant participant_;
  bus::Reader<wire::ServiceStatus> status_reader_ =
      reader<wire::ServiceStatus>(bus::topics::service_status, bus::Profile::state);
  bus::Reader<wire::CalibrationResult> result_reader_ =
      reader<wire::CalibrationResult>(bus::topics::calibration_result, bus::Profile::results);
  bus::Reader<wire::TransferFunction> transfer_reader_ =
      reader<wire::TransferFunction>(bus::topics::transfer_function, bus::Profile::results);
  std::vector<wire::ServiceStatus> statuses_;
  std::vector<wire::CalibrationResult> results_;
  std::vector<wire::TransferFunction> transfer_functions_;
};

} // namespace dyncal::tests
