// The frequency of a stream, found and refined on the series of its blocks.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/sine/sine_stream_state.hpp"

namespace dyncal::analysis {
namespace {

constexpr double max_series_error = 1e-10;

} // namespace

using namespace kernel;

double SineStream::State::misfit(std::span<const Segment> segments, double delta,
                                 ShiftedSums& sums) const {
  shift_sums(segments, start_, delta, sums);
  const NormalMatrix matrix(sums.n, sums.design);
  if (!matrix.well_conditioned()) {
    return std::numeric_limits<double>::infinity();
  }
  double total = 0.0;
  for (std::size_t j = 0; j < start_.size(); ++j) {
    const Solution solution = solve(matrix, sums.residuals[j], start_[j]);
    total += std::log(solution.rss + 1e-30 * solution.ee + std::numeric_limits<double>::min());
  }
  return total;
}

// Few bins or cycles: the misfit itself on a grid. Many: the phasors of the blocks on a grid,
// turned step by step; their image at -f and the constant average out over the cycles.
double SineStream::State::search(std::span<const Segment> segments, double half_range) const {
  const double bin = 2.0 * std::numbers::pi / span_s();
  constexpr double basin_bins = 0.3;
  constexpr double min_bins = 4.0;
  constexpr double min_cycles = 8.0;
  if (half_range <= basin_bins * bin) {
    return 0.0;
  }
  const bool few =
      half_range < min_bins * bin || frequency_.angular() - half_range < min_cycles * bin;
  const double step_bins = few ? 0.4 : 0.25;
  const int half = static_cast<int>(std::ceil(half_range / (step_bins * bin)));
  const double step = half_range / half;
  std::vector<double> merit(2 * static_cast<std::size_t>(half) + 1, 0.0);
  if (few) {
    ShiftedSums sums;
    for (int i = -half; i <= half; ++i) {
      merit[static_cast<std::size_t>(i + half)] = -misfit(segments, step * i, sums);
    }
  } else {
    add_spectra(segments, step, half, merit);
  }
  return step *
         static_cast<double>(std::max_element(merit.begin(), merit.end()) - merit.begin() - half);
}

void SineStream::State::add_spectra(std::span<const Segment> segments, double step, int half,
                                    std::vector<double>& merit) const {
  // With the start parameters put back: the phasors of the values, less the constant.
  std::vector<Complex> turned(segments.size()), turn(segments.size());
  for (std::size_t j = 0; j < start_.size(); ++j) {
    const Complex p{start_[j].sine, start_[j].cosine};
    double square = totals_.channels[j].ee;
    for (std::size_t k = 0; k < segments.size(); ++k) {
      const double centre = segments[k].design->centre;
      const double n = segments[k].design->u[0];
      turn[k] = std::polar(1.0, -step * centre);
      turned[k] = times(segments[k].channels[j].ex[0] + times({0.0, -0.5 * n}, p),
                        std::polar(1.0, step * half * centre));
      square += 0.5 * n * std::norm(p);
    }
    for (double& value : merit) {
      Complex sum = 0.0;
      for (std::size_t k = 0; k < segments.size(); ++k) {
        sum += turned[k];
        turned[k] = times(turned[k], turn[k]);
      }
      const double explained =
          2.0 * std::norm(sum) /
          (static_cast<double>(samples()) * (square + std::numeric_limits<double>::min()));
      value -= std::log1p(-std::min(explained, 1.0 - 1e-12));
    }
  }
}

// Segments of all closed blocks and, reduced into `last`, of the one that is still open.
std::vector<Segment> SineStream::State::segments_with(Block& last) {
  while (reduction_.pending()) {
    reduce_piece();
  }
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < closed_; ++i) {
    segments.push_back(blocks_[i].segment());
  }
  if (samples_.filled > 0) {
    last.channels.resize(start_.size());
    BlockReduction reduction;
    for (reduction.begin(start_.size()); reduction.pending();) {
      reduction.take_piece(samples_, frequency_, first_ns_, start_, last);
    }
    segments.push_back(last.segment());
  }
  return segments;
}

double SineStream::State::max_half_length_s(const Block& last) const {
  double half_length_s = samples_.filled > 0 ? last.half_length_s : 0.0;
  for (std::size_t i = 0; i < closed_; ++i) {
    half_length_s = std::max(half_length_s, blocks_[i].half_length_s);
  }
  return half_length_s;
}

Expected<FrequencyFit> SineStream::State::fit_with_frequency(double search_rel,
                                                             std::int64_t phase_origin_ns) {
  if (const auto checked = ready(4); !checked) {
    return fail(checked.error());
  }
  if (!(search_rel >= 0.0 && search_rel < 1.0)) {
    return fail(
        ErrorCode::invalid_argument,
        "the search range of the frequency must be at least 0 and below 1, relative to the start");
  }
  const auto shift_ns = shift_to(phase_origin_ns);
  if (!shift_ns) {
    return fail(shift_ns.error());
  }
  Block last;
  const std::vector<Segment> segments = segments_with(last);
  const double bin = 2.0 * std::numbers::pi / span_s();
  const double half_range = search_rel * frequency_.angular();
  const FrequencySolution solution = solve_frequency(segments, start_, search(segments, half_range),
                                                     half_range + 2.0 * bin, 1e-12 / span_s());
  if (!solution.matrix.well_conditioned() || !std::isfinite(solution.u_delta)) {
    return fail(ErrorCode::ill_conditioned, "frequency, sine, cosine and constant cannot be told "
                                            "apart in this record; record more periods");
  }
  const double moved = std::abs(solution.delta) * max_half_length_s(last);
  FrequencyFit result{frequency_.shifted_by_hz(solution.delta / (2.0 * std::numbers::pi)),
                      solution.u_delta / (2.0 * std::numbers::pi),
                      {},
                      1};
  if (!solution.settled || std::pow(2.0 * moved, 7) / 5040.0 > max_series_error) {
    return fail(ErrorCode::not_converged,
                "the frequency moved to " + std::to_string(result.frequency.hz()) +
                    " Hz, too far from where the stream was reduced; start it at that frequency");
  }
  if (!is_any_significant(solution, result.frequency, 1.0 + 2.0 * half_range / bin)) {
    return fail(
        ErrorCode::no_excitation,
        "no sine near " + std::to_string(frequency_.hz()) +
            " Hz stands out of the noise in any channel; check frequency, search range and window");
  }
  const double turns = result.frequency.reduced_turns(*shift_ns);
  for (std::size_t j = 0; j < start_.size(); ++j) {
    result.channels.push_back(
        channel_fit(solution, j, static_cast<double>(*shift_ns) * 1e-9, turns));
  }
  return result;
}

// About the middle of the record, where the covariance is that of amplitude and phase alone.
bool SineStream::State::is_any_significant(const FrequencySolution& solution,
                                           const Frequency& frequency, double tries) const {
  const double half_span_s = 0.5 * span_s();
  const double to_middle = frequency.reduced_turns((last_ns_ - first_ns_) / 2);
  for (std::size_t j = 0; j < start_.size(); ++j) {
    if (is_significant(channel_fit(solution, j, half_span_s, to_middle), tries)) {
      return true;
    }
  }
  return false;
}

} // namespace dyncal::analysis
