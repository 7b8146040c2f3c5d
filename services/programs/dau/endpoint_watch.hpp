// Watches one address for people: logs a sensor that appears, falls silent or returns, what goes
// wrong with its samples (each cause once), sensors that no bench file names, and sensors that are
// named and do not send; the status of a silent source tells what its address receives instead.
// Called on the receiver's thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "drivers/smartup/reception_observer.hpp"
#include "services/instruments/listening_plan.hpp"
#include "services/stream/source_publisher.hpp"

namespace dyncal::inline programs::dau {

class EndpointWatch : public drivers::smartup::ReceptionObserver {
public:
  explicit EndpointWatch(std::string listen) : listen_(std::move(listen)) {}

  // Before reception starts.
  void add(PlannedSource planned, std::shared_ptr<SourcePublisher> publisher);

  void on_report(const drivers::smartup::SensorReport& report) override;
  void on_report(const drivers::smartup::ReceptionCounts& counts) override;

private:
  struct Source {
    PlannedSource planned;
    std::shared_ptr<SourcePublisher> publisher;
    bool received = false;
    bool silent = false;
    std::set<std::string> reported_causes;
  };

  void report_causes(Source& source);
  void report_unknown(const drivers::smartup::SensorReport& report);
  void watch(Source& source);
  [[nodiscard]] std::string why_silent(const Source& source) const;
  [[nodiscard]] std::string present_sensors() const;

  const std::string listen_;
  std::map<std::uint32_t, Source> sources_;      // by sensor
  std::map<std::uint32_t, std::string> present_; // sensors that were received, with their names
  // Reports of sensors that nobody wants, before they were named in the log.
  std::map<std::uint32_t, int> unknown_;
};

} // namespace dyncal::inline programs::dau
