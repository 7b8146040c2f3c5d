// A recorded candump log of one sensor as a source of samples, read as a whole: what the live
// service makes of the frames, without bus, host and waiting.
//
// The description is the last one that the stream gives, so that it knows how frames were stamped.
// A restart of the sensor within the log leaves a gap of one sample: the numbers go on.
//
// Fails: as read_dbc_file, SensorStream::create and LogSource::open do. Threads as SampleSource.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/can/stream_settings.hpp"
#include "drivers/link/stop_signal.hpp"
#include "drivers/sample_source.hpp"

namespace dyncal::drivers::can {

class LogPlayer : public SampleSource {
public:
  LogPlayer(StreamSettings settings, std::filesystem::path dbc, std::filesystem::path log,
            std::string interface_name)
      : settings_(std::move(settings)), dbc_(std::move(dbc)), log_(std::move(log)),
        interface_name_(std::move(interface_name)) {}

  [[nodiscard]] Expected<SourceDescription> describe() override;
  [[nodiscard]] Expected<void> run(SampleSink& sink) override;
  void stop() override { stop_.raise(); }

private:
  StreamSettings settings_;
  std::filesystem::path dbc_;
  std::filesystem::path log_;
  std::string interface_name_;
  StopSignal stop_;
  SourceDescription description_;
  std::vector<SampleBlock> blocks_;
  std::vector<std::string> warnings_;
  SampleCounts counts_;
};

} // namespace dyncal::drivers::can
