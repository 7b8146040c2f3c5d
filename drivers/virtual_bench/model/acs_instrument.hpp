// The analogue calibration system of the virtual bench: reference acceleration and sync, or the two
// signals of an interferometer and sync (interferometer.hpp), equidistant in a clock of its own.
//
// Sample n is taken at bench time n (1 + rate_error) / rate and stamped origin_ns + n / rate:
// neither epoch nor rate is that of the bench, unless it is disciplined to UTC. The reference has a
// gain and a phase error, drawn once from the standard uncertainties that the recipe states; of an
// interferometer it is the spot on the table at which it looks that moves by so much differently.
//
// On demand a third channel has the pulse-per-second output of a GPS receiver, from each second of
// UTC on: 3.3 V for 0.1 s, behind the filter that keeps aliases away.
//
// Values are counts of a 24-bit converter, of 14 bits with an interferometer, whose channels have
// none of `reference_faults` and `sync_faults`; drivers/acs/README.md describes the stream that
// carries them. One thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/virtual_bench/model/bench_faults.hpp"
#include "drivers/virtual_bench/model/channel_disturbance.hpp"
#include "drivers/virtual_bench/model/excitation.hpp"
#include "drivers/virtual_bench/model/interferometer.hpp"
#include "drivers/virtual_bench/model/random.hpp"

namespace dyncal::drivers::virtual_bench {

struct AcsSettings {
  std::uint64_t seed = 1;
  std::int64_t rate_hz = 20000;
  std::int64_t origin_ns = 0;
  double highest_level_m_s2 = 130.0;
  double sync_amplitude_v = 9.75;
  bool sync_is_first_output = false; // sync is what drives the exciter, not the generator's second
                                     // output of constant amplitude
  double reference_magnitude_rel = 1e-3; // standard uncertainties
  double reference_phase_rad = 1.7e-3;
  double max_rate_error = 0.5e-6;
  bool utc = false; // disciplined: the rate has no error, and origin_ns is UTC
  ChannelFaults reference_faults;
  ChannelFaults sync_faults;
  SampleLoss loss;                                      // of what it sends at a time
  std::optional<InterferometerSettings> interferometer; // in place of the reference channel
  // UTC at bench time 0, for the channel with pulses; empty: there is none.
  std::optional<std::int64_t> pulses_utc_origin_ns{};
};

struct AcsSamples {
  std::uint64_t first_sample = 0;
  std::size_t channels = 2;
  std::vector<std::int32_t> counts; // sample after sample, the channels of one side by side

  [[nodiscard]] std::size_t samples() const { return counts.size() / channels; }
};

class AcsInstrument {
public:
  explicit AcsInstrument(const AcsSettings& settings);

  // Appends the samples taken before `time_s`.
  void sample_until(double time_s, const Excitation& excitation, AcsSamples& samples);

  // Whether what it has sampled reaches anybody; numbers it as anyone who receives it will see it.
  [[nodiscard]] bool sends(AcsSamples& samples);

  [[nodiscard]] std::string description_line() const; // without the line end
  [[nodiscard]] const std::vector<AcsChannel>& channels() const { return channels_; }
  [[nodiscard]] const std::optional<Interferometer>& interferometer() const {
    return interferometer_;
  }
  [[nodiscard]] std::int64_t stamp_ns(std::uint64_t sample) const;
  [[nodiscard]] double reference_scale() const { return reference_scale_; } // m/s^2 per count
  [[nodiscard]] double sync_scale() const { return sync_scale_; }           // V per count
  [[nodiscard]] double rate_error() const { return rate_error_; }
  [[nodiscard]] double reference_gain_error() const { return gain_error_; }
  [[nodiscard]] double reference_phase_error_rad() const { return phase_error_rad_; }

private:
  AcsSettings settings_;
  Random noise_;
  Random loss_;
  ChannelDisturbance reference_disturbance_;
  ChannelDisturbance sync_disturbance_;
  std::optional<Interferometer> interferometer_;
  std::vector<AcsChannel> channels_;
  double rate_error_ = 0.0;
  double gain_error_ = 0.0;
  double phase_error_rad_ = 0.0;
  double hum_phase_rad_ = 0.0;
  double reference_scale_ = 0.0;
  double sync_scale_ = 0.0;
  [[nodiscard]] double interval_s() const; // of bench time
  void sample_reference_until(double time_s, const Excitation& excitation, AcsSamples& samples);
  [[nodiscard]] double sync_amplitude_v(const Motion& motion) const;
  [[nodiscard]] double pulse_v(double at_s) const;

  HarmonicGains reference_gains_;
  std::uint64_t next_sample_ = 0;
  std::uint64_t uncounted_ = 0; // samples that were lost and that its numbers do not show
};

} // namespace dyncal::drivers::virtual_bench
