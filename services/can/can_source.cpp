#include "services/can/can_source.hpp"

#include <chrono>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "drivers/can/dbc.hpp"
#include "drivers/can/socketcan_source.hpp"
#include "services/can/can_status.hpp"

namespace dyncal::services::can {

namespace {

using Clock = std::chrono::steady_clock;
using drivers::can::BusEvent;
using drivers::can::LinkChange;

constexpr auto wait_limit = std::chrono::milliseconds(50);
constexpr auto report_interval = std::chrono::milliseconds(250);

// Driver errors as the program's, with the source in front.
Error named(const std::string& source, const drivers::Error& error) {
  const bool by_the_user = error.code == drivers::ErrorCode::invalid_setting;
  const bool by_the_file = error.code == drivers::ErrorCode::malformed;
  return {by_the_user   ? ErrorCode::bad_argument
          : by_the_file ? ErrorCode::bad_file
                        : ErrorCode::device,
          fmt::format("source '{}': {}", source, error.message)};
}

class PublisherSink : public drivers::can::SampleSink {
public:
  explicit PublisherSink(SourcePublisher& publisher) : publisher_(publisher) {}
  void describe(const drivers::SourceDescription& description) override { publisher_.describe(description); }
  void restart() override { publisher_.start_session(); }
  void take(drivers::SampleBlock block) override { publisher_.offer(std::move(block)); } // what has no room is counted there

private:
  SourcePublisher& publisher_;
};

} // namespace

Expected<CanSource> CanSource::prepare(const SourceSettings& settings) {
  const CanSourceSettings& can = *settings.can;
  auto dbc = drivers::can::read_dbc_file(can.dbc);
  if (!dbc) return tl::unexpected(named(settings.name, dbc.error()));
  CanSource source;
  source.name_ = settings.name;
  source.warnings_ = dbc->warnings;
  auto stream = drivers::can::SensorStream::create(can.sensor, std::move(*dbc));
  if (!stream) return tl::unexpected(named(settings.name, stream.error()));
  source.stream_ = std::move(*stream);

  drivers::can::SocketCanSettings socket;
  socket.interface_name = can.interface_name;
  socket.bit_rate_per_s = static_cast<std::uint32_t>(can.sensor.bit_rates.nominal_per_s);
  socket.data_bit_rate_per_s = static_cast<std::uint32_t>(can.sensor.bit_rates.data_per_s);
  if (can.restart_after_bus_off_s)
    socket.restart_after_bus_off = std::chrono::milliseconds(static_cast<std::int64_t>(*can.restart_after_bus_off_s * 1e3));
  source.frames_ = std::make_unique<drivers::can::SocketCanSource>(socket);
  auto link = source.frames_->open(source.stream_->filters());
  if (!link) return tl::unexpected(named(settings.name, link.error()));
  source.link_ = std::move(*link);
  return source;
}

Expected<void> CanSource::run(SourcePublisher& publisher, const std::stop_token& stop) {
  PublisherSink sink(publisher);
  const auto give_up = [&](const drivers::Error& error) -> Expected<void> {
    const Error named_error = named(name_, error);
    publisher.fail(named_error.message);
    return tl::unexpected(named_error);
  };
  if (auto begun = stream_->begin(link_, sink); !begun) return give_up(begun.error());
  const std::stop_callback on_stop(stop, [this] { frames_->stop(); });
  std::vector<BusEvent> events;
  for (Clock::time_point next_report{}; !stop.stop_requested();) {
    events.clear();
    const auto read = frames_->read(events, wait_limit);
    if (!read) return give_up(read.error());
    for (const BusEvent& event : events) {
      if (const auto* change = std::get_if<LinkChange>(&event); change != nullptr && !change->what.empty())
        spdlog::warn("source {}: {}", name_, change->what);
      if (auto taken = stream_->take(event, sink); !taken) return give_up(taken.error());
    }
    if (events.empty()) stream_->flush(sink);
    if (const auto now = Clock::now(); now >= next_report) {
      publisher.report(to_counts(*stream_));
      publisher.say(to_message(*stream_));
      next_report = now + report_interval;
    }
  }
  stream_->finish(sink);
  publisher.report(to_counts(*stream_));
  publisher.end();
  return {};
}

} // namespace dyncal::services::can
