#include "services/programs/can/can_source.hpp"

#include <chrono>
#include <utility>

#include <fmt/core.h>

#include "drivers/can/bus/log_source.hpp"
#include "drivers/can/bus/socketcan_source.hpp"
#include "drivers/can/dbc/dbc.hpp"
#include "services/instruments/stream_settings.hpp"
#include "services/programs/can/can_status.hpp"
#include "services/stream/play_of_run.hpp"

namespace dyncal::inline programs::can {

namespace {

using Clock = std::chrono::steady_clock;
using drivers::can::BusEvent;
using drivers::can::ReadState;

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

std::unique_ptr<drivers::can::FrameSource> open_interface(const CanSourceSettings& can) {
  drivers::can::SocketCanSettings socket;
  socket.interface_name = can.interface_name;
  socket.bit_rate_per_s = static_cast<std::uint32_t>(can.bit_rates.nominal_per_s);
  socket.data_bit_rate_per_s = static_cast<std::uint32_t>(can.bit_rates.data_per_s);
  if (can.restart_after_bus_off_s) {
    socket.restart_after_bus_off =
        std::chrono::milliseconds(static_cast<std::int64_t>(*can.restart_after_bus_off_s * 1e3));
  }
  return std::make_unique<drivers::can::SocketCanSource>(std::move(socket));
}

} // namespace

std::unique_ptr<drivers::can::FrameSource> make_frame_source(const CanSourceSettings& can) {
  if (can.log.empty()) {
    return open_interface(can);
  }
  return std::make_unique<drivers::can::LogSource>(can.log, can.interface_name, can.play_speed);
}

SourceOptions options_of(const std::string& bench, const SourceSettings& settings) {
  const bool log = !std::get<CanSourceSettings>(settings.driver).log.empty();
  return {.bench = bench,
          .source = settings.name,
          .kind = SourceKind::can,
          .identity = settings.identity,
          .origin = settings.origin,
          .silent_after = log ? std::chrono::seconds(0) : std::chrono::seconds(2),
          .when_full = log ? WhenFull::wait : WhenFull::drop};
}

Expected<CanSource> CanSource::prepare(const SourceSettings& settings,
                                       MakeFrameSource make_frames) {
  CanSource source(settings, std::move(make_frames));
  DYNCAL_TRY(source.open());
  return source;
}

// A fresh reader of the frames and of the sensor's numbering.
Expected<void> CanSource::open() {
  auto dbc = drivers::can::read_dbc_file(can_.dbc);
  if (!dbc) {
    return fail(named(name_, dbc.error()));
  }
  warnings_ = dbc->warnings;
  auto stream = drivers::can::SensorStream::create(stream_, std::move(*dbc));
  if (!stream) {
    return fail(named(name_, stream.error()));
  }
  sensor_ = std::move(*stream);
  frames_ = make_frames_(can_);
  auto link = frames_->open(sensor_->filters());
  if (!link) {
    return fail(named(name_, link.error()));
  }
  link_ = std::move(*link);
  return {};
}

Expected<void> CanSource::run(SourcePublisher& publisher, const std::stop_token& stop) {
  auto done = begin(publisher).and_then([&] {
    return can_.log.empty() ? receive(publisher, stop) : play_for_every_run(publisher, stop);
  });
  if (!done) {
    publisher.fail(done.error().message);
  }
  return done;
}

Expected<void> CanSource::begin(SourcePublisher& publisher) {
  return sensor_->begin(link_, publisher).map_error([&](const drivers::Error& error) {
    return named(name_, error);
  });
}

Expected<void> CanSource::play_for_every_run(SourcePublisher& publisher,
                                             const std::stop_token& stop) {
  while (publisher.wait_for_run(stop)) {
    const auto played = receive(publisher, PlayOfRun(publisher, stop).token());
    if (!played || stop.stop_requested()) {
      return played;
    }
    publisher.begin_session(); // answers before the next run belong to it
    DYNCAL_TRY(open().and_then([&] { return begin(publisher); }));
  }
  return {};
}

Expected<void> CanSource::receive(SourcePublisher& publisher, const std::stop_token& stop) {
  const std::stop_callback on_stop(stop, [this] { frames_->stop(); });
  const auto begin = Clock::now();
  const auto report = [&] {
    sensor_->count(publisher);
    publisher.set_message(to_message(*sensor_, Clock::now() - begin));
  };
  std::vector<BusEvent> events;
  bool ended = false;
  for (Clock::time_point next_report{}; !ended && !stop.stop_requested();) {
    events.clear();
    const auto read = frames_->read(events, wait_limit);
    if (!read) {
      return fail(named(name_, read.error()));
    }
    ended = *read == ReadState::ended;
    for (const BusEvent& event : events) {
      if (auto taken = sensor_->take(event, publisher); !taken) {
        return fail(named(name_, taken.error()));
      }
    }
    if (events.empty()) {
      sensor_->flush(publisher);
    }
    if (const auto now = Clock::now(); now >= next_report) {
      report();
      next_report = now + report_interval;
    }
  }
  sensor_->finish(publisher);
  report();
  publisher.end();
  return {};
}

} // namespace dyncal::inline programs::can
