#include "analysis/sine/sine_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "analysis/sine/sine_pass.hpp"
#include "analysis/sine/sine_solve.hpp"

namespace dyncal::analysis {
namespace {

using namespace kernel;

// The start values come from groups of eight samples spread over the record; a short record is its
// own start.
constexpr std::size_t pilot_groups = 16;
constexpr std::size_t pilot_samples = pilot_groups * lanes;

// Without start values for sine and cosine a pass is quicker, but the residual sum of squares is
// the difference of numbers this many times as large: 10 digits of it are kept.
constexpr double max_cancellation = 1e6;

struct Start {
  std::vector<Parameters> parameters;
  bool plain = false; // offsets only
};

// Calls see(first, n) for every group.
template <class See>
void for_each_pilot_group(std::size_t samples, See see) {
  for (std::size_t group = 0; group < pilot_groups; ++group) {
    see(group * (samples / pilot_groups), group * lanes);
  }
}

Expected<PassSums> pilot_sums(const Record& record, const Frequency& frequency,
                              std::span<const Parameters> start) {
  if (record.size() < 2 * pilot_samples) {
    return accumulate(record, frequency, start);
  }
  std::array<std::int64_t, pilot_samples> stamps;
  std::vector<double> values(pilot_samples * start.size());
  for_each_pilot_group(record.size(), [&](std::size_t from, std::size_t to) {
    std::copy_n(record.stamps().data() + from, lanes, stamps.data() + to);
    for (std::size_t j = 0; j < start.size(); ++j) {
      std::copy_n(record.channels()[j].data() + from, lanes,
                  values.data() + j * pilot_samples + to);
    }
  });
  return accumulate(record, frequency, start, stamps, values);
}

// Parameters that leave residuals of the size of the noise, or the plain level when the groups do
// not tell more or `plain_allowed` and the noise is large enough for it.
Expected<Start> pilot(const Record& record, const Frequency& frequency, bool plain_allowed) {
  Start start;
  for (const auto& channel : record.channels()) {
    start.parameters.push_back({0.0, 0.0, channel.front()});
  }
  DYNCAL_TRY(const auto sums, pilot_sums(record, frequency, start.parameters));
  if (!all_finite(sums)) {
    return fail(record.not_finite());
  }
  const NormalMatrix matrix(sums.samples, sums.design);
  start.plain = plain_allowed && matrix.smallest > 0.1;
  for (std::size_t j = 0; j < start.parameters.size(); ++j) {
    Parameters& p = start.parameters[j];
    if (matrix.smallest > 1e-2) {
      const Solution solution = solve(matrix, sums.channels[j], p);
      p = solution.p;
      start.plain &= 0.5 * (p.sine * p.sine + p.cosine * p.cosine) * sums.samples <
                     max_cancellation * solution.rss;
    } else {
      p.offset += sums.channels[j].e / sums.samples;
    }
  }
  if (start.plain) {
    for (Parameters& p : start.parameters) {
      p.sine = p.cosine = 0.0;
    }
  }
  return start;
}

// Another pass about the result is worth its time when the start was far off, so that the last
// digits of the sums matter.
bool too_far(const NormalMatrix& matrix, const Solution& solution, double cancellation) {
  constexpr double rounding = 1e-15;
  const double step = std::hypot(solution.step.sine, solution.step.cosine);
  const double size = std::hypot(solution.p.sine, solution.p.cosine);
  return solution.ee > cancellation * solution.rss + rounding * rounding * size * size * matrix.n ||
         step * 1e-2 > matrix.smallest * size;
}

SineFit fit_from(const Record& record, const NormalMatrix& matrix, const Solution& solution) {
  SineFit fit;
  fit.sine = solution.p.sine;
  fit.cosine = solution.p.cosine;
  fit.offset = solution.p.offset;
  fit.rss = solution.rss;
  fit.samples = record.size();
  fit.degrees_of_freedom = static_cast<double>(record.size()) - 3.0;
  fit.covariance = unit_covariance(matrix);
  for (double& element : fit.covariance) {
    element *= solution.rss / fit.degrees_of_freedom;
  }
  return fit;
}

Error ill_conditioned(const Record& record, const Frequency& frequency) {
  return {ErrorCode::ill_conditioned,
          "sine, cosine and constant of " + std::to_string(frequency.hz()) +
              " Hz cannot be told apart in this record of " + std::to_string(record.span_s()) +
              " s; record more of a period, or at instants that differ in phase"};
}

} // namespace

double SineFit::amplitude() const {
  return std::hypot(sine, cosine);
}

double SineFit::phase_rad() const {
  return std::atan2(cosine, sine);
}

double SineFit::u_amplitude() const {
  const double size = amplitude();
  if (size == 0.0) {
    return std::sqrt(std::max(covariance[0], covariance[3]));
  }
  const double a = sine / size;
  const double b = cosine / size;
  return std::sqrt(
      std::max(0.0, a * a * covariance[0] + 2.0 * a * b * covariance[1] + b * b * covariance[3]));
}

double SineFit::u_phase_rad() const {
  const double size = amplitude();
  if (size == 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  const double a = sine / size;
  const double b = cosine / size;
  return std::sqrt(std::max(0.0, b * b * covariance[0] - 2.0 * a * b * covariance[1] +
                                     a * a * covariance[3])) /
         size;
}

double SineFit::residual_sd() const {
  return degrees_of_freedom > 0.0 ? std::sqrt(rss / degrees_of_freedom) : 0.0;
}

Expected<std::vector<SineFit>> fit_sine(const Frequency& frequency, std::int64_t phase_origin_ns,
                                        std::span<const std::int64_t> stamps_ns,
                                        std::span<const std::span<const double>> channels) {
  DYNCAL_TRY(const auto record, Record::make(stamps_ns, channels, 3));
  DYNCAL_TRY(record.check_nyquist(frequency));
  std::int64_t shift_ns = 0;
  if (__builtin_sub_overflow(phase_origin_ns, record.origin_ns(), &shift_ns)) {
    return fail(ErrorCode::invalid_argument,
                "the phase origin is more than 292 years away from the record");
  }
  record.fetch_beginning();
  const auto grid = sample_grid(record.stamps(), frequency);
  DYNCAL_TRY(auto start, pilot(record, frequency, grid.has_value()));

  std::vector<SineFit> fits(channels.size());
  constexpr int max_passes = 3;
  for (int pass = 1; pass <= max_passes; ++pass) {
    DYNCAL_TRY(const auto sums, grid ? accumulate(record, frequency, start.parameters, *grid)
                                     : accumulate(record, frequency, start.parameters));
    if (!all_finite(sums)) {
      return fail(record.not_finite());
    }
    const NormalMatrix matrix(sums.samples, sums.design);
    if (!matrix.well_conditioned()) {
      return fail(ill_conditioned(record, frequency));
    }
    bool again = false;
    for (std::size_t j = 0; j < fits.size(); ++j) {
      const Solution solution = solve(matrix, sums.channels[j], start.parameters[j]);
      fits[j] = fit_from(record, matrix, solution);
      start.parameters[j] = solution.p;
      again |= too_far(matrix, solution, start.plain ? 4.0 * max_cancellation : 4.0);
    }
    if (!again) {
      break;
    }
    start.plain = false;
  }
  if (std::none_of(fits.begin(), fits.end(),
                   [](const SineFit& fit) { return is_significant(fit); })) {
    return fail(ErrorCode::no_excitation,
                "no sine of " + std::to_string(frequency.hz()) +
                    " Hz stands out of the noise in any channel; check frequency and window");
  }
  const double turns = frequency.reduced_turns(shift_ns);
  for (SineFit& fit : fits) {
    rotate(fit, turns);
  }
  return fits;
}

} // namespace dyncal::analysis
