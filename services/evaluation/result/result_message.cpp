#include "services/evaluation/result/result_messages.hpp"

#include <algorithm>
#include <cmath>

#include "services/base/version.hpp"
#include "services/contract/message_members.hpp"
#include "services/evaluation/result/flag_message.hpp"

namespace dyncal::inline evaluation {

void message_members(auto& visit, Either<analysis::ChannelFit> auto& fit, auto& message) {
  visit(fit.channel, message.channel());
  visit(fit.u_frequency_hz, message.u_frequency_hz());
  visit(fit.phase_origin_ns, message.phase_origin_ns());
  visit(fit.fit.sine, message.sine());
  visit(fit.fit.cosine, message.cosine());
  visit(fit.fit.offset, message.offset());
  visit(fit.fit.samples, message.sample_count());
}

void message_members(auto& visit, Either<analysis::SineFit> auto& fit, auto& message) {
  visit(fit.covariance[0], message.sine_sine());
  visit(fit.covariance[1], message.sine_cosine());
  visit(fit.covariance[2], message.sine_offset());
  visit(fit.covariance[3], message.cosine_cosine());
  visit(fit.covariance[4], message.cosine_offset());
  visit(fit.covariance[5], message.offset_offset());
  visit(fit.rss, message.residual_sum_of_squares());
  visit(fit.degrees_of_freedom, message.degrees_of_freedom());
}

void message_members(auto& visit, Either<SourceSamples> auto& samples, auto& message) {
  visit(samples.source, message.source());
  visit(samples.used, message.used());
  visit(samples.lost, message.lost());
  visit(samples.unusable, message.unusable());
  visit(samples.overflowed, message.overflowed());
  visit(samples.not_trusted, message.not_trusted());
  visit(samples.not_measured, message.not_measured());
  visit(samples.first_stamp_ns, message.first_stamp_ns());
  visit(samples.last_stamp_ns, message.last_stamp_ns());
}

void message_members(auto& visit, Either<ChannelSignal> auto& signal, auto& message) {
  visit(signal.channel, message.channel());
  visit(signal.thd, message.thd());
  visit(signal.u_thd, message.u_thd());
  visit(signal.residual, message.residual_rel());
  visit(signal.over_noise, message.residual_over_noise());
}

void message_members(auto& visit, Either<analysis::TransferCheck> auto& drawn, auto& message) {
  visit(drawn.magnitude.trials, message.trials());
  visit(drawn.magnitude.stable, message.stable());
  visit(drawn.magnitude.u, message.u_magnitude());
  visit(drawn.magnitude.low, message.magnitude_low());
  visit(drawn.magnitude.high, message.magnitude_high());
  visit(drawn.phase_rad.u, message.u_phase_rad());
  visit(drawn.phase_rad.low, message.phase_low_rad());
  visit(drawn.phase_rad.high, message.phase_high_rad());
}

void message_members(auto& visit, Either<SeriesFinding> auto& series, auto& message) {
  visit(series.sample_rate_hz, message.sample_rate_hz());
  visit(series.u_sample_rate_hz, message.u_sample_rate_hz());
  visit(series.start, message.series_start());
  visit(series.start_scatter_s, message.series_start_scatter_s());
}

void message_members(auto& visit, Either<StepResult> auto& result, auto& message) {
  visit(result.channel, message.channel());
  visit(result.step, message.step());
  visit(result.repetition, message.repetition());
  visit(result.attempt, message.attempt());
  visit(result.frequency_text_hz, message.frequency_text_hz());
  visit(result.frequency_hz, message.frequency_hz());
  visit(result.level_m_s2, message.level_m_s2());
  visit(result.excited_axis, message.excited_axis());
  visit(result.valid, message.valid());
  visit(result.problem, message.problem());
  visit(result.magnitude, message.magnitude());
  visit(result.u_magnitude, message.u_magnitude());
  visit(result.phase_rad, message.phase_rad());
  visit(result.u_phase_rad, message.u_phase_rad());
  visit(result.unit, message.unit());
  visit(result.signals, message.signals());
  visit(result.samples, message.samples());
  visit(result.lost, message.lost());
  message_flags(visit, result.flags, message);
  visit(result.data_sha256, message.data_sha256());
  visit(result.provisional, message.provisional());
  if (auto* degc = visit.present(result.temperature_degc, message.temperature_valid())) {
    visit(*degc, message.temperature_degc());
  }
}

namespace {

wire::SineFit fit_message(const analysis::ChannelFit& fit) {
  wire::SineFit message;
  MessageWriter writer;
  message_members(writer, fit, message);
  message.frequency_hz(fit.frequency.hz());
  message.u_sine(std::sqrt(fit.fit.covariance[0]));
  message.u_cosine(std::sqrt(fit.fit.covariance[3]));
  message.u_offset(std::sqrt(fit.fit.covariance[5]));
  message.residual_rms(
      std::sqrt(fit.fit.rss / static_cast<double>(std::max<std::uint64_t>(fit.fit.samples, 1))));
  return message;
}

// What a writer of an older contract sends: no covariances between the coefficients.
analysis::ChannelFit fit_from_message(const wire::SineFit& message) {
  const auto square = [](double u) { return u * u; };
  const double samples = static_cast<double>(std::max<std::uint64_t>(message.sample_count(), 1));
  analysis::ChannelFit fit{
      .channel = {}, .frequency = analysis::Frequency::from_hz(message.frequency_hz()), .fit = {}};
  MessageReader reader;
  message_members(reader, fit, message);
  fit.fit.covariance = {square(message.u_sine()),   0.0, 0.0,
                        square(message.u_cosine()), 0.0, square(message.u_offset())};
  fit.fit.rss = square(message.residual_rms()) * samples;
  return fit;
}

void read_fits(const wire::CalibrationResult& message, StepResult& result) {
  MessageReader reader;
  for (std::size_t i = 0; i < message.fits().size(); ++i) {
    const wire::SineFit& fit = message.fits()[i];
    if (std::isfinite(fit.frequency_hz()) && fit.frequency_hz() > 0.0) {
      result.fits.push_back(fit_from_message(fit));
      if (i < message.fit_covariances().size()) {
        message_members(reader, result.fits.back().fit, message.fit_covariances()[i]);
      }
    }
  }
}

} // namespace

wire::CalibrationResult to_message(const Recipe& recipe, const StepResult& result) {
  wire::CalibrationResult message;
  MessageWriter writer;
  message_members(writer, result, message);
  message.bench(recipe.bench);
  message.run(recipe.run);
  message.software(software_version());
  message.recipe_sha256(recipe.sha256);
  for (const analysis::ChannelFit& fit : result.fits) {
    message.fits().push_back(fit_message(fit));
    message_members(writer, fit.fit, message.fit_covariances().emplace_back());
  }
  for (const analysis::Contribution& row : result.budget) {
    message.budget().push_back(to_message(row));
  }
  if (std::any_of(result.samples.begin(), result.samples.end(),
                  [](const SourceSamples& one) { return one.cut_out > 0; })) {
    for (const SourceSamples& one : result.samples) {
      message.cut_out().push_back(one.cut_out);
    }
  }
  if (result.series) {
    message_members(writer, *result.series, message);
  }
  if (result.monte_carlo) {
    wire::MonteCarloCheck& drawn = message.monte_carlo().emplace_back();
    message_members(writer, *result.monte_carlo, drawn);
    drawn.stable(drawn.stable() && result.monte_carlo->phase_rad.stable);
  }
  return message;
}

StepResult from_message(const wire::CalibrationResult& message) {
  StepResult result;
  MessageReader reader;
  message_members(reader, result, message);
  result.attempt = std::max(result.attempt, 1U);
  read_fits(message, result);
  for (std::size_t i = 0; i < std::min(result.samples.size(), message.cut_out().size()); ++i) {
    result.samples[i].cut_out = message.cut_out()[i];
  }
  for (const wire::BudgetContribution& row : message.budget()) {
    result.budget.push_back(from_message(row));
  }
  if (!message.series_start().empty()) {
    message_members(reader, result.series.emplace(), message);
  }
  if (!message.monte_carlo().empty()) {
    analysis::TransferCheck& drawn = result.monte_carlo.emplace();
    message_members(reader, drawn, message.monte_carlo().front());
    drawn.phase_rad.trials = drawn.magnitude.trials;
    drawn.phase_rad.stable = drawn.magnitude.stable;
  }
  return result;
}

} // namespace dyncal::inline evaluation
