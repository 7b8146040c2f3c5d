// The sample clock of a sensor from the stamps of its samples: direct sample interval evaluation,
// paper sections 3 and 4.2.
//
// Interval i is t_{i+1} - t_i of two samples with consecutive numbers and trusted stamps between
// which the stamps show nothing missing, an integer in ns; standard deviation (n - 1), median, MAD
// and quantiles (linear between order statistics) are those of the integers, exactly. The mean goes
// across what is missing: it is the span of the stamps over the sample periods in it, without jumps
// of the clock (period_count.hpp). What is usual is known after 64 intervals, and learned again at
// 128, 256 ...
//
//   histogram, lattice statistic, modes     interval_histogram.hpp
//   events, their number, period of pairs   interval_events.hpp; core_mean, core_sd leave them out
//   temperature                             temperature_relation.hpp: that of the sample which
//                                           begins an interval, of intervals within 6 s of usual
//   Allan deviation                         allan_deviation.hpp, within stretches without a loss
//
// Memory is bounded (settings); what does not depend on a bound is exact however the stream was
// divided into blocks. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/clock/allan_deviation.hpp"
#include "analysis/clock/interval_events.hpp"
#include "analysis/clock/interval_histogram.hpp"
#include "analysis/clock/interval_overview.hpp"
#include "analysis/clock/temperature_relation.hpp"
#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::analysis {

struct SampleClockSettings {
  double nominal_rate_hz = 0.0;     // 0: not known
  double tick_s = 0.0;              // of the stamping counter, 0: not known
  double stamp_uncertainty_s = 0.0; // standard uncertainty of one stamp against the time base
  std::size_t max_buckets = 1000;   // of the overview over time
  std::size_t max_events = 1000;    // listed; all are counted
  std::size_t max_scatter = 4000;   // temperature-interval pairs kept
  std::size_t max_temperature_bins = 100;
  std::size_t close_up = 40; // intervals on each side of the first pair
  std::size_t max_allan_samples = 1u << 18;
  std::size_t max_distinct_intervals = 1u << 20;
};

struct SampleClockStatistics {
  std::uint64_t intervals = 0;
  double mean_interval_s = 0.0;
  // In the clock of the stamps, of n periods: sqrt(2) u(stamp) / n; where that is not stated, what
  // ticks and read-outs make of it (PeriodCount::u_ends_ns), else the scatter of the intervals
  // without events over n, which is at least as much when stamps scatter by chance, else their
  // spread. NaN when intervals do not scatter: nothing is known. Of scatter, neighbours have a
  // stamp in common: n intervals have 2/3 (n - 1) degrees of freedom.
  double u_mean_interval_s = 0.0;
  double degrees_of_freedom_mean_interval = infinite_degrees_of_freedom;
  double k_mean_interval = 2.0; // at 95.45 %
  // Jumps of the clock, or pauses too long to count, that the mean leaves out; the largest of them.
  std::uint64_t left_out_jumps = 0;
  double largest_jump_s = 0.0;
  double sd_s = 0.0;
  double minimum_s = 0.0;
  double maximum_s = 0.0;
  double median_s = 0.0;
  double mad_sd_s = 0.0;       // 1.4826 MAD
  double quantile_001_s = 0.0; // 0.1 %
  double quantile_01_s = 0.0;  // 1 %
  double quantile_50_s = 0.0;
  double quantile_99_s = 0.0;
  double quantile_999_s = 0.0;
  double core_mean_s = 0.0; // without events
  double core_sd_s = 0.0;
  double nominal_rate_hz = 0.0;
  double mean_rate_hz = 0.0;
  double tick_s = 0.0;
  double lattice_statistic = 0.0;
  std::vector<double> modes_s;
  std::vector<IntervalHistogramBin> histogram; // bins that are not empty, rising
  std::vector<IntervalBucket> over_time;
  double close_up_first_time_s = 0.0;
  std::vector<double> close_up_ns;
  std::vector<IntervalEvent> events;
  std::uint64_t event_count = 0;
  std::uint64_t pair_count = 0;
  double pair_period_samples =
      0.0; // median distance, 0 with fewer than five pairs or without regularity
  double pair_period_s = 0.0;
  double pair_regularity = 0.0; // 1 regular, towards 0 by chance
  std::vector<TemperatureBin> over_temperature;
  std::vector<double> scatter_temperature_degc;
  std::vector<double> scatter_interval_ns;
  double temperature_correlation = 0.0;
  double temperature_slope_s_per_degc = 0.0;
  std::vector<AllanPoint> allan;
  std::uint64_t lost = 0;      // samples missing from the numbering, or by the stamps alone
  std::uint64_t untrusted = 0; // samples whose stamp was flagged

  [[nodiscard]] CombinedUncertainty of_mean_interval() const {
    return {u_mean_interval_s, degrees_of_freedom_mean_interval, k_mean_interval};
  }
  // Of the mean rate, which is as uncertain as the mean interval.
  [[nodiscard]] CombinedUncertainty of_mean_rate() const;
  // Mean rate over nominal rate, less 1; NaN where no rate is nominal.
  [[nodiscard]] double rate_deviation_rel() const;
  [[nodiscard]] CombinedUncertainty of_rate_deviation() const;
};

class SampleClock {
public:
  explicit SampleClock(const SampleClockSettings& settings = {});
  ~SampleClock();
  SampleClock(SampleClock&&) noexcept;
  SampleClock& operator=(SampleClock&&) noexcept;

  // The next samples. `first_sample` is the number of the first of them; a number that does not
  // follow on the last one starts a new stretch (missing ones are counted as lost; a smaller one is
  // a restart of the numbering). `flags` (a value that is not 0: stamp not trusted) and
  // `temperature_degc` are either empty or as long as `stamps_ns`.
  void push(std::uint64_t first_sample, std::span<const std::int64_t> stamps_ns,
            std::span<const std::uint8_t> flags = {},
            std::span<const double> temperature_degc = {});

  // Empty with fewer than two intervals.
  [[nodiscard]] std::optional<SampleClockStatistics> statistics() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace dyncal::analysis
