#include "services/acs/played_source.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "drivers/acs/socket_acs.hpp"
#include "drivers/files/file_source.hpp"

namespace dyncal::services::acs {
namespace {

Error named(const SourceSettings& settings, const drivers::Error& error) {
  ErrorCode code = ErrorCode::device;
  if (settings.driver == SourceDriver::file) {
    code = ErrorCode::bad_file;
  } else if (error.code == drivers::ErrorCode::refused ||
             error.code == drivers::ErrorCode::timeout) {
    code = ErrorCode::no_source;
  }
  return {code, fmt::format("source '{}': {}", settings.name, error.message)};
}

Expected<drivers::SourceDescription> describe(drivers::acs::AcsDriver& driver,
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

// The names of the bench file over those of the instrument. A file does this itself.
Expected<void> rename_channels(const SourceSettings& settings,
                               drivers::SourceDescription& description) {
  if (settings.driver == SourceDriver::file) {
    return {};
  }
  auto& channels = description.channels;
  for (const auto& [device_name, name] : settings.channels) {
    const auto found = std::ranges::find(channels, device_name, &drivers::ChannelDescription::name);
    if (found == channels.end()) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("source '{}': the instrument at {} has no channel '{}'",
                              settings.name, settings.address, device_name));
    }
    found->name = name;
  }
  for (const auto& [name, unit] : settings.units) {
    const auto found = std::ranges::find(channels, name, &drivers::ChannelDescription::name);
    if (found == channels.end()) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("source '{}': a unit is given for '{}', which is no channel of it",
                              settings.name, name));
    }
    found->unit = unit;
  }
  return {};
}

class PublishingSink : public drivers::acs::BlockSink {
public:
  PublishingSink(const SourceSettings& settings, SourcePublisher& publisher, std::stop_token stop)
      : settings_(settings), publisher_(publisher), stop_(std::move(stop)) {}

  void begin_session(const drivers::SourceDescription& description) override {
    publisher_.start_session();
    next_sample_.reset();
    drivers::SourceDescription renamed = description;
    if (const auto done = rename_channels(settings_, renamed); !done) {
      publisher_.say(done.error().message); // an instrument that came back with other channels: who
                                            // needs them will miss them
    }
    publisher_.describe(std::move(renamed));
  }

  void take(drivers::SampleBlock block) override {
    if (next_sample_ && block.first_sample > *next_sample_) {
      counts_.lost_in_device += block.first_sample - *next_sample_;
    }
    next_sample_ = block.first_sample + block.samples;
    counts_.received += block.samples;
    publisher_.offer_waiting(std::move(block), stop_);
    publisher_.report(counts_);
  }

private:
  const SourceSettings& settings_;
  SourcePublisher& publisher_;
  std::stop_token stop_;
  SourceCounts counts_;
  std::optional<std::uint64_t> next_sample_;
};

} // namespace

Expected<std::unique_ptr<drivers::acs::AcsDriver>> make_driver(const SourceSettings& settings) {
  if (settings.driver == SourceDriver::socket) {
    drivers::acs::SocketSettings socket;
    socket.address = settings.address;
    return std::make_unique<drivers::acs::SocketAcs>(std::move(socket));
  }
  drivers::acs::FileSettings file;
  file.path = settings.path;
  file.speed = settings.play_speed;
  file.channels = settings.channels;
  file.units = settings.units;
  file.time_base = settings.time_base;
  if (settings.sample_rate_hz) {
    file.sample_rate = drivers::acs::sample_rate_from_hz(*settings.sample_rate_hz);
    if (!file.sample_rate) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("source '{}': sample_rate_hz = {} cannot be; write a rate between "
                              "1e-6 and 1e9 Hz with at most nine decimals",
                              settings.name, *settings.sample_rate_hz));
    }
  }
  return std::make_unique<drivers::acs::FileSource>(std::move(file));
}

SourceKind kind_of(const MethodSettings& method, const std::string& source) {
  if (source == method.reference.source || source == method.sync_acs.source) {
    return SourceKind::acs;
  }
  const bool of_sensor = std::ranges::any_of(
      method.dut, [&](const ChannelName& channel) { return channel.source == source; });
  return source == method.sync_dau.source || of_sensor ? SourceKind::dau : SourceKind::acs;
}

Expected<PlayedSource> PlayedSource::prepare(const SourceSettings& settings,
                                             const std::stop_token& stop) {
  auto driver = make_driver(settings);
  if (!driver) {
    return fail(driver.error());
  }
  auto description = describe(**driver, settings, stop);
  if (!description) {
    return fail(description.error());
  }
  if (auto renamed = rename_channels(settings, *description); !renamed) {
    return fail(renamed.error());
  }
  return PlayedSource(settings, std::move(*driver), std::move(*description));
}

Expected<void> PlayedSource::run(SourcePublisher& publisher, const std::stop_token& stop) {
  publisher.describe(description_);
  auto done = settings_.driver == SourceDriver::file ? play_for_every_run(publisher, stop)
                                                     : play(publisher, stop);
  if (!done) {
    publisher.fail(done.error().message);
  }
  return done;
}

Expected<void> PlayedSource::play(SourcePublisher& publisher, const std::stop_token& stop) {
  PublishingSink sink(settings_, publisher, stop);
  const std::stop_callback stop_driver(stop, [this] { driver_->stop(); });
  if (auto played = driver_->run(sink); !played) {
    return fail(named(settings_, played.error()));
  }
  publisher.end();
  return {};
}

Expected<void> PlayedSource::play_for_every_run(SourcePublisher& publisher,
                                                const std::stop_token& stop) {
  while (publisher.wait_for_run(stop)) {
    if (auto played = play(publisher, stop); !played || stop.stop_requested()) {
      return played;
    }
    // A fresh reader and session for the next run, so that what is said before it belongs to it.
    auto driver = make_driver(settings_);
    if (!driver) {
      return fail(driver.error());
    }
    driver_ = std::move(*driver);
    if (auto described = describe(*driver_, settings_, stop); !described) {
      return stop.stop_requested() ? Expected<void>()
                                   : fail(described.error()); // a stop is no failure
    }
    publisher.start_session();
  }
  return {};
}

} // namespace dyncal::services::acs
