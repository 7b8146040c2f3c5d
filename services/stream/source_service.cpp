#include "services/stream/source_service.hpp"

#include <algorithm>
#include <utility>

#include "services/contract/topics.hpp"

namespace dyncal::inline stream {

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto write_limit =
    std::chrono::milliseconds(50); // of one write, before the other sources get their turn
constexpr auto retry_interval = std::chrono::milliseconds(10); // for what could not be written
constexpr auto acknowledgment_limit = std::chrono::seconds(2);
constexpr std::size_t max_name = 64; // bound of the keys of the contract
// Blocks of many sources come one after the other, each with a wake-up: where a turn finds several,
// the next one waits for more. Short beside the 20 ms to 100 ms that a block is long.
constexpr auto rest = std::chrono::milliseconds(5);
constexpr std::uint64_t rest_worthwhile = 2; // messages in one turn

bool is_under_way(const wire::Measurement& measurement) {
  return measurement.state() == wire::MEASUREMENT_PLANNED ||
         measurement.state() == wire::MEASUREMENT_RUNNING;
}

} // namespace

Expected<void> SourceService::join_bench(const std::string& bench) {
  if (benches_.contains(bench)) {
    return {};
  }
  DYNCAL_TRY(auto command, participant_.reader(bus::topics::command, bench, wake_up_));
  DYNCAL_TRY(auto measurement, participant_.reader(bus::topics::measurement, bench, wake_up_));
  benches_.emplace(bench, BenchReaders{std::move(command), std::move(measurement)});
  return {};
}

Expected<std::shared_ptr<SourcePublisher>> SourceService::add(SourceOptions source) {
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
  DYNCAL_TRY(join_bench(source.bench));
  source.max_block_bytes = options_.max_block_bytes;
  auto publisher = std::make_shared<SourcePublisher>(std::move(source), wake_up_);
  auto kept = std::make_shared<RetransmissionBuffer>(options_.kept);
  DYNCAL_TRY(auto channel,
             SourcePublication::create(participant_, publisher, kept, options_.software));
  DYNCAL_TRY(catch_up_.add(publisher->options(), std::move(kept)));
  channel->report_to(options_.reported);
  channels_.push_back(std::move(channel));
  return publisher;
}

void SourceService::take_commands(const std::string& bench, BenchReaders& readers) {
  readers.command.take([&](const wire::Command& command) {
    if (command.kind() != wire::COMMAND_ARM || command.bench() != bench) {
      return;
    }
    for (auto& channel : channels_) {
      const SourceOptions& source = channel->publisher().options();
      if (source.bench == bench && source.source == command.target().c_str()) {
        channel->answer(command.run());
        channel->kept().want(Clock::now());
      }
    }
  });
}

void SourceService::take_measurements(const std::string& bench, BenchReaders& readers) {
  auto running = readers.running;
  bool under_way = false;
  std::optional<HeardRun> heard;
  readers.measurement.take([&](const wire::Measurement& measurement) {
    const std::string run = measurement.run().c_str();
    std::erase(running, run);
    under_way = under_way || is_under_way(measurement);
    if (measurement.state() == wire::MEASUREMENT_RUNNING) {
      running.push_back(run);
    }
    if (!heard || is_under_way(measurement)) {
      heard = HeardRun{.run = run,
                       .steps = planned_reference_steps(measurement),
                       .is_under_way = is_under_way(measurement),
                       .is_running = measurement.state() == wire::MEASUREMENT_RUNNING};
    }
  });
  const bool changed = running != readers.running;
  readers.running = std::move(running);
  for (auto& channel : channels_) {
    if (channel->publisher().options().bench != bench) {
      continue;
    }
    if (under_way) {
      channel->kept().want(Clock::now());
    }
    if (changed) {
      channel->publisher().note_running(readers.running);
    }
    if (heard && channel->publisher().options().hands_out_steps) {
      channel->publisher().note_run(*heard);
    }
  }
}

void SourceService::listen() {
  for (auto& [bench, readers] : benches_) {
    take_commands(bench, readers);
    take_measurements(bench, readers);
  }
}

// Returns true if something is left to do at once.
bool SourceService::step_channels() {
  bool more = false;
  for (auto& channel : channels_) {
    more = channel->step(write_limit) || more;
  }
  return more;
}

std::uint64_t SourceService::messages_written() const {
  std::uint64_t written = 0;
  for (const auto& channel : channels_) {
    written += channel->messages_written();
  }
  return written;
}

// A stream that is played faster than real time fills memory faster than the other thread looks.
void SourceService::keep_up() {
  if (std::ranges::any_of(channels_,
                          [](const auto& channel) { return channel->kept().tidy_due(); })) {
    catch_up_.wake_up()->ring();
  }
}

void SourceService::give_again(const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { catch_up_.wake_up()->ring(); });
  while (!stop.stop_requested()) {
    catch_up_.wake_up()->wait_until(catch_up_.step());
  }
}

void SourceService::run(const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { wake_up_->ring(); });
  while (!stop.stop_requested()) {
    if (options_.turned) {
      options_.turned();
    }
    listen();
    const std::uint64_t written_before = messages_written();
    const bool more = step_channels();
    keep_up();
    auto due = Clock::now() + options_.status_interval;
    for (auto& channel : channels_) {
      due = std::min(due, channel->step_status(options_.status_interval, write_limit));
      if (channel->blocked()) {
        due = std::min(due, Clock::now() + retry_interval);
      }
    }
    if (more) {
      continue;
    }
    if (messages_written() - written_before >= rest_worthwhile) {
      std::this_thread::sleep_for(rest);
    }
    wake_up_->wait_until(due);
  }
  finish();
}

void SourceService::finish() {
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

void SourceService::stop() {
  if (!thread_.joinable()) {
    return;
  }
  thread_.request_stop();
  thread_.join();
  catch_up_thread_.request_stop();
  catch_up_thread_.join();
}

SourceService::~SourceService() {
  stop();
}

std::unique_ptr<SourceService> SourceService::create(bus::Participant& participant,
                                                     SourceServiceOptions options) {
  return std::unique_ptr<SourceService>(new SourceService(participant, std::move(options)));
}

void SourceService::start() {
  if (!thread_.joinable()) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    catch_up_thread_ = std::jthread([this](const std::stop_token& stop) { give_again(stop); });
  }
}

} // namespace dyncal::inline stream
