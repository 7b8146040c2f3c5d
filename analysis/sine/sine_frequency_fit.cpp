// Four parameters: search, then passes over the samples, each followed by the solution of the whole
// nonlinear problem in the frequency on the series of that pass (frequency_series.hpp). Long
// records take their first passes on an eighth of the samples; one pass over all of them is then
// enough as a rule.
#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/sine/frequency_search.hpp"
#include "analysis/sine/frequency_series.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "analysis/sine/sine_pass.hpp"
#include "analysis/sine/sine_solve.hpp"

namespace dyncal::analysis {
namespace {

using namespace kernel;

constexpr int max_passes = 40;
constexpr std::size_t long_record = 16 * block_samples; // its first passes look at a part of it
constexpr double series_limit = 0.5; // rad over half the record that one series may be moved
constexpr double allowed_error_rad =
    1e-11; // of the phase at the ends of the record; the stop rule |dw| T < 1e-9 demands less

struct Estimate {
  Frequency frequency; // expansion frequency of the pass
  std::vector<Parameters> start;
  FrequencySolution solution;
  int passes = 0;
};

double radians_to_hz(const Record& record, double delta) {
  return delta / (3.141592653589793 * record.span_s());
}

// A channel that noise explains has nearly no say in the frequency. Judged by the solution, not by
// the start: there, residuals may be larger than the amplitude though the sine is clear.
bool shows_no_sine(const Solution& channel, double n) {
  constexpr double significant = 4.0; // standard uncertainties, sqrt(2 rss) / n
  const double size = std::hypot(channel.p.sine, channel.p.cosine);
  return size * n < significant * std::sqrt(2.0 * channel.rss);
}

// What the series left out, in radians: orders of the residual moments from u^2 on, of the design
// from u^3 on, and its end. Residuals count against the amplitude: noise averages out, what the
// start parameters miss does not.
double series_error(const FrequencySeriesSums& sums, const FrequencySolution& solution) {
  const double n = solution.matrix.n;
  double residual = 0.0;
  for (const Solution& channel : solution.channels) {
    const double size = std::hypot(channel.p.sine, channel.p.cosine);
    if (!(size > 0.0) || shows_no_sine(channel, n)) {
      continue;
    }
    const double left =
        std::sqrt(channel.rss) / n + std::sqrt(std::max(0.0, channel.ee - channel.rss) / n);
    residual = std::max(residual, left / size);
  }
  const double delta = std::abs(solution.delta);
  const double length = sums.block_half_length;
  return 3.0 * residual * delta * length * length + std::pow(delta * length, 3) +
         std::pow(delta, 6) / 120.0;
}

Expected<void> pass(const Record& record, Selection selection, Estimate& estimate, double& error) {
  DYNCAL_TRY(const auto sums,
             accumulate_frequency_series(record, estimate.frequency, estimate.start, selection));
  if (!all_finite(sums)) {
    return fail(record.not_finite());
  }
  const Segment segment = sums.segment();
  estimate.solution = solve_frequency({&segment, 1}, estimate.start, 0.0, series_limit);
  ++estimate.passes;
  const FrequencySolution& solution = estimate.solution;
  if (!solution.matrix.well_conditioned() || !std::isfinite(solution.u_delta)) {
    return fail(ErrorCode::ill_conditioned,
                "frequency, sine, cosine and constant near " +
                    std::to_string(estimate.frequency.hz()) +
                    " Hz cannot be told apart in this record; record more periods");
  }
  error = solution.settled ? series_error(sums, solution) : series_limit;
  return {};
}

void move_on(const Record& record, Estimate& estimate) {
  estimate.frequency =
      estimate.frequency.shifted_by_hz(radians_to_hz(record, estimate.solution.delta));
  for (std::size_t j = 0; j < estimate.start.size(); ++j) {
    estimate.start[j] = estimate.solution.channels[j].p;
  }
}

// Passes over the selection until the error is allowed.
Expected<void> iterate(const Record& record, Selection selection, double allowed,
                       Estimate& estimate) {
  while (estimate.passes < max_passes) {
    double error = 0.0;
    DYNCAL_TRY(pass(record, selection, estimate, error));
    if (error < allowed) {
      return {};
    }
    move_on(record, estimate);
    if (!(estimate.frequency.hz() > 0.0)) {
      break;
    }
  }
  return fail(ErrorCode::not_converged, "the frequency near " +
                                            std::to_string(estimate.frequency.hz()) +
                                            " Hz did not settle; check that one sine dominates");
}

Expected<void> check_arguments(const Record& record, const Frequency& start, double search_rel) {
  if (!(search_rel >= 0.0 && search_rel < 1.0)) {
    return fail(
        ErrorCode::invalid_argument,
        "the search range of the frequency must be at least 0 and below 1, relative to the start");
  }
  return record.check_nyquist(start);
}

Expected<Estimate> estimate_of(const Record& record, const Frequency& start, double search_rel) {
  DYNCAL_TRY(auto found, search_frequency(record, start, search_rel));
  Estimate estimate{found, {}, {}, 0};
  for (const auto& channel : record.channels()) {
    estimate.start.push_back({0.0, 0.0, channel.front()});
  }
  if (record.size() >= long_record) {
    constexpr double close_rad = 0.02;
    const std::size_t length =
        std::clamp<std::size_t>(record.size() / 512, 64, grid_samples) / lanes * lanes;
    const Selection part{length, (record.size() < 8 * long_record ? 8 : 16) * length};
    // A part that does not settle decides nothing; the whole record is tried all the same.
    const auto done = iterate(record, part, close_rad, estimate);
    if (!done && done.error().code != ErrorCode::not_converged) {
      return fail(done.error());
    }
    if (!done) {
      estimate.frequency = found;
    }
    if (done) {
      move_on(record, estimate);
    }
    estimate.passes = 0;
  }
  // Short blocks in short records: the series is exact up to the square of their length.
  const std::size_t wanted = std::clamp<std::size_t>(record.size() / 64, 64, grid_call_samples);
  const std::size_t length = wanted / (wanted < grid_samples ? lanes : grid_samples) *
                             (wanted < grid_samples ? lanes : grid_samples);
  DYNCAL_TRY(iterate(record, {length, length}, allowed_error_rad, estimate));
  return estimate;
}

} // namespace

Expected<FrequencyFit> fit_sine_and_frequency(const Frequency& start, double search_rel,
                                              std::int64_t phase_origin_ns,
                                              std::span<const std::int64_t> stamps_ns,
                                              std::span<const std::span<const double>> channels) {
  DYNCAL_TRY(const auto record, Record::make(stamps_ns, channels, 4));
  DYNCAL_TRY(check_arguments(record, start, search_rel));
  std::int64_t shift_ns = 0;
  if (__builtin_sub_overflow(phase_origin_ns, record.origin_ns(), &shift_ns)) {
    return fail(ErrorCode::invalid_argument,
                "the phase origin is more than 292 years away from the record");
  }
  DYNCAL_TRY(const auto estimate, estimate_of(record, start, search_rel));

  FrequencyFit result{
      estimate.frequency.shifted_by_hz(radians_to_hz(record, estimate.solution.delta)),
      0.0,
      {},
      estimate.passes};
  result.u_frequency_hz = radians_to_hz(record, estimate.solution.u_delta);
  const double turns = result.frequency.reduced_turns(shift_ns);
  const double reference_shift = static_cast<double>(shift_ns) / record.half_span_ns();
  // In the middle of the record, where the covariance is that of amplitude and phase alone.
  const double bins = 1.0 + 2.0 * search_rel * start.hz() * record.span_s();
  bool excited = false;
  for (std::size_t j = 0; j < channels.size(); ++j) {
    excited |= is_significant(channel_fit(estimate.solution, j, 0.0, 0.0), bins);
    result.channels.push_back(channel_fit(estimate.solution, j, reference_shift, turns));
  }
  if (!excited) {
    return fail(
        ErrorCode::no_excitation,
        "no sine near " + std::to_string(start.hz()) +
            " Hz stands out of the noise in any channel; check frequency, search range and window");
  }
  if (std::abs(result.frequency.hz() - start.hz()) >
      search_rel * start.hz() + 2.0 / record.span_s()) {
    return fail(ErrorCode::not_converged,
                "the frequency moved to " + std::to_string(result.frequency.hz()) +
                    " Hz, outside of the search range; check the start frequency");
  }
  DYNCAL_TRY(record.check_nyquist(result.frequency));
  return result;
}

} // namespace dyncal::analysis
