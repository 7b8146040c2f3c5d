// Messages of a bench as its programs write them, for tests of what shows it.
#pragma once

#include <cstdint>
#include <string>

#include "idl/dyncal.h"

namespace dyncal::network {

inline wire::SourceStatus status_of(const std::string& bench, const std::string& source,
                                    wire::SourceState state = wire::SOURCE_RUNNING,
                                    std::uint64_t lost = 0) {
  wire::SourceStatus status;
  status.bench(bench);
  status.source(source);
  status.session(7);
  status.state(state);
  status.rate_hz(1000.5);
  status.received(12'345);
  status.lost_in_transit(lost);
  return status;
}

// Of two steps of 2 s and 8 s.
inline wire::Measurement measurement_of(const std::string& bench, const std::string& run,
                                        wire::MeasurementState state,
                                        std::int64_t planned_utc_ns = 1'000) {
  wire::Measurement measurement;
  measurement.bench(bench);
  measurement.run(run);
  measurement.state(state);
  measurement.method(wire::METHOD_SAMPLE_TIMESTAMPING);
  measurement.planned_utc_ns(planned_utc_ns);
  measurement.conductor("lab-1:77");
  for (std::uint32_t number = 1; number <= 2; ++number) {
    wire::PlannedStep step;
    step.step(number);
    step.frequency_text_hz(number == 1 ? "16" : "31.5");
    step.level_m_s2(10.0);
    step.repetition(1);
    step.settling_s(2.0);
    step.duration_s(8.0);
    measurement.steps().push_back(step);
  }
  return measurement;
}

inline wire::Excitation excitation_of(const std::string& bench, const std::string& run,
                                      std::uint32_t step, wire::ExcitationState state) {
  wire::Excitation excitation;
  excitation.bench(bench);
  excitation.run(run);
  excitation.step(step);
  excitation.frequency_text_hz(step == 1 ? "16" : "31.5");
  excitation.level_m_s2(10.0);
  excitation.repetition(1);
  excitation.state(state);
  excitation.attempt(1);
  return excitation;
}

inline wire::CalibrationResult result_of(const std::string& bench, const std::string& run,
                                         std::uint32_t step, double magnitude) {
  wire::CalibrationResult result;
  result.bench(bench);
  result.run(run);
  result.channel("dau/acceleration_z");
  result.step(step);
  result.repetition(1);
  result.frequency_text_hz("16");
  result.frequency_hz(16.0);
  result.valid(true);
  result.magnitude(magnitude);
  result.u_magnitude(1e-4);
  result.phase_rad(-0.1);
  result.u_phase_rad(2e-4);
  result.unit("\\one");
  result.attempt(1);
  return result;
}

inline wire::ServiceStatus analysis_of(const std::string& bench, const std::string& run,
                                       wire::ArmState arm,
                                       wire::HealthState health = wire::HEALTH_OK) {
  wire::ServiceStatus status;
  status.bench(bench);
  status.service("dyncal-analysis:1@lab-1");
  status.run(run);
  status.arm(arm);
  status.health(health);
  status.host("lab-1");
  status.process_id(1);
  status.published_utc_ns(2'000);
  return status;
}

} // namespace dyncal::network
