// A sound device as a source of samples. README.md has its states, and what its numbers and stamps
// mean.
//
// describe() fails where the device cannot be opened as it is to be, and (invalid_setting) where
// settings name a channel that it does not have. Once it has run, a device that is gone is waited
// for until stop(). Values are parts of full scale times `scale`.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/alsa/capture_device.hpp"
#include "drivers/alsa/device_settings.hpp"
#include "drivers/link/stop_signal.hpp"
#include "drivers/sample_source.hpp"

namespace dyncal::drivers::alsa {

struct CaptureSettings {
  DeviceSettings device;
  std::map<std::string, std::string> channels{}; // "channel_1" -> ours
  std::map<std::string, std::string> units{};    // our name -> D-SI
  std::map<std::string, double> scale{};         // our name -> value of full scale
  std::chrono::milliseconds retry_interval{500};
};

using MakeDevice =
    std::function<std::unique_ptr<CaptureDevice>(const DeviceSettings&, const StopSignal&)>;

class CaptureSource : public SampleSource {
public:
  CaptureSource(CaptureSettings settings, const MakeDevice& make_device)
      : settings_(std::move(settings)), device_(make_device(settings_.device, stop_)) {}

  [[nodiscard]] Expected<SourceDescription> describe() override;
  [[nodiscard]] Expected<void> run(SampleSink& sink) override;
  void stop() override { stop_.raise(); }

private:
  [[nodiscard]] Expected<void> name_channels();
  void take(SampleSink& sink, const Captured& captured, std::span<const std::byte> frames);
  void begin_again(SampleSink& sink, Instant started);
  // When it started; nothing: stopped.
  [[nodiscard]] std::optional<Instant> open_again(SampleSink& sink, const std::string& problem);
  [[nodiscard]] std::optional<Instant> restart(SampleSink& sink, const Captured& captured);
  void count(SampleSink& sink) const;

  CaptureSettings settings_;
  StopSignal stop_;
  std::unique_ptr<CaptureDevice> device_;
  SourceDescription description_;
  std::vector<double> scale_;
  SampleCounts counts_;
  std::uint64_t next_sample_ = 0;
  std::uint64_t taken_ = 0; // by the device, as far as is known
  Instant taken_at_{};      // when it had
  std::uint64_t overruns_ = 0;
  std::uint64_t absences_ = 0;
};

} // namespace dyncal::drivers::alsa
