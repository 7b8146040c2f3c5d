// One source of a bench file whose driver is "can": from its settings to its publisher.
//
// prepare() reads the DBC file and opens the interface, so that what is wrong is said before anything is published. run() in a thread of
// the source's own, until `stop` or a failure that waiting cannot mend; interruptions of the link are survived, counted and said in the
// status.
#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "drivers/can/frame_source.hpp"
#include "drivers/can/sensor_stream.hpp"
#include "services/bench/bench_file.hpp"
#include "services/error.hpp"
#include "services/source/source_publisher.hpp"

namespace dyncal::services::can {

class CanSource {
public:
  // Fails (bad_file, bad_argument, device) with a sentence that names the source.
  [[nodiscard]] static Expected<CanSource> prepare(const SourceSettings& settings);

  [[nodiscard]] Expected<void> run(SourcePublisher& publisher, const std::stop_token& stop);

  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; } // of the DBC file

private:
  CanSource() = default;

  std::string name_;
  std::unique_ptr<drivers::can::FrameSource> frames_;
  std::unique_ptr<drivers::can::SensorStream> stream_;
  drivers::can::LinkState link_;
  std::vector<std::string> warnings_;
};

} // namespace dyncal::services::can
