// Keeps what a receiver hands on, for tests. May be read from another thread while the receiver
// runs.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "drivers/smartup/sample_sink.hpp"

namespace dyncal::tests {

class RecordingSink : public drivers::smartup::SampleSink {
public:
  void on_description(std::uint32_t sensor,
                      const drivers::SourceDescription& description) override {
    const std::lock_guard lock(mutex);
    descriptions[sensor].push_back(description);
  }
  void on_warning(std::uint32_t sensor, const std::string& sentence) override {
    const std::lock_guard lock(mutex);
    warnings[sensor].push_back(sentence);
  }
  void on_new_session(std::uint32_t sensor) override {
    const std::lock_guard lock(mutex);
    sessions_begun_at[sensor].push_back(blocks[sensor].size());
  }
  void on_block(std::uint32_t sensor, drivers::SampleBlock block) override {
    const std::lock_guard lock(mutex);
    blocks[sensor].push_back(std::move(block));
  }
  void on_report(const drivers::smartup::SensorReport& report) override {
    const std::lock_guard lock(mutex);
    reports[report.sensor] = report;
  }
  void on_report(const drivers::smartup::ReceptionCounts& counts) override {
    const std::lock_guard lock(mutex);
    reception = counts;
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
  std::map<std::uint32_t, drivers::smartup::SensorReport> reports;
  drivers::smartup::ReceptionCounts reception;
};

} // namespace dyncal::tests
