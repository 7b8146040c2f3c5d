// One source of a bench file whose driver is "socket", "alsa" or "file", from its settings
// to its publisher.
//
// An instrument's stream is published as it comes. A file waits until a measurement of its bench is
// RUNNING, is played as long as that run lasts, ends its stream, and waits for the next one. A file
// waits for room in the publisher's ring; an instrument for a second at most, and never for a
// reader (options_of).
//
// Threads: prepare() from one thread; run() in a thread of the source's own.
#pragma once

#include <memory>
#include <stop_token>

#include "drivers/sample_source.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/stream/source_publisher.hpp"

namespace dyncal::inline instruments {

class PlayedSource {
public:
  // Opens the file, or connects to the instrument (tries for five seconds). Fails (bad_file,
  // bad_argument, no_source, device, interrupted) with a sentence that names the source.
  [[nodiscard]] static Expected<PlayedSource> prepare(const SourceSettings& settings,
                                                      const std::stop_token& stop);

  // Until `stop`, or the end of an instrument's stream; what goes wrong is also the publisher's
  // last message.
  [[nodiscard]] Expected<void> run(SourcePublisher& publisher, const std::stop_token& stop);

  [[nodiscard]] const SourceSettings& settings() const { return settings_; }

private:
  PlayedSource(SourceSettings settings, std::unique_ptr<drivers::SampleSource> driver,
               drivers::SourceDescription description)
      : settings_(std::move(settings)), driver_(std::move(driver)),
        description_(std::move(description)) {}
  Expected<void> play(SourcePublisher& publisher, const std::stop_token& stop);
  Expected<void> play_for_every_run(SourcePublisher& publisher, const std::stop_token& stop);

  SourceSettings settings_;
  std::unique_ptr<drivers::SampleSource> driver_;
  drivers::SourceDescription description_;
};

// The driver of a source of a bench file whose driver is "socket", "alsa" or "file", not opened
// yet. Fails (bad_argument) with invalid settings.
[[nodiscard]] Expected<std::unique_ptr<drivers::SampleSource>>
make_driver(const SourceSettings& settings);

// DAU for the source of the role sync_dau (and of the sensor's channels where there is no such
// role), ACS for the others.
[[nodiscard]] SourceKind kind_of(const MethodSettings& method, const std::string& source);

// Where such a source publishes, and how long it waits for room.
[[nodiscard]] SourceOptions options_of(const BenchFile& bench, const SourceSettings& settings);

} // namespace dyncal::inline instruments
