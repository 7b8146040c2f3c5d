#include "services/source/source_service.hpp"

#include <algorithm>
#include <map>
#include <thread>
#include <utility>
#include <vector>

#include "services/bus/bus.hpp"
#include "services/contract/topics.hpp"
#include "services/source/source_channel.hpp"

namespace dyncal::services {

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto write_limit =
    std::chrono::milliseconds(50); // of one write, before the other sources get their turn
constexpr auto retry_interval = std::chrono::milliseconds(10); // for what could not be written
constexpr auto acknowledgment_limit = std::chrono::seconds(2);
constexpr std::size_t max_name = 64; // bound of the keys of the contract

// What the bench asks of its sources.
struct BenchReaders {
  bus::Reader<dyncal::wire::Command> command;
  bus::Reader<dyncal::wire::Measurement> measurement;
  std::vector<std::string> running{};
};

} // namespace

class SourceService::Implementation {
public:
  Implementation(bus::Participant& participant, SourceServiceOptions options)
      : participant_(participant), options_(std::move(options)),
        wake_up_(std::make_shared<bus::WakeUp>()) {}

  Expected<std::shared_ptr<SourcePublisher>> add(SourceOptions source);
  void start() {
    if (!thread_.joinable()) {
      thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    }
  }
  void stop();

private:
  Expected<void> join_bench(const std::string& bench);
  void run(const std::stop_token& stop);
  void finish();
  bool step_channels();
  void listen();
  void take_commands(const std::string& bench, BenchReaders& readers);
  void take_measurements(const std::string& bench, BenchReaders& readers);

  bus::Participant& participant_;
  const SourceServiceOptions options_;
  const std::shared_ptr<bus::WakeUp> wake_up_;
  std::map<std::string, BenchReaders> benches_;
  std::vector<std::unique_ptr<SourceChannel>> channels_;
  std::jthread thread_;
};

Expected<void> SourceService::Implementation::join_bench(const std::string& bench) {
  if (benches_.contains(bench)) {
    return {};
  }
  auto command = participant_.reader<dyncal::wire::Command>(bus::topics::command,
                                                            bus::Profile::command, bench, wake_up_);
  if (!command) {
    return fail(command.error());
  }
  auto measurement = participant_.reader<dyncal::wire::Measurement>(
      bus::topics::measurement, bus::Profile::state, bench, wake_up_);
  if (!measurement) {
    return fail(measurement.error());
  }
  benches_.emplace(bench, BenchReaders{std::move(*command), std::move(*measurement)});
  return {};
}

Expected<std::shared_ptr<SourcePublisher>>
SourceService::Implementation::add(SourceOptions source) {
  for (const auto* name : {&source.bench, &source.source}) {
    if (name->empty() || name->size() > max_name) {
      return fail(ErrorCode::bad_argument,
                  "the name '" + *name + "' of a bench or source must have 1 to 64 characters");
    }
  }
  const auto taken = [&](const auto& channel) {
    const SourceOptions& other = channel->publisher().options();
    return other.bench == source.bench && other.source == source.source;
  };
  if (std::ranges::any_of(channels_, taken)) {
    return fail(ErrorCode::bad_argument, "bench '" + source.bench + "' has the source '" +
                                             source.source +
                                             "' twice: give each bench file its own bench name");
  }
  if (auto joined = join_bench(source.bench); !joined) {
    return fail(joined.error());
  }
  auto publisher = std::make_shared<SourcePublisher>(std::move(source), wake_up_);
  auto channel = SourceChannel::create(participant_, publisher, options_.software);
  if (!channel) {
    return fail(channel.error());
  }
  channels_.push_back(std::move(*channel));
  return publisher;
}

void SourceService::Implementation::take_commands(const std::string& bench, BenchReaders& readers) {
  readers.command.take([&](const dyncal::wire::Command& command) {
    if (command.kind() != wire::COMMAND_ARM || command.bench() != bench) {
      return;
    }
    for (auto& channel : channels_) {
      const SourceOptions& source = channel->publisher().options();
      if (source.bench == bench && source.source == command.target().c_str()) {
        channel->answer(command.run());
      }
    }
  });
}

void SourceService::Implementation::take_measurements(const std::string& bench,
                                                      BenchReaders& readers) {
  auto running = readers.running;
  readers.measurement.take([&](const dyncal::wire::Measurement& measurement) {
    const std::string run = measurement.run().c_str();
    std::erase(running, run);
    if (measurement.state() == wire::MEASUREMENT_RUNNING) {
      running.push_back(run);
    }
  });
  if (running == readers.running) {
    return;
  }
  readers.running = std::move(running);
  for (auto& channel : channels_) {
    if (channel->publisher().options().bench == bench) {
      channel->publisher().note_running(readers.running);
    }
  }
}

void SourceService::Implementation::listen() {
  for (auto& [bench, readers] : benches_) {
    take_commands(bench, readers);
    take_measurements(bench, readers);
  }
}

// Returns true if something is left to do at once.
bool SourceService::Implementation::step_channels() {
  bool more = false;
  for (auto& channel : channels_) {
    more = channel->step(write_limit) || more;
  }
  return more;
}

void SourceService::Implementation::run(const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { wake_up_->ring(); });
  while (!stop.stop_requested()) {
    listen();
    const bool more = step_channels();
    auto due = Clock::now() + options_.status_interval;
    for (auto& channel : channels_) {
      due = std::min(due, channel->step_status(options_.status_interval, write_limit));
      if (channel->blocked()) {
        due = std::min(due, Clock::now() + retry_interval);
      }
    }
    if (!more) {
      wake_up_->wait_until(due);
    }
  }
  finish();
}

void SourceService::Implementation::finish() {
  const auto deadline = Clock::now() + options_.stop_limit;
  for (auto& channel : channels_) {
    channel->publisher().end();
    channel->flush();
  }
  const auto idle = [](const auto& channel) { return channel->idle(); };
  while (!std::ranges::all_of(channels_, idle) && Clock::now() < deadline) {
    if (!step_channels()) {
      wake_up_->wait_until(std::min(deadline, Clock::now() + retry_interval));
    }
  }
  const auto acknowledged_by = Clock::now() + acknowledgment_limit;
  for (auto& channel : channels_) {
    channel->step_status(std::chrono::nanoseconds(0), write_limit);
    channel->wait_for_acknowledgments(std::max(Clock::duration(0), acknowledged_by - Clock::now()));
  }
}

void SourceService::Implementation::stop() {
  if (!thread_.joinable()) {
    return;
  }
  thread_.request_stop();
  thread_.join();
}

SourceService::SourceService(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}

SourceService::~SourceService() {
  stop();
}

std::unique_ptr<SourceService> SourceService::create(bus::Participant& participant,
                                                     SourceServiceOptions options) {
  return std::unique_ptr<SourceService>(
      new SourceService(std::make_unique<Implementation>(participant, std::move(options))));
}

Expected<std::shared_ptr<SourcePublisher>> SourceService::add(SourceOptions options) {
  return implementation_->add(std::move(options));
}

void SourceService::start() {
  implementation_->start();
}

void SourceService::stop() {
  implementation_->stop();
}

} // namespace dyncal::services
