// A run with everything that a result can hold: two channels of which one does not respond, a
// step without a value, flags, fits, a temperature, events.
#pragma once

#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::tests {

inline evaluation::TransferFunction example_function(const std::string& channel, double magnitude) {
  evaluation::TransferFunction function;
  function.channel = channel;
  function.unit = R"(\one)";
  for (const char* text : {"10", "20"}) {
    evaluation::FrequencyPoint point;
    point.frequency_text_hz = text;
    point.frequency_hz = std::stod(text);
    point.level_m_s2 = 2.75;
    point.mean.magnitude = magnitude;
    point.mean.u_magnitude = 1e-3;
    point.mean.phase_rad = -0.5;
    point.mean.u_phase_rad = 2e-3;
    point.mean.repetitions = 3;
    function.points.push_back(point);
  }
  function.group_delay.emplace();
  function.group_delay->delay_s = 8.1e-3;
  function.group_delay->of_delay = {1e-6, 9.0, 2.32};
  function.group_delay->intercept_rad = -3.14159;
  function.group_delay->of_intercept.u = 0.00087;
  function.group_delay->phase_covariance = {4e-6, 0.0, 0.0, 4e-6};
  return function;
}

inline analysis::ChannelFit example_fit(const std::string& channel, double amplitude) {
  analysis::ChannelFit fit{.channel = channel,
                           .frequency = analysis::Frequency::from_hz(10.000001),
                           .u_frequency_hz = 1e-7,
                           .phase_origin_ns = 1'700'000'000'000'000'000,
                           .fit = {}};
  fit.fit.sine = amplitude;
  fit.fit.covariance = {1e-8, 0.0, 0.0, 1e-8, 0.0, 1e-8};
  fit.fit.rss = 1e-3;
  fit.fit.samples = 1000;
  fit.fit.degrees_of_freedom = 997.0;
  return fit;
}

inline evaluation::StepResult example_result(std::uint32_t step, const std::string& frequency_hz) {
  evaluation::StepResult result;
  result.channel = "dau/acceleration_z";
  result.step = step;
  result.frequency_hz = std::stod(frequency_hz);
  result.frequency_text_hz = frequency_hz;
  result.level_m_s2 = 2.75;
  result.repetition = 1;
  return result;
}

inline evaluation::Recipe example_recipe() {
  evaluation::Recipe recipe;
  recipe.bench = "acc-1";
  recipe.run = "r1";
  recipe.roles = {.reference = {"acs", "reference"},
                  .sync_acs = {"acs", "sync"},
                  .sync_sensor = {"dau", "sync"},
                  .dut = {{"dau", "acceleration_z"}}};
  recipe.adc_calibration = {{5.0, 19.5, 0.2, 1e-4}, {50.0, 19.5, 0.2, 1e-3}};
  recipe.reference_delay_s = 1e-6;
  for (const char* text : {"10", "20"}) {
    recipe.steps.push_back({.step = static_cast<std::uint32_t>(recipe.steps.size() + 1),
                            .repetition = 1,
                            .frequency_text_hz = text,
                            .frequency = *analysis::Frequency::parse(text),
                            .level_m_s2 = 2.75,
                            .settling_s = 0.5,
                            .duration_s = 2.0});
  }
  recipe.text = "bench = \"acc-1\"\n";
  recipe.sha256 = "abc";
  return recipe;
}

inline evaluation::RunOutcome example_outcome() {
  using evaluation::ResultFlag;
  evaluation::RunOutcome outcome = outcome_of(example_recipe());
  outcome.began_utc_ns = 1'700'000'000'000'000'012;
  outcome.ended_utc_ns = 1'700'000'060'000'000'000;
  outcome.analysis_dds = "fastdds";
  outcome.analysis_software = "dyncal 1.2.3";
  outcome.analysis_host = "lab-pc";
  drivers::SourceDescription acs{.device = "8-channel ADC",
                                 .serial = "42",
                                 .firmware = "2.1",
                                 .driver = "socket",
                                 .channels = {}};
  acs.channels = {{"reference", "acceleration", R"(\metre\second\tothe{-2})", -50.0, 50.0, 0.0},
                  {"sync", "", R"(\volt)"}};
  outcome.pauses = {{1'700'000'010'000'000'000, 1'700'000'052'400'000'000, "paused by 'ada'"}};
  outcome.sources = {{"acs", contract::SourceKind::acs, "dyncal 1.2.3", acs}};

  evaluation::StepResult measured = example_result(1, "10");
  measured.valid = true;
  measured.magnitude = 1.0;
  measured.phase_rad = -0.5;
  measured.u_phase_rad = 1e-3;
  measured.fits = {example_fit("acs/reference", 2.7), example_fit("acs/sync", 1.0),
                   example_fit("dau/acceleration_z", 2.7)};
  measured.budget = {{.kind = analysis::ContributionKind::reference, .u_phase_rad = 1e-3},
                     {.kind = analysis::ContributionKind::fit_noise,
                      .subject = "the sensor",
                      .degrees_of_freedom = 17.0,
                      .u_magnitude_rel = 1e-3}};
  measured.samples = {{.source = "dau", .used = 3010, .lost = 7}};
  measured.lost = 7;
  measured.flags = {flag_of_source(ResultFlag::samples_lost, "dau")};
  measured.temperature_degc = 23.5;
  evaluation::StepResult failed = example_result(2, "20");
  failed.problem = "no steady sine";
  failed.attempt = 3;
  outcome.results = {measured, failed};

  outcome.transfer_functions = {example_function("dau/acceleration_z", 1.0),
                                example_function("dau/angular_velocity_x", 1e-4)};
  outcome.transfer_functions.front().flags = {make_flag(ResultFlag::polarity_inverted)};
  evaluation::ClockReport clock{.source = "dau", .clock = {}};
  clock.clock.mean_interval_s = 996.96e-6;
  clock.clock.intervals = 1000;
  clock.clock.event_count = 1;
  clock.clock.events = {{"gap", 300, 0.299, 1e6, 1}};
  outcome.clock_reports.push_back(clock);
  return outcome;
}

} // namespace dyncal::tests
