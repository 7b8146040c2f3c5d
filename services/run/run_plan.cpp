#include "services/run/run_plan.hpp"

#include "analysis/base/frequency.hpp"
#include "services/run/level_settling.hpp"

namespace dyncal::services {
namespace {

wire::Method method_message(EvaluationMethod method) {
  switch (method) {
  case EvaluationMethod::analogue:
    return wire::METHOD_ANALOGUE;
  case EvaluationMethod::series_timestamping:
    return wire::METHOD_SERIES_TIMESTAMPING;
  case EvaluationMethod::absolute_time:
    return wire::METHOD_ABSOLUTE_TIME;
  case EvaluationMethod::sample_timestamping:
    break;
  }
  return wire::METHOD_SAMPLE_TIMESTAMPING;
}

void plan_steps(const BenchFile& file, wire::Measurement& measurement) {
  const ExcitationSettings& excitation = file.excitation;
  std::uint32_t number = 0;
  for (int repetition = 1; repetition <= excitation.repetitions; ++repetition) {
    for (std::size_t i = 0; i < excitation.frequencies_hz.size(); ++i) {
      wire::PlannedStep step;
      step.step(++number);
      step.repetition(static_cast<std::uint32_t>(repetition));
      step.frequency_text_hz(excitation.frequencies_hz[i]);
      step.level_m_s2(excitation.levels_m_s2[i]);
      step.settling_s(planned_settling_s(
          file, analysis::Frequency::parse(excitation.frequencies_hz[i])->hz(), repetition));
      step.duration_s(excitation.duration_s);
      measurement.steps().push_back(step);
    }
  }
}

void plan_adc(const std::vector<analysis::AdcCalibrationPoint>& points,
              wire::Measurement& measurement) {
  for (const analysis::AdcCalibrationPoint& point : points) {
    wire::AdcCalibrationPoint message;
    message.frequency_hz(point.frequency_hz);
    message.test_amplitude_vpp(point.test_amplitude_vpp);
    message.gain(point.gain);
    message.phase_lag_rad(point.phase_lag_rad);
    message.u_gain(point.u_gain);
    message.u_phase_lag_rad(point.u_phase_lag_rad);
    measurement.adc_calibration().push_back(message);
  }
}

} // namespace

wire::Measurement
plan_measurement(const BenchFile& file, const std::string& run, std::int64_t now_utc_ns,
                 const std::vector<analysis::AdcCalibrationPoint>& adc_calibration) {
  wire::Measurement measurement;
  measurement.bench(file.bench);
  measurement.run(run);
  measurement.state(wire::MEASUREMENT_PLANNED);
  measurement.method(method_message(file.method.kind));
  measurement.planned_utc_ns(now_utc_ns);
  measurement.reference(file.method.reference.text());
  const auto text_of = [](const ChannelName& name) {
    return name.source.empty() ? std::string() : name.text();
  };
  measurement.sync_acs(text_of(file.method.sync_acs));
  if (file.method.kind == EvaluationMethod::series_timestamping) {
    measurement.sync_dso(text_of(file.method.sync_dau));
  } else {
    measurement.sync_dau(text_of(file.method.sync_dau));
  }
  for (const ChannelName& name : file.method.dut) {
    measurement.dut().push_back(name.text());
  }
  if (file.method.temperature) {
    measurement.temperature(file.method.temperature->text());
  }
  plan_steps(file, measurement);
  plan_adc(adc_calibration, measurement);
  measurement.u_reference_magnitude_rel(file.uncertainty.reference_magnitude_rel);
  measurement.u_reference_phase_rad(file.uncertainty.reference_phase_rad);
  measurement.dso_delay_s(file.corrections.dso_delay_s);
  measurement.u_dso_delay_s(file.corrections.u_dso_delay_s);
  measurement.u_acs_delay_s(file.uncertainty.acs_delay_s);
  measurement.frequency_search_rel(file.method.frequency_search_rel);
  measurement.frequency_exact(file.method.frequency_search_rel == 0.0);
  measurement.reference_delay_s(file.corrections.reference_delay_s);
  measurement.whole_record(file.excitation.whole_record);
  measurement.settling_from_data(file.excitation.settling_from_data);
  measurement.monte_carlo_trials(file.uncertainty.monte_carlo_trials);
  measurement.shots(static_cast<std::uint32_t>(file.method.shots));
  measurement.trigger_phase_correction(file.method.trigger_phase_correction);
  measurement.u_acs_rate_rel(file.uncertainty.acs_rate_rel);
  measurement.recipe(file.text);
  measurement.recipe_sha256(file.sha256);
  return measurement;
}

} // namespace dyncal::services
