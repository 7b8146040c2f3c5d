#include "services/contract/reference_step.hpp"

#include <cmath>
#include <complex>
#include <limits>

#include "idl/dyncal.h"
#include "services/contract/message_members.hpp"

namespace dyncal::inline contract {

void message_members(auto& visit, Either<ReferenceStep> auto& step, auto& message) {
  visit(step.step, message.step());
  visit(step.repetition, message.repetition());
  visit(step.frequency_text_hz, message.frequency_text_hz());
  visit(step.window_begin_utc_ns, message.window_begin_utc_ns());
  visit(step.window_end_utc_ns, message.window_end_utc_ns());
  visit(step.distortion_reference_rel, message.distortion_reference());
  visit(step.distortion_sync_rel, message.distortion_sync());
  visit(step.coverage, message.coverage());
  visit(step.origin, message.origin());
}

namespace {

std::complex<double> phasor_of(const wire::SineFit& fit) {
  return {fit.sine(), fit.cosine()};
}

// Along the phasor and across it.
struct PhasorUncertainty {
  double u_amplitude = 0.0;
  double u_phase_rad = 0.0;
};

PhasorUncertainty uncertainty_of(const wire::SineFit& fit) {
  const double amplitude = std::hypot(fit.sine(), fit.cosine());
  const double along = fit.sine() / amplitude, across = fit.cosine() / amplitude;
  return {std::hypot(along * fit.u_sine(), across * fit.u_cosine()),
          std::hypot(across * fit.u_sine(), along * fit.u_cosine()) / amplitude};
}

} // namespace

std::vector<PlannedReferenceStep> planned_reference_steps(const wire::Measurement& measurement) {
  std::vector<PlannedReferenceStep> steps;
  for (const wire::PlannedStep& planned : measurement.steps()) {
    steps.push_back({planned.step(), planned.repetition(), planned.frequency_text_hz(),
                     planned.settling_s() + planned.duration_s()});
  }
  return steps;
}

wire::AcsStep to_message(const ReferenceStep& step) {
  wire::AcsStep message;
  MessageWriter writer;
  message_members(writer, step, message);
  message.reference().channel("reference");
  message.sync().channel("sync");
  if (!step.problem.empty()) {
    message.origin(step.problem);
    message.reference().sine(std::numeric_limits<double>::quiet_NaN());
    return message;
  }
  message.reference().sine(step.amplitude_m_s2);
  message.reference().u_sine(step.u_amplitude_m_s2);
  message.reference().u_cosine(step.amplitude_m_s2 * step.u_phase_rad);
  message.sync().sine(std::cos(step.phase_rad));
  message.sync().cosine(std::sin(step.phase_rad));
  return message;
}

ReferenceStep from_message(const wire::AcsStep& message) {
  ReferenceStep step;
  MessageReader reader;
  message_members(reader, step, message);
  const std::complex<double> reference = phasor_of(message.reference());
  const std::complex<double> sync = phasor_of(message.sync());
  if (!(std::abs(reference) > 0.0) || !(std::abs(sync) > 0.0) ||
      !std::isfinite(std::abs(reference) + std::abs(sync))) {
    step.problem =
        step.origin.empty() ? "the reference's system states no value for this step" : step.origin;
    step.origin.clear();
    return step;
  }
  const PhasorUncertainty of_reference = uncertainty_of(message.reference());
  step.amplitude_m_s2 = std::abs(reference);
  step.u_amplitude_m_s2 = of_reference.u_amplitude;
  step.phase_rad = std::arg(sync * std::conj(reference));
  step.u_phase_rad =
      std::hypot(of_reference.u_phase_rad, uncertainty_of(message.sync()).u_phase_rad);
  return step;
}

} // namespace dyncal::inline contract
