// Keeps what a receiver hands on, for tests. May be read from another thread while the receiver
// runs.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "drivers/smartup/reception_observer.hpp"
#include "drivers/smartup/sensor.hpp"

namespace dyncal::tests {

class Recording : public drivers::smartup::ReceptionObserver {
public:
  // The settings, with a sink that records under the sensor's id.
  drivers::smartup::WantedSensor wanted(drivers::smartup::SensorSettings settings) {
    sinks_.push_back(std::make_unique<Sink>(*this, settings.sensor));
    return {std::move(settings), sinks_.back().get()};
  }

  void on_report(const drivers::smartup::SensorReport& report) override {
    const std::lock_guard lock(mutex);
    reports[report.sensor] = report;
  }
  void on_report(const drivers::smartup::ReceptionCounts& of_address) override {
    const std::lock_guard lock(mutex);
    reception = of_address;
  }

  std::size_t samples(std::uint32_t sensor) {
    const std::lock_guard lock(mutex);
    std::size_t samples = 0;
    for (const auto& block : blocks[sensor]) {
      samples += block.samples;
    }
    return samples;
  }

  std::mutex mutex;
  std::map<std::uint32_t, std::vector<drivers::SourceDescription>> descriptions;
  std::map<std::uint32_t, std::vector<std::string>> warnings;
  std::map<std::uint32_t, std::vector<std::size_t>> sessions_begun_at; // before which block
  std::map<std::uint32_t, std::vector<drivers::SampleBlock>> blocks;
  std::map<std::uint32_t, drivers::SampleCounts> counts; // the newest
  std::map<std::uint32_t, drivers::smartup::SensorReport> reports;
  drivers::smartup::ReceptionCounts reception;

private:
  class Sink : public drivers::SampleSink {
  public:
    Sink(Recording& recording, std::uint32_t sensor) : recording_(recording), sensor_(sensor) {}

    void describe(const drivers::SourceDescription& description) override {
      const std::lock_guard lock(recording_.mutex);
      recording_.descriptions[sensor_].push_back(description);
    }
    void begin_session() override {
      const std::lock_guard lock(recording_.mutex);
      recording_.sessions_begun_at[sensor_].push_back(recording_.blocks[sensor_].size());
    }
    void take(drivers::SampleBlock block) override {
      const std::lock_guard lock(recording_.mutex);
      recording_.blocks[sensor_].push_back(std::move(block));
    }
    void count(const drivers::SampleCounts& now) override {
      const std::lock_guard lock(recording_.mutex);
      recording_.counts[sensor_] = now;
    }
    void warn(const std::string& sentence) override {
      const std::lock_guard lock(recording_.mutex);
      recording_.warnings[sensor_].push_back(sentence);
    }

  private:
    Recording& recording_;
    const std::uint32_t sensor_;
  };

  std::vector<std::unique_ptr<Sink>> sinks_;
};

} // namespace dyncal::tests
