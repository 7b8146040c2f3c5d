// The level of the excitation as the reference shows it, while a run goes on: from the ACS's sample
// blocks on DDS.
//
// It is the amplitude of the sine of the step's frequency (three-parameter approximation,
// analysis/sine/sine_fit.hpp) in the newest window of samples that were taken after a given bench
// time.
//
// The ACS's clock and bench time are unrelated. Their difference D is estimated from arrival: a
// block whose newest stamp is a and that is there at bench time b has travelled for D - (a - b), so
//
//   D_estimated = max (a - b) = D - (shortest travel time of any block)
//
// which is too small by at most level_transport_s. Against longer travel, and a level that still
// moves, the two halves of the window must show the same level within the agreement asked for.
//
// What a window has to show: level_reading.hpp. The quiet level, from before the output is on, is
// hum: added to the motion, or taken from it, it would let the loop drive too much.
//
// While the object exists its blocks must be taken: call take() at least every second. One thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "services/bus/bus.hpp"
#include "services/contract/channel_name.hpp"
#include "services/evaluation/record/source_record.hpp"
#include "services/run/level_reading.hpp"

namespace dyncal::inline run {

class LevelMeter {
public:
  // `reference`: a channel of an ACS. Fails as readers do.
  [[nodiscard]] static Expected<LevelMeter> create(bus::Participant& participant,
                                                   const std::string& bench, ChannelName reference,
                                                   const std::shared_ptr<bus::WakeUp>& wake_up);

  static constexpr double usually_kept_s = 20.0;
  // Takes what has come; `bench_time_s` is the bench's time now. Keeps the newest samples, `kept_s`
  // long: at least the windows that are asked for.
  void take(double bench_time_s, double kept_s = usually_kept_s);

  // No level while there is no full window of samples from after `bench_time_s`.
  [[nodiscard]] Expected<LevelReading> level_after(double bench_time_s,
                                                   const analysis::Frequency& frequency,
                                                   double agreement_rel) const;
  // The lines of a multi-sine, by their frequencies, out of the newest `period_s`, all of it from
  // after `bench_time_s`: whole turns of each, so that none shows in another. Nothing while samples
  // of it are lacking. Fails as check_range() does (level_reading.hpp).
  [[nodiscard]] Expected<std::optional<std::map<std::string, double>>>
  line_levels_after(double bench_time_s, const std::vector<std::string>& frequencies_hz,
                    double period_s) const;
  // The sines that samples from after `bench_time_s` show, the output being off; none of
  // frequencies below 4 Hz: mains do not hum there. Nothing while a window lacks samples.
  [[nodiscard]] std::optional<std::map<std::string, double>>
  quiet_levels_after(double bench_time_s, const std::vector<std::string>& frequencies_hz) const;

private:
  LevelMeter(ChannelName reference, bus::Reader<wire::SourceDescription> descriptions,
             bus::Reader<wire::SampleBlock> samples);

  // The newest, where it is whole and begins after `bench_time_s`.
  [[nodiscard]] std::optional<TimeInterval> window_after(double bench_time_s,
                                                         double window_s) const;

  ChannelName reference_;
  bus::Reader<wire::SourceDescription> descriptions_;
  bus::Reader<wire::SampleBlock> samples_;
  SourceRecord record_;
  std::uint32_t restarts_ = 0;
  std::optional<std::int64_t> acs_minus_bench_ns_;
  double taken_s_ = 0.0;
};

// How long quiet_levels_after() needs samples for, in bench time.
[[nodiscard]] double listening_s(const std::vector<std::string>& frequencies_hz);

} // namespace dyncal::inline run
