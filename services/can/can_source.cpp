#include "services/can/can_source.hpp"

#include <chrono>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "drivers/can/bus/log_source.hpp"
#include "drivers/can/bus/socketcan_source.hpp"
#include "drivers/can/dbc/dbc.hpp"
#include "drivers/can/time/system_clock.hpp"
#include "services/can/can_status.hpp"

namespace dyncal::services::can {

namespace {

using Clock = std::chrono::steady_clock;
using drivers::can::BusEvent;
using drivers::can::LinkChange;
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

class PublisherSink : public drivers::can::SampleSink {
public:
  // `patient`: frames that can wait do so while the publisher has no room; what a live bus says is
  // counted there as dropped.
  PublisherSink(SourcePublisher& publisher, bool patient, std::stop_token stop)
      : publisher_(publisher), patient_(patient), stop_(std::move(stop)) {}
  void describe(const drivers::SourceDescription& description) override {
    publisher_.describe(description);
  }
  void restart() override { publisher_.start_session(); }
  void take(drivers::SampleBlock block) override {
    if (patient_) {
      publisher_.offer_waiting(std::move(block), stop_);
    } else {
      publisher_.offer(std::move(block));
    }
  }

private:
  SourcePublisher& publisher_;
  bool patient_;
  std::stop_token stop_;
};

std::unique_ptr<drivers::can::FrameSource> open_interface(const CanSourceSettings& can) {
  drivers::can::SocketCanSettings socket;
  socket.interface_name = can.interface_name;
  socket.bit_rate_per_s = static_cast<std::uint32_t>(can.sensor.bit_rates.nominal_per_s);
  socket.data_bit_rate_per_s = static_cast<std::uint32_t>(can.sensor.bit_rates.data_per_s);
  if (can.restart_after_bus_off_s) {
    socket.restart_after_bus_off =
        std::chrono::milliseconds(static_cast<std::int64_t>(*can.restart_after_bus_off_s * 1e3));
  }
  return std::make_unique<drivers::can::SocketCanSource>(std::move(socket));
}

} // namespace

std::unique_ptr<drivers::can::FrameSource> make_frame_source(const SourceSettings& settings) {
  const CanSourceSettings& can = *settings.can;
  if (can.log.empty()) {
    return open_interface(can);
  }
  return std::make_unique<drivers::can::LogSource>(can.log, can.interface_name,
                                                   settings.play_speed);
}

Expected<CanSource> CanSource::prepare(const SourceSettings& settings,
                                       MakeFrameSource make_frames) {
  CanSource source(settings, std::move(make_frames));
  drivers::can::SensorSettings& sensor = source.settings_.can->sensor;
  // This host's clock says nothing of the one that stamped a log.
  if (!settings.can->log.empty() && !sensor.u_utc_s) {
    sensor.u_utc_s = drivers::can::u_undisciplined_clock_s();
  }
  if (auto opened = source.open(); !opened) {
    return fail(opened.error());
  }
  return source;
}

// A fresh reader of the frames and of the sensor's numbering.
Expected<void> CanSource::open() {
  const CanSourceSettings& can = *settings_.can;
  auto dbc = drivers::can::read_dbc_file(can.dbc);
  if (!dbc) {
    return fail(named(settings_.name, dbc.error()));
  }
  warnings_ = dbc->warnings;
  auto stream = drivers::can::SensorStream::create(can.sensor, std::move(*dbc));
  if (!stream) {
    return fail(named(settings_.name, stream.error()));
  }
  stream_ = std::move(*stream);
  frames_ = make_frames_(settings_);
  auto link = frames_->open(stream_->filters());
  if (!link) {
    return fail(named(settings_.name, link.error()));
  }
  link_ = std::move(*link);
  return {};
}

Expected<void> CanSource::run(SourcePublisher& publisher, const std::stop_token& stop) {
  auto done = begin(publisher, stop).and_then([&] {
    return settings_.can->log.empty() ? receive(publisher, stop)
                                      : play_for_every_run(publisher, stop);
  });
  if (!done) {
    publisher.fail(done.error().message);
  }
  return done;
}

Expected<void> CanSource::begin(SourcePublisher& publisher, const std::stop_token& stop) {
  PublisherSink sink(publisher, false, stop);
  return stream_->begin(link_, sink).map_error([&](const drivers::Error& error) {
    return named(settings_.name, error);
  });
}

Expected<void> CanSource::play_for_every_run(SourcePublisher& publisher,
                                             const std::stop_token& stop) {
  while (publisher.wait_for_run(stop)) {
    if (auto played = receive(publisher, stop); !played || stop.stop_requested()) {
      return played;
    }
    publisher.start_session(); // what is said before the next run belongs to it
    if (auto opened = open().and_then([&] { return begin(publisher, stop); }); !opened) {
      return opened;
    }
  }
  return {};
}

Expected<void> CanSource::receive(SourcePublisher& publisher, const std::stop_token& stop) {
  PublisherSink sink(publisher, !settings_.can->log.empty(), stop);
  const std::stop_callback on_stop(stop, [this] { frames_->stop(); });
  const auto begin = Clock::now();
  const auto tell = [&] {
    publisher.report(to_counts(*stream_));
    publisher.say(to_message(*stream_, Clock::now() - begin));
  };
  std::vector<BusEvent> events;
  bool ended = false;
  for (Clock::time_point next_report{}; !ended && !stop.stop_requested();) {
    events.clear();
    const auto read = frames_->read(events, wait_limit);
    if (!read) {
      return fail(named(settings_.name, read.error()));
    }
    ended = *read == ReadState::ended;
    for (const BusEvent& event : events) {
      if (const auto* change = std::get_if<LinkChange>(&event);
          change != nullptr && !change->what.empty()) {
        spdlog::warn("source {}: {}", settings_.name, change->what);
      }
      if (auto taken = stream_->take(event, sink); !taken) {
        return fail(named(settings_.name, taken.error()));
      }
    }
    if (events.empty()) {
      stream_->flush(sink);
    }
    if (const auto now = Clock::now(); now >= next_report) {
      tell();
      next_report = now + report_interval;
    }
  }
  stream_->finish(sink);
  tell();
  publisher.end();
  return {};
}

} // namespace dyncal::services::can
