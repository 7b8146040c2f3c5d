// One source of a bench file whose driver is "can": from its settings to its publisher.
//
// prepare() reads the DBC file and opens the interface or the log, so that errors are reported
// before anything is published. run() serves it until `stop` or a failure that waiting cannot mend;
// interruptions of the link are survived, counted and reported in the status. A log waits until a
// measurement of its bench is RUNNING, is played, ends its stream and waits for the next one.
//
// Threads: prepare() from one thread; run() in a thread of the source's own.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "drivers/can/bus/frame_source.hpp"
#include "drivers/can/sensor_stream.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/instruments/stream_settings.hpp"
#include "services/stream/source_publisher.hpp"

namespace dyncal::inline programs::can {

// Where the frames of a source come from: its interface or its log.
[[nodiscard]] std::unique_ptr<drivers::can::FrameSource>
make_frame_source(const CanSourceSettings& settings);

// Where such a source publishes. A log waits for room; what a live bus delivers is dropped and
// counted when there is none. REQUIRES: its driver is "can".
[[nodiscard]] SourceOptions options_of(const std::string& bench, const SourceSettings& settings);

class CanSource {
public:
  using MakeFrameSource =
      std::function<std::unique_ptr<drivers::can::FrameSource>(const CanSourceSettings&)>;

  // Fails (bad_file, bad_argument, device) with a sentence that names the source. REQUIRES: its
  // driver is "can".
  [[nodiscard]] static Expected<CanSource> prepare(const SourceSettings& settings,
                                                   MakeFrameSource make_frames = make_frame_source);

  [[nodiscard]] Expected<void> run(SourcePublisher& publisher, const std::stop_token& stop);

  [[nodiscard]] const std::vector<std::string>& warnings() const {
    return warnings_;
  } // of the DBC file

private:
  CanSource(const SourceSettings& settings, MakeFrameSource make_frames)
      : name_(settings.name), can_(std::get<CanSourceSettings>(settings.driver)),
        stream_(stream_settings(settings)), make_frames_(std::move(make_frames)) {}

  [[nodiscard]] Expected<void> open();
  [[nodiscard]] Expected<void> begin(SourcePublisher& publisher);
  [[nodiscard]] Expected<void> receive(SourcePublisher& publisher, const std::stop_token& stop);
  [[nodiscard]] Expected<void> play_for_every_run(SourcePublisher& publisher,
                                                  const std::stop_token& stop);

  std::string name_;
  CanSourceSettings can_;
  drivers::can::StreamSettings stream_;
  MakeFrameSource make_frames_;
  std::unique_ptr<drivers::can::FrameSource> frames_;
  std::unique_ptr<drivers::can::SensorStream> sensor_;
  drivers::can::LinkState link_;
  std::vector<std::string> warnings_;
};

} // namespace dyncal::inline programs::can
