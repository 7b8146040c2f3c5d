// Carries what comes in at one address to the sources that want it, and says what a person should
// know: a sensor that appears, falls silent or comes back, what is wrong (each cause once), sensors
// that no bench file names, and sensors that are named and do not come. Called on the receiver's
// thread; never blocks.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "drivers/smartup/sample_sink.hpp"
#include "services/dau/event_lines.hpp"
#include "services/dau/listening_plan.hpp"
#include "services/source/source_publisher.hpp"

namespace dyncal::services::dau {

class EndpointSink : public drivers::smartup::SampleSink {
public:
  // `lines` outlives the sink.
  EndpointSink(std::string listen, EventLines& lines);

  // Before reception starts.
  void add(PlannedSource planned, std::shared_ptr<SourcePublisher> publisher);

  void on_description(std::uint32_t sensor, const drivers::SourceDescription& description) override;
  void on_warning(std::uint32_t sensor, const std::string& sentence) override;
  void on_new_session(std::uint32_t sensor) override;
  void on_block(std::uint32_t sensor, drivers::SampleBlock block) override;
  void on_report(const drivers::smartup::SensorReport& report) override;
  void on_report(const drivers::smartup::ReceptionCounts& counts) override;

private:
  struct Source {
    PlannedSource planned;
    std::shared_ptr<SourcePublisher> publisher;
    bool received = false;
    bool silent = false;
    std::set<std::string> causes_said;
  };

  [[nodiscard]] Source* source_of(std::uint32_t sensor);
  void say_causes(Source& source, const SourceCounts& counts);
  void report_unknown(const drivers::smartup::SensorReport& report);
  void watch(Source& source);
  [[nodiscard]] std::string present_sensors() const;

  const std::string listen_;
  EventLines& lines_;
  std::map<std::uint32_t, Source> sources_;      // by sensor
  std::map<std::uint32_t, std::string> present_; // sensors that were received, with their names
  std::map<std::uint32_t, int>
      unknown_; // reports of sensors that nobody wants, before they were named in the log
  drivers::smartup::ReceptionCounts reception_;
};

} // namespace dyncal::services::dau
