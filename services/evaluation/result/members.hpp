// The members of what a result is made of, each named once. Whatever writes or reads them (files,
// page, exports) is a visitor that goes over these lists.
//
//   visit("lost", one.lost)                 a member: number, text, truth, list, struct with a list
//   visit.named("kind", one.kind, last)     an enumeration by to_string(), or by a function given
//                                           as well; `last` is its last value
//   visit.known("tick_s", one.tick_s)       0, or an empty text: not known
//   visit.infinite("degrees_of_freedom", x) may be infinite
//   visit.utc("began_utc", one.began_ns)    ns since 1970; 0: not known
//   visit.flags(one.flags)                  "flags" (sentences) and "flag_names"
//   visit.object("quantiles_s", list)       members one level down, which `list` visits
//   visit.range("minimum", a, "maximum", b) equal: not known
//   visit.derived("phase_deg", value)       follows from other members: written, never read
//   visit.derived_if("fit", optional)       the same, absent where there is none
//   visit.unless_empty("recipe", one.text)  absent where it is empty
//   visit.unless("attempt", one.attempt, 1U)  absent where it is that
//
// Units and signs are those of the structs. Templates, any thread.
#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <string>

#include "analysis/response/group_delay.hpp"
#include "analysis/uncertainty/contribution_identifier.hpp"
#include "services/contract/message_members.hpp"
#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] constexpr double degrees_of(double angle_rad) {
  return angle_rad * (180.0 / std::numbers::pi);
}

[[nodiscard]] const char* to_string(drivers::TimeBase base);
[[nodiscard]] const char* to_string(drivers::StampInstant instant);

// "2026-03-01T12:00:00.123456789Z", and back; 0, which is not known, is "".
[[nodiscard]] std::string utc_text(std::int64_t utc_ns);
[[nodiscard]] std::int64_t parse_utc_text(const std::string& text);

// Of the sensor over the run; nothing where it was not measured.
struct TemperatureRange {
  double minimum = 0.0;
  double mean = 0.0;
  double maximum = 0.0;
};
[[nodiscard]] std::optional<TemperatureRange>
temperature_range(const analysis::SampleClockStatistics& clock);

void members(auto& visit, Either<TemperatureRange> auto& one) {
  visit("minimum", one.minimum);
  visit("mean", one.mean);
  visit("maximum", one.maximum);
}

void members(auto& visit, Either<SourceSamples> auto& one) {
  visit("source", one.source);
  visit("used", one.used);
  visit("lost", one.lost);
  visit("unusable", one.unusable);
  visit("overflowed", one.overflowed);
  visit("not_trusted", one.not_trusted);
  visit("not_measured", one.not_measured);
  visit("first_stamp_ns", one.first_stamp_ns);
  visit("last_stamp_ns", one.last_stamp_ns);
  visit("cut_out", one.cut_out);
}

void members(auto& visit, Either<ChannelSignal> auto& one) {
  visit("channel", one.channel);
  visit("thd", one.thd);
  visit("u_thd", one.u_thd);
  visit("residual_rel", one.residual);
  visit("residual_over_noise", one.over_noise);
}

void members(auto& visit, Either<analysis::Contribution> auto& one) {
  visit.derived("name", one.name());
  visit.named("kind", one.kind, analysis::ContributionKind::other, analysis::identifier_of);
  visit("subject", one.subject);
  visit.named("distribution", one.distribution, analysis::Distribution::arcsine);
  visit.named("repeats", one.repeats, analysis::Repeats::common_delay);
  visit.infinite("degrees_of_freedom", one.degrees_of_freedom);
  visit("u_magnitude_rel", one.u_magnitude_rel);
  visit("u_lasting_magnitude_rel", one.u_lasting_magnitude_rel);
  visit("u_phase_rad", one.u_phase_rad);
}

void members(auto& visit, Either<Closure> auto& one) {
  visit.named("kind", one.kind, last_closure_kind);
  visit("subject", one.subject);
  visit.named("verdict", one.verdict, Verdict::not_possible);
  visit("value", one.value);
  visit.known("u", one.u);
  visit.known("limit", one.limit);
  visit("unit", one.unit);
  visit("sentence", one.sentence);
}

void members(auto& visit, Either<analysis::GroupDelay> auto& one) {
  visit("value_s", one.delay_s);
  visit("u_s", one.of_delay.u);
  visit("intercept_rad", one.intercept_rad);
  visit.derived("intercept_deg", degrees_of(one.intercept_rad));
  visit("u_intercept_rad", one.of_intercept.u);
  visit.derived("u_intercept_deg", degrees_of(one.of_intercept.u));
  visit("cov_delay_intercept_rad_s", one.cov_delay_intercept);
  visit("phase_covariance_rad2", one.phase_covariance);
  visit("chi_squared", one.chi_squared);
  visit("degrees_of_freedom", one.degrees_of_freedom);
  visit("polarity_inverted", one.polarity_inverted);
  visit("k", one.of_delay.k);
  visit.infinite("nu_eff", one.of_delay.degrees_of_freedom);
  visit.derived("U_s", one.of_delay.expanded());
  visit("k_intercept", one.of_intercept.k);
  visit.infinite("nu_eff_intercept", one.of_intercept.degrees_of_freedom);
  visit.derived("U_intercept_rad", one.of_intercept.expanded());
}

void members(auto& visit, Either<analysis::IntervalEvent> auto& one) {
  visit("kind", one.kind);
  visit("sample", one.sample);
  visit("time_s", one.time_s);
  visit("size_ns", one.size_ns);
  visit("missing", one.missing);
}

void members(auto& visit, Either<ClockReport> auto& one) {
  auto& clock = one.clock;
  visit("source", one.source);
  visit("mean_interval_s", clock.mean_interval_s);
  visit("u_mean_interval_s", clock.u_mean_interval_s);
  visit("sd_s", clock.sd_s);
  visit("min_s", clock.minimum_s);
  visit("max_s", clock.maximum_s);
  visit("median_s", clock.median_s);
  visit("mad_sd_s", clock.mad_sd_s);
  visit.object("quantiles_s", [&](auto& quantiles) {
    quantiles("0.001", clock.quantile_001_s);
    quantiles("0.01", clock.quantile_01_s);
    quantiles("0.5", clock.quantile_50_s);
    quantiles("0.99", clock.quantile_99_s);
    quantiles("0.999", clock.quantile_999_s);
  });
  visit("count", clock.intervals);
  visit("nominal_rate_hz", clock.nominal_rate_hz);
  visit("mean_rate_hz", clock.mean_rate_hz);
  visit("tick_s", clock.tick_s);
  visit("lattice_statistic", clock.lattice_statistic);
  visit("event_count", clock.event_count);
  visit("events", clock.events); // the first of them
  visit("pair_period_samples", clock.pair_period_samples);
  visit("pair_period_s", clock.pair_period_s);
  visit.derived("temperature_degc", temperature_range(clock));
  visit("temperature_correlation", clock.temperature_correlation);
  visit("temperature_slope_s_per_degc", clock.temperature_slope_s_per_degc);
  visit("lost", clock.lost);
  visit.flags(one.flags);
  visit("k", clock.k_mean_interval);
  visit.infinite("nu_eff", clock.degrees_of_freedom_mean_interval);
  visit.derived("U_mean_interval_s", clock.of_mean_interval().expanded());
  visit.derived("rate_deviation_rel", clock.rate_deviation_rel());
  visit.derived("u_rate_deviation_rel", clock.of_rate_deviation().u);
  visit.derived("U_rate_deviation_rel", clock.of_rate_deviation().expanded());
}

void members(auto& visit, Either<drivers::ChannelDescription> auto& one) {
  visit("name", one.name);
  visit.known("quantity", one.quantity);
  visit.known("unit", one.unit);
  visit.range("minimum", one.minimum, "maximum", one.maximum);
  visit.known("resolution", one.resolution);
}

void members(auto& visit, Either<RunSource> auto& one) {
  auto& description = one.description;
  visit("source", one.source);
  visit.named("kind", one.kind, SourceKind::can);
  visit.known("device", description.device);
  visit.known("serial", description.serial);
  visit.known("firmware", description.firmware);
  visit.known("driver", description.driver);
  visit.known("software", one.software);
  visit.known("nominal_rate_hz", description.nominal_rate_hz);
  visit.named("time_base", description.time_base, drivers::TimeBase::utc);
  visit.named("stamp_instant", description.stamp_instant, drivers::StampInstant::frame_end);
  visit.known("tick_s", description.tick_s);
  visit.known("stamp_uncertainty_s", description.stamp_uncertainty_s);
  visit("channels", description.channels);
}

void members(auto& visit, Either<RunPause> auto& one) {
  visit.utc("began_utc", one.began_utc_ns);
  visit.utc("ended_utc", one.ended_utc_ns);
  visit("reason", one.reason);
}

void members(auto& visit, Either<analysis::AdcCalibrationPoint> auto& one) {
  visit("frequency_hz", one.frequency_hz);
  visit("test_amplitude_vpp", one.test_amplitude_vpp);
  visit("gain", one.gain);
  visit("u_gain", one.u_gain);
  visit("phase_lag_rad", one.phase_lag_rad);
  visit("u_phase_lag_rad", one.u_phase_lag_rad);
}

void members(auto& visit, Either<ChannelAxis> auto& one) {
  visit("channel", one.channel);
  visit("axis", one.axis);
}

void members(auto& visit, Either<TransverseMotionPoint> auto& one) {
  visit("frequency_hz", one.frequency_hz);
  visit("ratio", one.ratio);
}

void members(auto& visit, Either<TransverseMotion> auto& one) {
  visit("points", one.points);
  visit("source", one.source);
}

void members(auto& visit, Either<CalibratedDevice> auto& one) {
  visit("name", one.name);
  visit.unless_empty("manufacturer", one.manufacturer);
  visit.unless_empty("model", one.model);
  visit.unless_empty("serial", one.serial);
  visit.unless_empty("certificate", one.certificate);
  visit.unless_empty("issued_by", one.issued_by);
  visit.unless_empty("issued", one.issued);
  visit.unless_empty("valid_until", one.valid_until);
}

void members(auto& visit, Either<ReferenceStandard> auto& one) {
  visit("devices", one.devices);
  visit.unless_empty("standard", one.standard);
  visit.unless_empty("traceability", one.traceability);
  visit.unless_empty("file", one.file);
  visit.unless_empty("file_sha256", one.file_sha256);
}

void members(auto& visit, Either<AdcFile> auto& one) {
  visit("path", one.path);
  visit("channel", one.channel);
  visit("sha256", one.sha256);
}

} // namespace dyncal::inline evaluation
