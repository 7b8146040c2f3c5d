#include "services/instruments/played_source.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "drivers/acs/socket_acs.hpp"
#include "drivers/alsa/capture_source.hpp"
#include "drivers/files/file_source.hpp"
#include "drivers/interferometer/interferometer_source.hpp"
#include "drivers/pps/pulse_stamped_source.hpp"
#include "services/bench/file/acs_drivers.hpp"

#ifdef DYNCAL_HAVE_ALSA
#include "drivers/alsa/alsa_device.hpp"
#endif
#include "services/stream/play_of_run.hpp"

namespace dyncal::inline instruments {
namespace {

Error named(const SourceSettings& settings, const drivers::Error& error) {
  ErrorCode code = ErrorCode::device;
  if (settings.is<FileSourceSettings>()) {
    code = ErrorCode::bad_file;
  } else if (error.code == drivers::ErrorCode::invalid_setting) {
    code = ErrorCode::bad_argument;
  } else if (error.code == drivers::ErrorCode::refused ||
             error.code == drivers::ErrorCode::timeout) {
    code = ErrorCode::no_source;
  }
  return {code, fmt::format("source '{}': {}", settings.name, error.message)};
}

Expected<drivers::SourceDescription> describe(drivers::SampleSource& driver,
                                              const SourceSettings& settings,
                                              const std::stop_token& stop) {
  const std::stop_callback stop_driver(stop, [&driver] { driver.stop(); });
  auto description = driver.describe();
  if (stop.stop_requested()) {
    return fail(ErrorCode::interrupted,
                fmt::format("stopped while opening source '{}'", settings.name));
  }
  if (!description) {
    return fail(named(settings, description.error()));
  }
  return *description;
}

Expected<std::unique_ptr<drivers::SampleSource>> make_capture(const SourceSettings& settings) {
#ifdef DYNCAL_HAVE_ALSA
  const auto& alsa = std::get<AlsaSourceSettings>(settings.driver);
  return std::make_unique<drivers::alsa::CaptureSource>(
      drivers::alsa::CaptureSettings{.device = alsa,
                                     .channels = settings.channels,
                                     .units = settings.units,
                                     .scale = alsa.scale},
      drivers::alsa::make_alsa_device);
#else
  return fail(ErrorCode::bad_argument,
              fmt::format("source '{}': this build cannot read sound devices (Debian: "
                          "libasound2-dev)",
                          settings.name));
#endif
}

Expected<std::unique_ptr<drivers::SampleSource>> make_device(const SourceSettings& settings) {
  if (const auto* socket = settings.as<SocketSourceSettings>()) {
    return std::make_unique<drivers::acs::SocketAcs>(drivers::acs::SocketSettings{
        .address = socket->address, .channels = settings.channels, .units = settings.units});
  }
  if (settings.is<AlsaSourceSettings>()) {
    return make_capture(settings);
  }
  if (const auto* acs = settings.as<AcsSourceSettings>()) {
    auto made = acs_driver_named(acs->driver)
                    ->make({acs->texts, acs->numbers, settings.channels, settings.units});
    return made ? Expected<std::unique_ptr<drivers::SampleSource>>(*std::move(made))
                : fail(named(settings, made.error()));
  }
  const auto& played = std::get<FileSourceSettings>(settings.driver);
  drivers::files::FileSettings file;
  file.path = played.path;
  file.speed = played.play_speed;
  file.channels = settings.channels;
  file.units = settings.units;
  file.time_base = settings.time_base;
  file.group = played.group;
  file.u_stamp_s = played.u_stamp_s;
  for (const NamedChannel& channel : played.single) {
    file.single.push_back({channel.path, channel.name});
  }
  file.time_offset_ns = std::llround(played.time_offset_s * 1e9);
  file.scale = played.scale;
  if (played.sample_rate_hz) {
    file.sample_rate = drivers::sample_rate_from_hz(*played.sample_rate_hz);
    if (!file.sample_rate) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("source '{}': invalid sample_rate_hz = {}: must be between 1e-6 and "
                              "1e9 Hz with at most nine decimals",
                              settings.name, *played.sample_rate_hz));
    }
  }
  return std::make_unique<drivers::files::FileSource>(std::move(file));
}

} // namespace

Expected<std::unique_ptr<drivers::SampleSource>> make_driver(const SourceSettings& settings) {
  DYNCAL_TRY(auto device, make_device(settings));
  if (settings.interferometer) {
    device = std::make_unique<drivers::interferometer::InterferometerSource>(
        *settings.interferometer, std::move(device));
  }
  if (settings.pulses) {
    device =
        std::make_unique<drivers::pps::PulseStampedSource>(std::move(device), *settings.pulses);
  }
  return device;
}

SourceKind kind_of(const MethodSettings& method, const std::string& source) {
  if (source == method.reference.source || source == method.sync_acs.source) {
    return SourceKind::acs;
  }
  const bool of_sensor = std::ranges::any_of(
      method.dut, [&](const ChannelName& channel) { return channel.source == source; });
  return source == method.sync_dau.source || of_sensor ? SourceKind::dau : SourceKind::acs;
}

SourceOptions options_of(const BenchFile& bench, const SourceSettings& settings) {
  const bool is_file = settings.is<FileSourceSettings>();
  const bool is_held_back_by_tcp = settings.is<SocketSourceSettings>();
  return {.bench = bench.bench,
          .source = settings.name,
          .kind = kind_of(bench.method, settings.name),
          .identity = settings.identity,
          .origin = settings.origin,
          .silent_after = is_file ? std::chrono::seconds(0) : std::chrono::seconds(2),
          .when_full = is_file               ? WhenFull::wait
                       : is_held_back_by_tcp ? WhenFull::wait_briefly
                                             : WhenFull::drop,
          .hands_out_steps = settings.is<TableSourceSettings>()};
}

Expected<PlayedSource> PlayedSource::prepare(const SourceSettings& settings,
                                             const std::stop_token& stop) {
  DYNCAL_TRY(auto driver, make_driver(settings));
  DYNCAL_TRY(auto description, describe(*driver, settings, stop));
  if (const auto known = check_units(description, settings.identity); !known) {
    return fail(ErrorCode::bad_argument,
                fmt::format("source '{}': {}", settings.name, known.error().message));
  }
  return PlayedSource(settings, std::move(driver), std::move(description));
}

Expected<void> PlayedSource::run(SourcePublisher& publisher, const std::stop_token& stop) {
  publisher.describe(description_);
  auto done = settings_.is<FileSourceSettings>() ? play_for_every_run(publisher, stop)
                                                 : play(publisher, stop);
  if (!done) {
    publisher.fail(done.error().message);
  }
  return done;
}

Expected<void> PlayedSource::play(SourcePublisher& publisher, const std::stop_token& stop) {
  const std::stop_callback stop_driver(stop, [this] { driver_->stop(); });
  if (auto played = driver_->run(publisher); !played) {
    return fail(named(settings_, played.error()));
  }
  publisher.end();
  return {};
}

Expected<void> PlayedSource::play_for_every_run(SourcePublisher& publisher,
                                                const std::stop_token& stop) {
  while (publisher.wait_for_run(stop)) {
    const auto played = play(publisher, PlayOfRun(publisher, stop).token());
    if (!played || stop.stop_requested()) {
      return played;
    }
    // A fresh reader and session for the next run, so that answers before it belong to it.
    DYNCAL_TRY(driver_, make_driver(settings_));
    if (auto described = describe(*driver_, settings_, stop); !described) {
      return stop.stop_requested() ? Expected<void>()
                                   : fail(described.error()); // a stop is not a failure
    }
    publisher.begin_session();
  }
  return {};
}

} // namespace dyncal::inline instruments
