#include "analysis/method/record_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/clock/stamp_beat.hpp"
#include "analysis/sine/disturbances.hpp"
#include "analysis/sine/frequency_estimate.hpp"
#include "analysis/sine/sine_residuals.hpp"
#include "analysis/sine/stamp_scatter.hpp"
#include "analysis/uncertainty/found_resolution.hpp"

namespace dyncal::analysis {
namespace {

// The estimate is good to this many bins 1/T (frequency_estimate.hpp).
constexpr double estimate_bins = 1.5;
// Part of u of an amplitude from which on it is corrected for scatter of the stamps.
constexpr double worth_correcting = 0.1;

using Stamps = std::span<const std::int64_t>;
using Columns = std::span<const std::span<const double>>;

Progress begin_stage(const RecordFitStages& begin, std::string_view stage) {
  return begin ? begin(stage) : Progress{};
}

Expected<FrequencyFit> find_frequency(std::int64_t origin_ns, Stamps stamps_ns, Columns columns,
                                      const RecordFitStages& begin) {
  DYNCAL_TRY(const auto start, estimate_frequency(stamps_ns, columns,
                                                  begin_stage(begin, "estimating the frequency")));
  const double duration_s = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  const double search_rel = std::min(estimate_bins / (start.hz() * duration_s), 0.9);
  begin_stage(begin, "fitting the frequency");
  return fit_sine_and_frequency(start, search_rel, origin_ns, stamps_ns, columns);
}

bool is_plain(const ExtendedBasis& basis) {
  return basis.drift_order == 0 && basis.max_harmonic <= 1 && basis.lines.empty() &&
         !basis.drifting_phasor;
}

Expected<std::vector<SineFit>> fit_columns(const Frequency& frequency, const ExtendedBasis& basis,
                                           std::int64_t origin_ns, Stamps stamps_ns,
                                           Columns columns, const RecordFitStages& begin) {
  const Progress progress = begin_stage(begin, "fitting");
  if (is_plain(basis)) {
    return fit_sine(frequency, origin_ns, stamps_ns, columns);
  }
  DYNCAL_TRY(const auto extended, fit_sine_extended(frequency, basis, Weighting::none, origin_ns,
                                                    stamps_ns, columns, progress));
  std::vector<SineFit> fits;
  fits.reserve(extended.size());
  for (const ExtendedFit& one : extended) {
    fits.push_back(one.fundamental);
  }
  return fits;
}

// The amplitude without what scatter of the stamps took off it, and what is not known of that.
void lengthen(const StampScatter& scatter, SineFit& fit) {
  const double factor = 1.0 / (1.0 - scatter.correction_rel());
  const double u_rel = scatter.u_correction_rel();
  fit.sine *= factor;
  fit.cosine *= factor;
  fit.covariance[0] += std::pow(u_rel * fit.sine, 2);
  fit.covariance[1] += u_rel * u_rel * fit.sine * fit.cosine;
  fit.covariance[3] += std::pow(u_rel * fit.cosine, 2);
}

// Each column is looked at beside its harmonics, hum and drift, which are no scatter. Where that
// cannot be fitted, nothing is corrected.
void correct_scatter(Stamps stamps_ns, Columns columns, RecordFit& record) {
  record.shortening_rel.assign(columns.size(), 0.0);
  const std::int64_t middle_ns = middle_of_record_ns(stamps_ns);
  const auto beside = fit_sine_beside_disturbances(record.frequency, middle_ns, stamps_ns, columns);
  for (std::size_t i = 0; beside && i < columns.size(); ++i) {
    const CleanedFit& clean = (*beside)[i];
    const std::span<const double> values =
        clean.values.empty() ? columns[i] : std::span<const double>(clean.values);
    const StampScatter scatter =
        measure_stamp_scatter(record.frequency, clean.fit, middle_ns, stamps_ns, values,
                              found_resolution(columns[i]), SlowScatter::counts);
    SineFit& one = record.fits[i];
    if (scatter.correction_rel() * one.amplitude() > worth_correcting * one.u_amplitude()) {
      record.shortening_rel[i] = scatter.correction_rel();
      lengthen(scatter, one);
    }
  }
}

// What errors of the stamps that are in step with the sine may do to it, in any direction.
void allow_for_beat(Stamps stamps_ns, RecordFit& record) {
  const double bound_rel = stamp_beat(record.frequency, stamps_ns).in_step_rad;
  for (SineFit& one : record.fits) {
    const double variance = std::pow(bound_rel * one.amplitude(), 2) / 3.0;
    one.covariance[0] += variance;
    one.covariance[3] += variance;
  }
}

Expected<RecordFit> fit_sines(const RecordFitSettings& settings, std::int64_t origin_ns,
                              Stamps stamps_ns, Columns columns, const RecordFitStages& begin) {
  if (settings.frequency) {
    DYNCAL_TRY(auto fits, fit_columns(*settings.frequency, settings.basis, origin_ns, stamps_ns,
                                      columns, begin));
    return RecordFit{*settings.frequency, std::nullopt, origin_ns, std::move(fits), {}};
  }
  DYNCAL_TRY(auto found, find_frequency(origin_ns, stamps_ns, columns, begin));
  RecordFit record{found.frequency, found.u_frequency_hz, origin_ns, std::move(found.channels), {}};
  if (!is_plain(settings.basis)) {
    DYNCAL_TRY(record.fits,
               fit_columns(record.frequency, settings.basis, origin_ns, stamps_ns, columns, begin));
  }
  return record;
}

} // namespace

Expected<RecordFit> fit_record(const RecordFitSettings& settings, Stamps stamps_ns, Columns columns,
                               const RecordFitStages& begin) {
  if (stamps_ns.empty()) {
    return fail(ErrorCode::too_few_samples, "the record has no samples");
  }
  const std::int64_t origin_ns = settings.phase_origin_ns.value_or(stamps_ns.front());
  DYNCAL_TRY(auto record, fit_sines(settings, origin_ns, stamps_ns, columns, begin));
  correct_scatter(stamps_ns, columns, record);
  allow_for_beat(stamps_ns, record);
  return record;
}

} // namespace dyncal::analysis
