// The members of a result file, each named once, by the rules of evaluation/result/members.hpp.
// Templates, any thread.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "analysis/uncertainty/coverage.hpp"
#include "services/evaluation/result/members.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

inline const std::string phase_convention =
    "lead: arg H in rad, a delay is negative; u_ are standard uncertainties (k = 1), U_ = k u_ "
    "expanded ones";

void members(auto& visit, Either<StoredFit> auto& one) {
  const analysis::SineFit& sine = one.fit.fit;
  visit.derived("channel", one.fit.channel);
  visit.known("role", one.role);
  visit.derived("frequency_hz", one.fit.frequency.hz());
  visit.derived("u_frequency_hz", one.fit.u_frequency_hz);
  visit.derived("phase_origin_ns", one.fit.phase_origin_ns);
  visit.derived("sine", sine.sine);
  visit.derived("cosine", sine.cosine);
  visit.derived("offset", sine.offset);
  visit.derived("covariance", std::vector(sine.covariance.begin(), sine.covariance.end()));
  visit.derived("amplitude", sine.amplitude());
  visit.derived("u_amplitude", sine.u_amplitude());
  visit.derived("phase_rad", sine.phase_rad());
  visit.derived("phase_deg", degrees_of(sine.phase_rad()));
  visit.derived("u_phase_rad", sine.u_phase_rad());
  const double samples = static_cast<double>(std::max<std::uint64_t>(sine.samples, 1));
  visit.derived("residual_rms", std::sqrt(sine.rss / samples));
  visit.derived("samples", sine.samples);
}

void uncertainty_members(auto& visit, auto& magnitude, auto& phase) {
  visit.derived("u_phase_deg", degrees_of(phase.u));
  visit("k_magnitude", magnitude.k);
  visit.infinite("nu_eff_magnitude", magnitude.nu_eff);
  visit("U_magnitude", magnitude.expanded);
  visit("k_phase", phase.k);
  visit.infinite("nu_eff_phase", phase.nu_eff);
  visit("U_phase_rad", phase.expanded);
  visit.derived("U_phase_deg", degrees_of(phase.expanded));
}

void members(auto& visit, Either<StoredValue> auto& one) {
  visit("channel", one.channel);
  visit("unit", one.unit);
  visit("frequency_text_hz", one.frequency_text_hz);
  visit("frequency_hz", one.frequency_hz);
  visit("level_m_s2", one.level_m_s2);
  visit.unless_empty("excited_axis", one.excited_axis);
  visit("magnitude", one.magnitude);
  visit("u_magnitude", one.of_magnitude.u);
  visit("phase_rad", one.phase_rad);
  visit.derived("phase_deg", degrees_of(one.phase_rad));
  visit("u_phase_rad", one.of_phase.u);
  visit("unwrapped_phase_rad", one.unwrapped_phase_rad);
  visit.derived("unwrapped_phase_deg", degrees_of(one.unwrapped_phase_rad));
  visit("scatter_magnitude", one.scatter_magnitude);
  visit("scatter_phase_rad", one.scatter_phase_rad);
  visit("repetitions", one.repetitions);
  uncertainty_members(visit, one.of_magnitude, one.of_phase);
  visit("coverage_probability", one.coverage_probability);
  visit("u_independent_phase_rad", one.u_independent_phase_rad);
  visit("flags", one.flags);
  visit("flag_names", one.flag_names);
}

void members(auto& visit, Either<analysis::TransferCheck> auto& one) {
  auto& [magnitude, phase] = one;
  visit("trials", magnitude.trials);
  visit.derived("stable", magnitude.stable && phase.stable);
  visit("u_magnitude", magnitude.u);
  visit.derived("magnitude_interval", std::vector{magnitude.low, magnitude.high});
  visit("u_phase_rad", phase.u);
  visit.derived("phase_interval_rad", std::vector{phase.low, phase.high});
}

void members(auto& visit, Either<StoredPoint> auto& one) {
  visit("channel", one.channel);
  visit("step", one.step);
  visit("frequency_text_hz", one.frequency_text_hz);
  visit("frequency_hz", one.frequency_hz);
  visit("level_m_s2", one.level_m_s2);
  visit.unless_empty("excited_axis", one.excited_axis);
  visit("repetition", one.repetition);
  visit("valid", one.valid);
  visit("magnitude", one.magnitude);
  visit("u_magnitude", one.u_magnitude);
  visit("phase_rad", one.phase_rad);
  visit.derived("phase_deg", degrees_of(one.phase_rad));
  visit("u_phase_rad", one.u_phase_rad);
  visit("unit", one.unit);
  visit("lost", one.lost);
  visit.object("samples", [&](auto& used) {
    for (const SourceSamples& source : one.samples) {
      used.derived(source.source.c_str(), source.used);
    }
  });
  visit("flags", one.sentences);
  visit("flag_names", one.flag_names);
  visit("budget", one.budget);
  visit("signals", one.signals);
  visit("data_sha256", one.data_sha256);
  if (one.valid) {
    uncertainty_members(visit, one.of_magnitude, one.of_phase);
    visit.derived("coverage_probability", analysis::two_sigma_probability);
    visit.if_known("measured_frequency_hz", one.measured_frequency_hz);
    visit.if_known("u_measured_frequency_hz", one.u_measured_frequency_hz);
    visit.if_known("measured_level_m_s2", one.measured_level_m_s2);
    visit.if_known("u_measured_level_m_s2", one.u_measured_level_m_s2);
    visit("source_samples", one.samples);
    visit.derived_if("fit", one.own_fit);
  } else {
    visit("problem", one.problem);
  }
  visit("temperature_degc", one.temperature_degc);
  visit("monte_carlo", one.monte_carlo);
  visit.unless("attempt", one.attempt, 1U);
  if (one.series) {
    visit("sample_rate_hz", one.series->sample_rate_hz);
    visit("u_sample_rate_hz", one.series->u_sample_rate_hz);
    visit("series_start", one.series->start);
    visit("series_start_scatter_s", one.series->start_scatter_s);
  }
}

void members(auto& visit, Either<StoredChannel> auto& one) {
  visit("channel", one.channel);
  visit("unit", one.unit);
  visit("responds", one.responds);
  visit("lost", one.lost);
  visit("flags", one.flags);
  visit("flag_names", one.flag_names);
  visit("group_delay_problem", one.group_delay_problem);
  visit("closures", one.closures);
}

void members(auto& visit, Either<StoredDelay> auto& one) {
  visit("channel", one.channel);
  members(visit, one.delay);
}

void members(auto& visit, Either<StoredFlag> auto& one) {
  visit("name", one.name);
  visit("sentences", one.sentences);
  visit("meaning", one.meaning);
}

void members(auto& visit, Either<StoredRoles> auto& one) {
  visit("reference", one.reference);
  visit.unless_empty("excitation", one.excitation);
  visit.unless_empty("sync_acs", one.sync_acs);
  visit.unless_empty("sync_dau", one.sync_dau);
  visit.unless_empty("sync_dso", one.sync_dso);
  visit("dut", one.dut);
  visit.unless_empty("temperature", one.temperature);
}

void members(auto& visit, Either<StoredCorrection> auto& one) {
  visit("name", one.name);
  visit("phase_rad", one.phase_rad);
  visit.derived("phase_deg", degrees_of(one.phase_rad));
  visit("u_phase_rad", one.u_phase_rad);
  visit("magnitude_factor", one.magnitude_factor);
  visit("u_magnitude_rel", one.u_magnitude_rel);
}

void members(auto& visit, Either<StoredStep> auto& one) {
  visit("step", one.step);
  visit("repetition", one.repetition);
  visit("frequency_text_hz", one.frequency_text_hz);
  visit("frequency_hz", one.frequency_hz);
  visit("level_m_s2", one.level_m_s2);
  visit("settling_s", one.settling_s);
  visit("duration_s", one.duration_s);
  visit("corrections", one.corrections);
  visit.derived("fits", one.fits);
}

void members(auto& visit, Either<StoredCorrections> auto& one) {
  visit("reference_delay_s", one.reference_delay_s);
  visit("reference_standard", one.reference_standard);
  visit.unless_empty("channel_axes", one.channel_axes);
  visit("transverse_motion", one.transverse_motion);
  if (visit("adc_calibration", one.adc_calibration); one.adc_calibration) {
    visit.derived("adc_file", one.adc_file);
  }
  if (visit("dso_delay_s", one.dso_delay_s); one.dso_delay_s) {
    visit("u_dso_delay_s", one.u_dso_delay_s);
    visit("trigger_phase_correction", one.trigger_phase_correction);
  }
}

void members(auto& visit, Either<DailyCheck> auto& one) {
  visit("sensor", one.sensor);
  visit("run", one.run);
  visit("began_utc", one.began_utc);
  visit("state", one.state);
  visit("left_out", one.left_out);
}

void members(auto& visit, Either<ActingPerson> auto& one) {
  visit("name", one.name);
  visit("user", one.user);
  visit("host", one.host);
}

void members(auto& visit, Either<LoggedCondition> auto& one) {
  visit("quantity", one.quantity);
  visit("unit", one.unit);
  visit("source", one.source);
  visit("count", one.count);
  visit("minimum", one.minimum);
  visit("mean", one.mean);
  visit("maximum", one.maximum);
  visit("U", one.expanded);
  visit("problem", one.problem);
}

void members(auto& visit, Either<CombinedRun> auto& one) {
  visit("bench", one.bench);
  visit("run", one.run);
  visit("sha256", one.sha256);
}

// Without the schema, which comes before all else.
void members(auto& visit, Either<StoredResult> auto& one) {
  visit("bench", one.bench);
  visit("run", one.run);
  visit("method", one.method);
  visit.derived("phase_convention", phase_convention);
  visit("software", one.software);
  visit.object("analysis", [&](auto& analysis) {
    analysis.known("software", one.analysis_software);
    analysis.known("host", one.analysis_host);
  });
  visit.object("dds", [&](auto& dds) { dds("analysis", one.analysis_dds); });
  visit.known("began_utc", one.began_utc);
  visit.known("ended_utc", one.ended_utc);
  visit("planned_steps", one.planned_steps);
  visit("interrupted", one.interrupted);
  visit("problem", one.problem);
  visit("recipe_sha256", one.recipe_sha256);
  visit("flag_legend", one.flags);
  visit("sources", one.sources);
  visit.unless_empty("pauses", one.pauses);
  visit("roles", one.roles);
  visit("corrections", one.corrections);
  visit("steps", one.steps);
  visit("channels", one.channels);
  visit("transfer_function", one.values);
  visit("group_delay", one.group_delays);
  visit("sample_clock", one.clocks);
  visit("points", one.points);
  visit.unless_empty("recipe", one.recipe);
  visit.unless_empty("combined", one.combined);
  visit("check", one.check);
  visit("conducted_by", one.conducted_by);
  visit.unless_empty("comment", one.comment);
  visit.unless_empty("sensor", one.sensor);
  visit.unless_empty("conditions", one.conditions);
}

} // namespace dyncal::inline views
