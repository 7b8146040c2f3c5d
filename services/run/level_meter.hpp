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
// A window with samples at an end of the range that the channel's description states shows less
// than there is: it is refused (device).
//
// While the object exists its blocks must be taken: call take() at least every second. One thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "analysis/base/frequency.hpp"
#include "services/bench/bench_file.hpp"
#include "services/bus/bus.hpp"
#include "services/evaluation/record/source_record.hpp"

namespace dyncal::services {

class LevelMeter {
public:
  // Of the channel that is the bench's reference. Fails as readers do.
  [[nodiscard]] static Expected<LevelMeter> create(bus::Participant& participant,
                                                   const BenchFile& bench,
                                                   const std::shared_ptr<bus::WakeUp>& wake_up);

  // Takes what has come; `bench_time_s` is the bench's time now.
  void take(double bench_time_s);

  // Nothing while there is no full window of samples from after `bench_time_s`, or while its halves
  // differ by more than `agreement_rel`.
  [[nodiscard]] Expected<std::optional<double>> level_after(double bench_time_s,
                                                            const analysis::Frequency& frequency,
                                                            double agreement_rel) const;

private:
  LevelMeter(ChannelName reference, bus::Reader<wire::SourceDescription> descriptions,
             bus::Reader<wire::SampleBlock> samples);

  [[nodiscard]] double part_at_range(std::size_t channel, const TimeInterval& window) const;

  ChannelName reference_;
  bus::Reader<wire::SourceDescription> descriptions_;
  bus::Reader<wire::SampleBlock> samples_;
  SourceRecord record_;
  std::uint32_t restarts_ = 0;
  std::optional<std::int64_t> acs_minus_bench_ns_;
  double taken_s_ = 0.0;
};

} // namespace dyncal::services
