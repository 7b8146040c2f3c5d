#include "services/run/bench_queue.hpp"

#include <fmt/core.h>

#include "services/contract/run_identity.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;

constexpr auto look_interval = 200ms;

} // namespace

Expected<BenchQueue> BenchQueue::open(bus::Participant& participant, bus::Clock& clock,
                                      const std::string& bench) {
  auto wake_up = std::make_shared<bus::WakeUp>();
  DYNCAL_TRY(auto reader, participant.reader(bus::topics::measurement, bench, wake_up));
  return BenchQueue(clock, std::move(wake_up), std::move(reader));
}

std::optional<std::string> BenchQueue::taken_by() {
  reader_.take([&](const wire::Measurement& measurement) {
    const std::string run = measurement.run().to_string();
    if (measurement.state() == wire::MEASUREMENT_PLANNED ||
        measurement.state() == wire::MEASUREMENT_RUNNING) {
      runs_[run] = {measurement.conductor(), clock_->now()};
    } else {
      runs_.erase(run);
    }
  });
  std::erase_if(runs_,
                [&](const auto& run) { return clock_->now() - run.second.heard > alive_limit; });
  if (runs_.empty()) {
    return std::nullopt;
  }
  const auto& [name, run] = *runs_.begin();
  return called_of(name, run.conductor);
}

std::optional<std::string> BenchQueue::listen(const std::stop_token& stop) {
  const auto began = clock_->now();
  auto other = taken_by();
  while (!other && clock_->now() - began < listening_time && !stop.stop_requested()) {
    clock_->wait(*wake_up_, clock_->now() + look_interval);
    other = taken_by();
  }
  return other;
}

Expected<void> BenchQueue::wait_until_free(const Show& show, const std::stop_token& stop) {
  const auto began = clock_->now();
  while (!stop.stop_requested()) {
    const auto other = taken_by();
    if (!other && clock_->now() - began >= listening_time) {
      return {};
    }
    show(other ? fmt::format("waiting for the end of {}", *other)
               : std::string("listening whether the bench is in use"));
    clock_->wait(*wake_up_, clock_->now() + look_interval);
  }
  return fail(ErrorCode::interrupted,
              "interrupted while another run had the bench; nothing was excited");
}

} // namespace dyncal::inline run
