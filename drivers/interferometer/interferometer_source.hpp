// A source of samples whose device records the two quadrature signals of a laser interferometer:
// they go in, a displacement comes out, at a rate that DDS carries, with all other channels
// (ISO 16063-11, method 3).
//
//   device --blocks--> u1, u2 -> phase -> low-pass, every D-th -> displacement  --blocks--> sink
//                      sync, others ----> low-pass, every D-th -> the same
//
// Samples about whose phase nothing is known or which is doubtful are NaN in the displacement
// (quadrature_demodulator.hpp), are counted by cause, and a sentence warns of them once as long as
// they last. Numbers, stamps and gaps: decimated_channels.hpp. The source is described anew when
// its ellipse has changed.
//
// describe() fails (invalid_setting) where the device lacks a channel, has one of the name of the
// displacement, states two units for the pair or no rate, or where its rate is no whole multiple of
// the output rate. Threads as drivers/sample_source.hpp.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/interferometer/decimated_channels.hpp"
#include "drivers/interferometer/interferometer_settings.hpp"
#include "drivers/interferometer/pair_recording.hpp"
#include "drivers/interferometer/quadrature_demodulator.hpp"
#include "drivers/interferometer/signal_complaints.hpp"
#include "drivers/sample_source.hpp"

namespace dyncal::drivers::interferometer {

// What the device's description and the settings make of each other.
struct StreamLayout {
  std::size_t u1 = 0; // columns of the device
  std::size_t u2 = 0;
  std::size_t factor = 1;
  PairRanges ranges{};
  SourceDescription output; // the displacement is its last channel
};

[[nodiscard]] Expected<StreamLayout> lay_out(const SourceDescription& device,
                                             const InterferometerSettings& settings);

class InterferometerSource : public SampleSource, private SampleSink {
public:
  InterferometerSource(InterferometerSettings settings, std::unique_ptr<SampleSource> device)
      : settings_(std::move(settings)), device_(std::move(device)) {}

  [[nodiscard]] Expected<SourceDescription> describe() override;
  [[nodiscard]] Expected<void> run(SampleSink& sink) override;
  void stop() override { device_->stop(); }

private:
  void describe(const SourceDescription& description) override;
  void begin_session() override;
  void take(SampleBlock block) override;
  void count(const SampleCounts& counts) override;
  void warn(const std::string& sentence) override { sink_->warn(sentence); }

  void set_up(StreamLayout layout);
  [[nodiscard]] SourceDescription description() const;
  void describe_if_changed();
  [[nodiscard]] SampleBlock decimated(const SampleBlock& block);

  InterferometerSettings settings_;
  std::unique_ptr<SampleSource> device_;
  SampleSink* sink_ = nullptr;
  SourceDescription of_device_;
  std::optional<StreamLayout> layout_; // none: what came back is another instrument
  std::optional<QuadratureDemodulator> demodulator_;
  std::optional<DecimatedChannels> channels_;
  std::optional<SignalComplaints> complaints_;
  std::optional<PairRecording> recording_;
  QuadratureSignals described_;
  std::vector<double> turns_;
  SampleCounts counts_;
  std::optional<std::uint64_t> next_output_;
};

} // namespace dyncal::drivers::interferometer
