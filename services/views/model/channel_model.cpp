#include "services/views/model/channel_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dyncal::inline views {
namespace {

constexpr int iir_poles = 4;
constexpr double significant = 0.01;

std::string files_of(const MeasuredResponse& measured) {
  std::vector<std::string> files;
  const auto add = [&](const std::string& file) {
    if (std::ranges::find(files, file) == files.end()) {
      files.push_back(file);
    }
  };
  for (const MeasuredValue& value : measured.values) {
    add(value.file);
  }
  for (const ValueLeftOut& value : measured.left_out) {
    add(value.file);
  }
  return fmt::format("{}", fmt::join(files, ", "));
}

Expected<void> check_values(const MeasuredResponse& measured) {
  if (!measured.values.empty()) {
    return {};
  }
  if (measured.left_out.empty()) {
    return fail(ErrorCode::bad_file, fmt::format("{} has no values", measured.channel));
  }
  const ValueLeftOut& first = measured.left_out.front();
  return fail(ErrorCode::bad_file,
              fmt::format("{}: no value of {} can be used: at {} Hz {}; --include-flagged keeps "
                          "values with flags",
                          files_of(measured), measured.channel, first.frequency_text_hz,
                          first.reason));
}

std::string parameters_of(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, " and "));
}

void warn_of_fit(const ModelRequest& request, ChannelModel& model) {
  const analysis::ResponseCandidate& best = model.choice.best();
  if (!model.choice.fits) {
    model.warnings.push_back(fmt::format(
        "{} fits: chi-squared {:.4g} is too large for {} degrees of freedom ({}), and u of the "
        "parameters does not hold what the model leaves; look at the residuals for single values "
        "or a further resonance",
        request.kind ? "this model does not" : "no model", best.fit->chi_squared,
        best.fit->degrees_of_freedom, probability_text(best.probability)));
    if (request.kind) {
      std::string& text = model.warnings.back();
      text.replace(text.find(" fits:"), 6, " fit:");
    }
  }
  if (!best.fit->undetermined.empty()) {
    model.warnings.push_back(
        fmt::format("the values do not determine {}: its u is more than half of it; take a simpler "
                    "model, or measure nearer to the corner",
                    parameters_of(best.fit->undetermined)));
  }
  const std::size_t last = best.fit->values.size() - 1;
  if (has_second_order(best.kind) &&
      best.fit->values[last] < -best.fit->of_values[last].expanded()) {
    model.warnings.emplace_back("the damping is below 0 by more than 2 u, which no passive sensor "
                                "has: the model is not the sensor's");
  }
  if (request.kind && model.choice.richer && model.choice.richer->probability < significant) {
    model.warnings.push_back(fmt::format("{} is better by more than chance (chi-squared lower by "
                                         "{:.4g})",
                                         to_string(model.choice.richer->kind),
                                         model.choice.richer->chi_squared_gain));
  }
}

void warn_of_other_delays(ChannelModel& model) {
  const auto& others = model.fit().other_delays;
  if (others.empty()) {
    return;
  }
  const auto nearest = std::ranges::min_element(
      others, [](const auto& a, auto& b) { return std::abs(a.delay_s) < std::abs(b.delay_s); });
  model.warnings.push_back(fmt::format(
      "whole turns of the phase are ambiguous: a delay of {:.6g} ms{} fits about as well "
      "(chi-squared {:+.2g}); measure at frequencies closer together",
      1e3 * nearest->delay_s,
      nearest->polarity_inverted != (model.fit().parameters.gain < 0.0) ? " with the other polarity"
                                                                        : "",
      nearest->chi_squared - model.fit().chi_squared));
}

void warn_of_values(ChannelModel& model) {
  constexpr std::array incomplete{
      "clock_uncertainty_unknown", "trigger_phase_not_corrected",      "answers_before_excitation",
      "adc_not_calibrated",        "reference_uncertainty_not_stated", "trigger_delay_not_stated",
      "acs_delay_not_stated"};
  std::set<std::string> missing, kept;
  for (const MeasuredValue& value : model.measured.values) {
    for (const std::string& flag : value.flag_names) {
      if (std::ranges::find(incomplete, flag) != incomplete.end()) {
        missing.insert(flag);
      } else if (makes_unusable(flag)) {
        kept.insert(flag);
      }
    }
  }
  if (!missing.empty()) {
    model.warnings.push_back(fmt::format("u does not hold everything: the values have the flag {}",
                                         fmt::join(missing, ", ")));
  }
  if (!kept.empty()) {
    model.warnings.push_back(
        fmt::format("values that may be wrong beyond their u are included: their flags are {}",
                    fmt::join(kept, ", ")));
  }
  if (!model.measured.has_budgets) {
    model.warnings.emplace_back(
        "the file states no budgets: all of u counts as each value's own, and u of gain and delay "
        "is too small where values share errors");
  }
}

// Where the measured response does not come out as 1 within U of filter and value.
void warn_of_filter_error(ChannelModel& model) {
  const auto beyond = [&](std::size_t i) {
    const analysis::CompensatedPoint& point = model.compensated[i];
    const analysis::ResponsePoint& value = model.measured.values[i].point;
    return point.frequency_hz <= model.filter->cutoff_hz &&
           (std::abs(point.measured_magnitude_error) >
                3.0 * std::hypot(point.u_magnitude, value.u_magnitude_rel) ||
            std::abs(point.measured_phase_error_rad) >
                3.0 * std::hypot(point.u_phase_rad, value.u_phase_rad));
  };
  std::size_t count = 0;
  for (std::size_t i = 0; i < model.compensated.size(); ++i) {
    count += beyond(i) ? 1 : 0;
  }
  if (count > 0) {
    model.warnings.push_back(fmt::format(
        "the compensated response differs from 1 by more than 3 u at {} of {} frequencies: u of "
        "the coefficients does not hold that",
        count, model.compensated.size()));
  }
}

Expected<void> add_filter(const FilterRequest& request, ChannelModel& model) {
  analysis::CompensationSettings settings;
  settings.rate_hz = request.rate_hz > 0.0 ? request.rate_hz : model.measured.sample_rate_hz;
  if (!(settings.rate_hz > 0.0)) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: the sample rate of {} is not in the file; state --rate-hz",
                            files_of(model.measured), model.measured.channel));
  }
  const std::vector<analysis::ResponsePoint> points = model.measured.points();
  double highest = 0.0;
  for (const analysis::ResponsePoint& point : points) {
    highest = std::max(highest, point.frequency_hz);
  }
  settings.cutoff_hz = request.cutoff_hz > 0.0 ? request.cutoff_hz : highest;
  settings.poles = request.iir ? iir_poles : 0;
  settings.taps = request.taps;
  settings.delay_samples = request.delay_samples;
  auto filter = analysis::design_compensation(model.fit(), settings);
  if (!filter) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: {} (rate {:g} Hz, --cutoff-hz {:g})", model.measured.channel,
                            filter.error().message, settings.rate_hz, settings.cutoff_hz));
  }
  model.filter = std::move(*filter);
  model.compensated = analysis::compensate(*model.filter, model.fit(), points);
  warn_of_filter_error(model);
  if (settings.cutoff_hz > highest * (1.0 + 1e-9)) {
    model.warnings.push_back(fmt::format(
        "from {:g} Hz to {:g} Hz the filter relies on the model alone: nothing was measured there",
        highest, settings.cutoff_hz));
  }
  return {};
}

// The richer kind may be left for another reason than chance.
std::string left_because(const analysis::ResponseChoice& choice) {
  const auto& fit = choice.candidates[static_cast<std::size_t>(choice.richer->kind)].fit;
  return fit->undetermined.empty()
             ? ""
             : fmt::format(", without determining {}", parameters_of(fit->undetermined));
}

} // namespace

std::string probability_text(double probability) {
  return probability < 1e-15 ? "P < 1e-15" : fmt::format("P = {:.2g}", probability);
}

std::string reason_of(const analysis::ResponseChoice& choice) {
  std::vector<std::string> parts;
  if (choice.simpler) {
    parts.push_back(fmt::format("chi-squared is lower by {:.4g} than of {} ({})",
                                choice.simpler->chi_squared_gain, to_string(choice.simpler->kind),
                                probability_text(choice.simpler->probability)));
  }
  if (choice.richer) {
    parts.push_back(fmt::format("{} lowers it by {:.4g} ({}){}", to_string(choice.richer->kind),
                                choice.richer->chi_squared_gain,
                                probability_text(choice.richer->probability),
                                left_because(choice)));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

Expected<ChannelModel> model_channel(MeasuredResponse measured, const ModelRequest& request) {
  DYNCAL_TRY(check_values(measured));
  auto choice = analysis::choose_response(measured.points(), measured.common, request.kind);
  if (!choice) {
    return fail(ErrorCode::bad_file, fmt::format("{}: {}: {}", files_of(measured), measured.channel,
                                                 choice.error().message));
  }
  ChannelModel model{std::move(measured), std::move(*choice), {}, {}, {}};
  warn_of_fit(request, model);
  warn_of_other_delays(model);
  warn_of_values(model);
  if (request.filter) {
    DYNCAL_TRY(add_filter(*request.filter, model));
  }
  return model;
}

} // namespace dyncal::inline views
