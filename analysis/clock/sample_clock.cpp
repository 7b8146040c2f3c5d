#include "analysis/clock/sample_clock.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "analysis/base/statistics.hpp"
#include "analysis/clock/interval_counts.hpp"
#include "analysis/clock/period_count.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::uint64_t first_lesson = 64; // intervals after which it is known what is usual
constexpr double core_scales = 6.0;
constexpr double one_tick = 1.01;
constexpr double gap_part =
    1.5; // an interval longer than this many medians interrupts the Allan deviation

UsualInterval usual_of(const IntervalDistribution& distribution) {
  return {distribution.quantile(0.5),
          std::max(0.5, mad_to_sd * distribution.median_absolute_deviation())};
}

// Coarse ticks make an interval up to one longer or shorter: that is usual.
UsualInterval usual_of(const IntervalDistribution& distribution, const PeriodCount& periods) {
  return periods.coarse_tick_ns() > 0.0 && periods.periods() > 0
             ? UsualInterval{periods.mean_ns(), one_tick * periods.coarse_tick_ns() / core_scales}
             : usual_of(distribution);
}

double seconds(double ns) {
  return ns * 1e-9;
}

} // namespace

struct SampleClock::State {
  explicit State(const SampleClockSettings& chosen)
      : settings(chosen), counts(chosen.max_distinct_intervals), overview(chosen.max_buckets),
        close_up(chosen.close_up), temperature(chosen.max_temperature_bins, chosen.max_scatter),
        allan(chosen.max_allan_samples) {}

  void take_sample(std::uint64_t sample, std::int64_t stamp_ns, bool trusted,
                   double temperature_degc);
  void take_interval(const SampleInterval& interval, double temperature_degc);

  SampleClockSettings settings;
  IntervalCounts counts;
  PeriodCount periods;
  IntervalEventCollector events;
  IntervalOverview overview;
  IntervalCloseUp close_up;
  TemperatureRelation temperature;
  StreamingAllan allan;
  UsualInterval usual;

  std::optional<std::int64_t> first_stamp_ns;
  std::optional<std::uint64_t> next_sample;
  bool have_last = false; // the sample before has a stamp that an interval can begin with
  bool have_interval_before = false;
  std::int64_t last_stamp_ns = 0;
  double last_temperature_degc = 0.0;
  std::uint64_t lost = 0;
  std::uint64_t untrusted = 0;
};

void SampleClock::State::take_sample(std::uint64_t sample, std::int64_t stamp_ns, bool trusted,
                                     double temperature_degc) {
  if (!trusted) {
    ++untrusted;
    have_last = false;
    return;
  }
  if (!first_stamp_ns) {
    first_stamp_ns = stamp_ns;
  }
  if (have_last) {
    take_interval({counts.sums().count, sample - 1, last_stamp_ns, stamp_ns - last_stamp_ns,
                   have_interval_before},
                  last_temperature_degc);
  } else {
    have_interval_before = false;
    allan.interrupt();
  }
  periods.add(sample, stamp_ns);
  allan.add(stamp_ns);
  have_last = true;
  last_stamp_ns = stamp_ns;
  last_temperature_degc = temperature_degc;
}

void SampleClock::State::take_interval(const SampleInterval& interval, double temperature_degc) {
  counts.add(interval.length_ns);
  events.add(interval, usual);
  overview.add(interval);
  close_up.add(interval, usual);
  if (usual.known()) {
    if (usual.is_core(interval.length_ns, core_scales)) {
      temperature.add(temperature_degc, interval.length_ns);
    }
    if (interval.length_ns <= 0 ||
        static_cast<double>(interval.length_ns) > gap_part * usual.median_ns) {
      allan.interrupt();
    }
  }
  have_interval_before = true;
  const std::uint64_t n = counts.sums().count;
  if (n >= first_lesson && std::has_single_bit(n)) {
    usual = usual_of(counts.distribution(), periods);
  }
}

SampleClock::SampleClock(const SampleClockSettings& settings)
    : state_(std::make_unique<State>(settings)) {}
SampleClock::~SampleClock() = default;
SampleClock::SampleClock(SampleClock&&) noexcept = default;
SampleClock& SampleClock::operator=(SampleClock&&) noexcept = default;

void SampleClock::push(std::uint64_t first_sample, std::span<const std::int64_t> stamps_ns,
                       std::span<const std::uint8_t> flags,
                       std::span<const double> temperature_degc) {
  assert(flags.empty() || flags.size() == stamps_ns.size());
  assert(temperature_degc.empty() || temperature_degc.size() == stamps_ns.size());
  State& state = *state_;
  if (state.next_sample && first_sample != *state.next_sample) {
    if (first_sample > *state.next_sample) {
      state.lost += first_sample - *state.next_sample;
    } else {
      state.periods.restart();
    }
    state.have_last = false;
  }
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    state.take_sample(first_sample + i, stamps_ns[i], flags.empty() || flags[i] == 0,
                      temperature_degc.empty() ? std::nan("") : temperature_degc[i]);
  }
  state.next_sample = first_sample + stamps_ns.size();
}

namespace {

// REQUIRES: at least two intervals.
void describe_intervals(SampleClockStatistics& result, const IntervalSums& sums,
                        const IntervalDistribution& distribution) {
  result.intervals = sums.count;
  result.sd_s = seconds(sums.sd_ns());
  result.median_s = seconds(distribution.quantile(0.5));
  result.mad_sd_s = seconds(mad_to_sd * distribution.median_absolute_deviation());
  result.quantile_001_s = seconds(distribution.quantile(0.001));
  result.quantile_01_s = seconds(distribution.quantile(0.01));
  result.quantile_50_s = result.median_s;
  result.quantile_99_s = seconds(distribution.quantile(0.99));
  result.quantile_999_s = seconds(distribution.quantile(0.999));
}

IntervalSums sums_without(IntervalSums sums, const std::vector<std::int64_t>& lengths_ns) {
  for (const std::int64_t length : lengths_ns) {
    sums.remove(length);
  }
  return sums;
}

// Where samples are missing although the numbers do not show it, the time between two stamps is
// not an interval of the clock.
void leave_out_gaps(SampleClockStatistics& result, IntervalSums& sums,
                    IntervalDistribution& distribution,
                    const std::vector<std::int64_t>& gap_lengths_ns) {
  if (gap_lengths_ns.size() + 2 > sums.count) {
    return;
  }
  sums = sums_without(sums, gap_lengths_ns);
  distribution = distribution.without(gap_lengths_ns);
  result.minimum_s = seconds(static_cast<double>(distribution.entries().front().first));
  result.maximum_s = seconds(static_cast<double>(distribution.entries().back().first));
}

// Bit for bit the mean of the intervals where nothing is missing between them.
double mean_interval_s(const IntervalSums& sums, const PeriodCount& periods) {
  const bool across = periods.periods() > 0 && periods.periods() != sums.count;
  return seconds(across ? periods.mean_ns() : sums.mean_ns());
}

// REQUIRES: mean and core of `result` are there.
void add_uncertainty(SampleClockStatistics& result, const PeriodCount& periods, double u_stamp_s,
                     std::uint64_t core_intervals) {
  constexpr double share_of_neighbours = 2.0 / 3.0;
  const auto count = static_cast<double>(std::max(periods.periods(), result.intervals));
  const double made_s = seconds(periods.u_ends_ns());
  const double spread_s = result.maximum_s - result.minimum_s;
  const double scatter_s = made_s > 0.0             ? made_s
                           : result.core_sd_s > 0.0 ? result.core_sd_s
                           : spread_s > 0.0         ? spread_s
                                                    : std::numeric_limits<double>::quiet_NaN();
  const double ends_s = u_stamp_s > 0.0 ? std::max(std::sqrt(2.0) * u_stamp_s, made_s) : scatter_s;
  const auto stretches = static_cast<double>(std::max<std::uint64_t>(1, periods.stretches()));
  result.u_mean_interval_s = ends_s * std::sqrt(stretches) / count;
  if (!(u_stamp_s > 0.0) && !(made_s > 0.0) && result.core_sd_s > 0.0) {
    const double freedom = share_of_neighbours * (static_cast<double>(core_intervals) - 1.0);
    result.degrees_of_freedom_mean_interval = freedom;
    result.k_mean_interval = coverage_factor(freedom);
  }
}

// The number of intervals without events.
std::uint64_t describe_events(SampleClockStatistics& result, IntervalVerdict verdict,
                              IntervalSums core) {
  core = sums_without(core, verdict.unusual_lengths_ns);
  if (core.count > 1) {
    result.core_mean_s = seconds(core.mean_ns());
    result.core_sd_s = seconds(core.sd_ns());
  }
  result.events = std::move(verdict.events);
  result.event_count = verdict.event_count;
  result.pair_count = verdict.pair_count;
  result.pair_period_samples = verdict.pair_period_samples;
  result.pair_period_s = verdict.pair_period_s;
  result.pair_regularity = verdict.pair_regularity;
  return core.count;
}

} // namespace

std::optional<SampleClockStatistics> SampleClock::statistics() const {
  const State& state = *state_;
  const IntervalSums& all = state.counts.sums();
  if (all.count < 2) {
    return std::nullopt;
  }
  SampleClockStatistics result;
  IntervalDistribution distribution = state.counts.distribution();
  PeriodCount periods = state.periods;
  periods.finish();
  IntervalVerdict verdict = state.events.judge(usual_of(distribution, periods),
                                               *state.first_stamp_ns, state.settings.max_events);
  result.minimum_s = seconds(static_cast<double>(state.counts.minimum_ns()));
  result.maximum_s = seconds(static_cast<double>(state.counts.maximum_ns()));
  IntervalSums sums = all;
  if (periods.unnumbered() > 0) {
    leave_out_gaps(result, sums, distribution, verdict.gap_lengths_ns);
  }
  describe_intervals(result, sums, distribution);
  result.mean_interval_s = mean_interval_s(all, periods);
  result.nominal_rate_hz = state.settings.nominal_rate_hz;
  result.mean_rate_hz = result.mean_interval_s > 0.0 ? 1.0 / result.mean_interval_s : 0.0;
  result.tick_s = state.settings.tick_s;

  const double tick_ns = state.settings.tick_s * 1e9;
  const IntervalHistogram histogram =
      interval_histogram(distribution, tick_ns, result.mad_sd_s * 1e9);
  result.lattice_statistic = lattice_statistic(distribution, tick_ns);
  if (tick_ns > 0.0) {
    for (const double mode : interval_modes_ns(histogram)) {
      result.modes_s.push_back(seconds(mode));
    }
  }
  result.histogram = histogram.bins;
  const std::uint64_t core_intervals = describe_events(result, std::move(verdict), all);
  result.left_out_jumps = periods.left_out_jumps();
  result.largest_jump_s = result.left_out_jumps > 0 ? seconds(periods.largest_jump_ns()) : 0.0;
  add_uncertainty(result, periods, state.settings.stamp_uncertainty_s, core_intervals);

  result.over_time = state.overview.buckets(*state.first_stamp_ns);
  result.close_up_ns = state.close_up.lengths_ns();
  if (!result.close_up_ns.empty()) {
    result.close_up_first_time_s =
        seconds(static_cast<double>(state.close_up.first_begin_ns() - *state.first_stamp_ns));
  }
  result.over_temperature = state.temperature.bins();
  result.scatter_temperature_degc = state.temperature.pair_temperatures_degc();
  result.scatter_interval_ns = state.temperature.pair_intervals_ns();
  result.temperature_correlation = state.temperature.correlation();
  result.temperature_slope_s_per_degc = seconds(state.temperature.slope_ns_per_degc());
  if (result.mean_interval_s > 0.0) {
    result.allan = state.allan.points(result.mean_interval_s);
  }
  result.lost = state.lost + periods.unnumbered();
  result.untrusted = state.untrusted;
  return result;
}

CombinedUncertainty SampleClockStatistics::of_mean_rate() const {
  CombinedUncertainty result = of_mean_interval();
  result.u *= mean_rate_hz / mean_interval_s;
  return result;
}

double SampleClockStatistics::rate_deviation_rel() const {
  return nominal_rate_hz > 0.0 ? mean_rate_hz / nominal_rate_hz - 1.0
                               : std::numeric_limits<double>::quiet_NaN();
}

CombinedUncertainty SampleClockStatistics::of_rate_deviation() const {
  CombinedUncertainty result = of_mean_rate();
  result.u =
      nominal_rate_hz > 0.0 ? result.u / nominal_rate_hz : std::numeric_limits<double>::quiet_NaN();
  return result;
}

} // namespace dyncal::analysis
