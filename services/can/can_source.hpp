// One source of a bench file whose driver is "can": from its settings to its publisher.
//
// prepare() reads the DBC file and opens the interface or the log, so that what is wrong is said
// before anything is published. run() in a thread of the source's own, until `stop` or a failure
// that waiting cannot mend; interruptions of the link are survived, counted and said in the status.
// A log waits until a measurement of its bench is RUNNING, is played, ends its stream and waits for
// the next one.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "drivers/can/bus/frame_source.hpp"
#include "drivers/can/sensor_stream.hpp"
#include "services/bench/bench_file.hpp"
#include "services/error.hpp"
#include "services/source/source_publisher.hpp"

namespace dyncal::services::can {

// Where the frames of a source come from: its interface or its log.
[[nodiscard]] std::unique_ptr<drivers::can::FrameSource>
make_frame_source(const SourceSettings& settings);

class CanSource {
public:
  using MakeFrameSource =
      std::function<std::unique_ptr<drivers::can::FrameSource>(const SourceSettings&)>;

  // Fails (bad_file, bad_argument, device) with a sentence that names the source.
  [[nodiscard]] static Expected<CanSource> prepare(const SourceSettings& settings,
                                                   MakeFrameSource make_frames = make_frame_source);

  [[nodiscard]] Expected<void> run(SourcePublisher& publisher, const std::stop_token& stop);

  [[nodiscard]] const std::vector<std::string>& warnings() const {
    return warnings_;
  } // of the DBC file

private:
  CanSource(SourceSettings settings, MakeFrameSource make_frames)
      : settings_(std::move(settings)), make_frames_(std::move(make_frames)) {}

  [[nodiscard]] Expected<void> open();
  [[nodiscard]] Expected<void> begin(SourcePublisher& publisher, const std::stop_token& stop);
  [[nodiscard]] Expected<void> receive(SourcePublisher& publisher, const std::stop_token& stop);
  [[nodiscard]] Expected<void> play_for_every_run(SourcePublisher& publisher,
                                                  const std::stop_token& stop);

  SourceSettings settings_;
  MakeFrameSource make_frames_;
  std::unique_ptr<drivers::can::FrameSource> frames_;
  std::unique_ptr<drivers::can::SensorStream> stream_;
  drivers::can::LinkState link_;
  std::vector<std::string> warnings_;
};

} // namespace dyncal::services::can
