#include "services/evaluation/result/result_message.hpp"

#include <algorithm>
#include <cmath>

#include "services/base/version.hpp"
#include "services/evaluation/result/contribution_message.hpp"

namespace dyncal::inline evaluation {
namespace {

wire::SineFit fit_message(const analysis::ChannelFit& fit) {
  wire::SineFit message;
  message.channel(fit.channel);
  message.frequency_hz(fit.frequency.hz());
  message.u_frequency_hz(fit.u_frequency_hz);
  message.phase_origin_ns(fit.phase_origin_ns);
  message.sine(fit.fit.sine);
  message.cosine(fit.fit.cosine);
  message.offset(fit.fit.offset);
  message.u_sine(std::sqrt(fit.fit.covariance[0]));
  message.u_cosine(std::sqrt(fit.fit.covariance[3]));
  message.u_offset(std::sqrt(fit.fit.covariance[5]));
  message.residual_rms(
      std::sqrt(fit.fit.rss / static_cast<double>(std::max<std::uint64_t>(fit.fit.samples, 1))));
  message.sample_count(fit.fit.samples);
  return message;
}

wire::FitCovariance covariance_message(const analysis::SineFit& fit) {
  wire::FitCovariance message;
  message.sine_sine(fit.covariance[0]);
  message.sine_cosine(fit.covariance[1]);
  message.sine_offset(fit.covariance[2]);
  message.cosine_cosine(fit.covariance[3]);
  message.cosine_offset(fit.covariance[4]);
  message.offset_offset(fit.covariance[5]);
  message.residual_sum_of_squares(fit.rss);
  message.degrees_of_freedom(fit.degrees_of_freedom);
  return message;
}

void read_covariance(const wire::FitCovariance& message, analysis::SineFit& fit) {
  fit.covariance = {message.sine_sine(),     message.sine_cosine(),   message.sine_offset(),
                    message.cosine_cosine(), message.cosine_offset(), message.offset_offset()};
  fit.rss = message.residual_sum_of_squares();
  fit.degrees_of_freedom = message.degrees_of_freedom();
}

// What a writer of an older contract sends: no covariances between the coefficients.
analysis::ChannelFit fit_from_message(const wire::SineFit& message) {
  const auto square = [](double u) { return u * u; };
  const double samples = static_cast<double>(std::max<std::uint64_t>(message.sample_count(), 1));
  analysis::ChannelFit fit{.channel = message.channel(),
                           .frequency = analysis::Frequency::from_hz(message.frequency_hz()),
                           .u_frequency_hz = message.u_frequency_hz(),
                           .phase_origin_ns = message.phase_origin_ns(),
                           .fit = {}};
  fit.fit.sine = message.sine();
  fit.fit.cosine = message.cosine();
  fit.fit.offset = message.offset();
  fit.fit.covariance = {square(message.u_sine()),   0.0, 0.0,
                        square(message.u_cosine()), 0.0, square(message.u_offset())};
  fit.fit.rss = square(message.residual_rms()) * samples;
  fit.fit.samples = message.sample_count();
  return fit;
}

wire::SourceSamples samples_message(const SourceSamples& samples) {
  wire::SourceSamples message;
  message.source(samples.source);
  message.used(samples.used);
  message.lost(samples.lost);
  message.unusable(samples.unusable);
  message.overflowed(samples.overflowed);
  message.not_trusted(samples.not_trusted);
  message.not_measured(samples.not_measured);
  message.first_stamp_ns(samples.first_stamp_ns);
  message.last_stamp_ns(samples.last_stamp_ns);
  return message;
}

wire::SignalQuality signal_message(const ChannelSignal& signal) {
  wire::SignalQuality message;
  message.channel(signal.channel);
  message.thd(signal.thd);
  message.u_thd(signal.u_thd);
  message.residual_rel(signal.residual);
  message.residual_over_noise(signal.over_noise);
  return message;
}

wire::MonteCarloCheck check_message(const analysis::TransferCheck& drawn) {
  wire::MonteCarloCheck message;
  message.trials(drawn.magnitude.trials);
  message.stable(drawn.magnitude.stable && drawn.phase_rad.stable);
  message.u_magnitude(drawn.magnitude.u);
  message.magnitude_low(drawn.magnitude.low);
  message.magnitude_high(drawn.magnitude.high);
  message.u_phase_rad(drawn.phase_rad.u);
  message.phase_low_rad(drawn.phase_rad.low);
  message.phase_high_rad(drawn.phase_rad.high);
  return message;
}

analysis::TransferCheck check_from_message(const wire::MonteCarloCheck& message) {
  const auto trials = static_cast<std::size_t>(message.trials());
  analysis::TransferCheck drawn;
  drawn.magnitude = {.u = message.u_magnitude(),
                     .low = message.magnitude_low(),
                     .high = message.magnitude_high(),
                     .trials = trials,
                     .stable = message.stable()};
  drawn.phase_rad = {.u = message.u_phase_rad(),
                     .low = message.phase_low_rad(),
                     .high = message.phase_high_rad(),
                     .trials = trials,
                     .stable = message.stable()};
  return drawn;
}

void write_value(const StepResult& result, wire::CalibrationResult& message) {
  message.valid(result.valid);
  message.problem(result.problem);
  message.magnitude(result.magnitude);
  message.u_magnitude(result.u_magnitude);
  message.phase_rad(result.phase_rad);
  message.u_phase_rad(result.u_phase_rad);
  message.unit(result.unit);
  if (result.series) {
    message.sample_rate_hz(result.series->sample_rate_hz);
    message.u_sample_rate_hz(result.series->u_sample_rate_hz);
    message.series_start(result.series->start);
    message.series_start_scatter_s(result.series->start_scatter_s);
  }
}

} // namespace

wire::CalibrationResult to_message(const Recipe& recipe, const StepResult& result) {
  wire::CalibrationResult message;
  message.bench(recipe.bench);
  message.run(recipe.run);
  message.channel(result.channel);
  message.step(result.step);
  message.repetition(result.repetition);
  message.frequency_text_hz(result.frequency_text_hz);
  message.frequency_hz(result.frequency_hz);
  message.level_m_s2(result.level_m_s2);
  write_value(result, message);
  for (const analysis::ChannelFit& fit : result.fits) {
    message.fits().push_back(fit_message(fit));
    message.fit_covariances().push_back(covariance_message(fit.fit));
  }
  for (const analysis::Contribution& row : result.budget) {
    message.budget().push_back(to_message(row));
  }
  for (const SourceSamples& samples : result.samples) {
    message.samples().push_back(samples_message(samples));
  }
  message.lost(result.lost);
  message.flags() = sentences_of(result.flags);
  message.flag_names() = names_of(result.flags);
  message.temperature_valid(result.temperature_degc.has_value());
  message.temperature_degc(result.temperature_degc.value_or(0.0));
  message.provisional(result.provisional);
  message.attempt(result.attempt);
  for (const ChannelSignal& signal : result.signals) {
    message.signals().push_back(signal_message(signal));
  }
  message.software(software_version());
  message.recipe_sha256(recipe.sha256);
  message.data_sha256(result.data_sha256);
  if (result.monte_carlo) {
    message.monte_carlo().push_back(check_message(*result.monte_carlo));
  }
  return message;
}

StepResult from_message(const wire::CalibrationResult& message) {
  StepResult result;
  result.channel = message.channel().to_string();
  result.step = message.step();
  result.repetition = message.repetition();
  result.frequency_text_hz = message.frequency_text_hz();
  result.frequency_hz = message.frequency_hz();
  result.level_m_s2 = message.level_m_s2();
  result.valid = message.valid();
  result.problem = message.problem();
  result.magnitude = message.magnitude();
  result.u_magnitude = message.u_magnitude();
  result.phase_rad = message.phase_rad();
  result.u_phase_rad = message.u_phase_rad();
  result.unit = message.unit();
  for (std::size_t i = 0; i < message.fits().size(); ++i) {
    const wire::SineFit& fit = message.fits()[i];
    if (std::isfinite(fit.frequency_hz()) && fit.frequency_hz() > 0.0) {
      result.fits.push_back(fit_from_message(fit));
      if (i < message.fit_covariances().size()) {
        read_covariance(message.fit_covariances()[i], result.fits.back().fit);
      }
    }
  }
  for (const wire::BudgetContribution& row : message.budget()) {
    result.budget.push_back(from_message(row));
  }
  for (const wire::SourceSamples& samples : message.samples()) {
    result.samples.push_back({samples.source(), samples.used(), samples.lost(), samples.unusable(),
                              samples.overflowed(), samples.not_trusted(), samples.not_measured(),
                              samples.first_stamp_ns(), samples.last_stamp_ns()});
  }
  result.lost = message.lost();
  result.flags = flags_from_message(message.flags(), message.flag_names());
  if (message.temperature_valid()) {
    result.temperature_degc = message.temperature_degc();
  }
  result.data_sha256 = message.data_sha256();
  result.provisional = message.provisional();
  result.attempt = std::max(message.attempt(), 1U);
  for (const wire::SignalQuality& signal : message.signals()) {
    result.signals.push_back({signal.channel(), signal.thd(), signal.u_thd(), signal.residual_rel(),
                              signal.residual_over_noise()});
  }
  if (!message.series_start().empty()) {
    result.series = SeriesFinding{message.sample_rate_hz(), message.u_sample_rate_hz(),
                                  message.series_start(), message.series_start_scatter_s()};
  }
  if (!message.monte_carlo().empty()) {
    result.monte_carlo = check_from_message(message.monte_carlo().front());
  }
  return result;
}

} // namespace dyncal::inline evaluation
