#include "services/views/model/model_table.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/printable_text.hpp"
#include "services/base/rounding.hpp"
#include "services/contract/unit.hpp"

namespace dyncal::inline views {
namespace {

constexpr double degrees_per_radian = 180.0 / std::numbers::pi;
constexpr std::size_t line_width = 88;

std::string probability_column(double probability) {
  return probability < 1e-15  ? "< 1e-15"
         : probability < 1e-4 ? fmt::format("{:.0e}", probability)
                              : fmt::format("{:.4f}", probability);
}

std::string head(const ChannelModel& model) {
  const MeasuredResponse& measured = model.measured;
  double low = measured.values.front().point.frequency_hz, high = low;
  for (const MeasuredValue& value : measured.values) {
    low = std::min(low, value.point.frequency_hz);
    high = std::max(high, value.point.frequency_hz);
  }
  std::string text = fmt::format("{}: {} values from {:g} to {:g} Hz\n", one_line(measured.channel),
                                 measured.values.size(), low, high);
  std::map<std::string, std::vector<std::string>> by_reason;
  for (const ValueLeftOut& value : measured.left_out) {
    by_reason[one_line(value.reason)].push_back(one_line(value.frequency_text_hz, 32));
  }
  for (const auto& [reason, frequencies] : by_reason) {
    text += fmt::format("  left out, {}: {} Hz\n", reason, fmt::join(frequencies, ", "));
  }
  return text;
}

std::string candidates(const analysis::ResponseChoice& choice) {
  std::string text = fmt::format("  {:<34} {:>10} {:>4} {:>8} {:>9} {:>9}\n", "model", "chi2", "nu",
                                 "P", "AIC", "BIC");
  bool open = false;
  for (std::size_t i = 0; i < choice.candidates.size(); ++i) {
    const analysis::ResponseCandidate& one = choice.candidates[i];
    const char mark = i == choice.chosen ? '>' : ' ';
    if (!one.fit) {
      text += fmt::format("{} {:<34} {}\n", mark, to_string(one.kind), one.problem);
      continue;
    }
    text += fmt::format("{} {:<34} {:>10.5g} {:>4} {:>8} {:>9.5g} {:>9.5g}{}\n", mark,
                        to_string(one.kind), one.fit->chi_squared, one.fit->degrees_of_freedom,
                        probability_column(one.probability), one.aic, one.bic,
                        one.fit->undetermined.empty() ? "" : "  *");
    open = open || !one.fit->undetermined.empty();
  }
  if (open) {
    text += "  * the values do not determine all of its parameters\n";
  }
  return text;
}

struct Shown {
  std::string name;
  double factor;
};

Shown shown(const std::string& parameter, const std::string& unit) {
  if (parameter == "gain") {
    const std::string short_unit = short_form(unit);
    return {short_unit.empty() || short_unit == "1" ? "gain" : "gain / (" + short_unit + ")", 1.0};
  }
  if (parameter == "delay_s") {
    return {"delay / ms", 1e3};
  }
  if (parameter == "corner_hz") {
    return {"corner frequency fc / Hz", 1.0};
  }
  return {parameter == "damping" ? "damping zeta" : "resonance frequency f0 / Hz", 1.0};
}

std::string parameters(const ChannelModel& model) {
  const analysis::FittedResponse& fit = model.fit();
  std::string text = fmt::format("  {:<30} {:>14} {:>10} {:>6}\n", "parameter", "value", "U", "k");
  for (std::size_t k = 0; k < fit.names.size(); ++k) {
    const Shown name = shown(fit.names[k], model.measured.unit);
    const analysis::CombinedUncertainty& of_value = fit.of_values[k];
    const RoundedValue rounded =
        round_by_uncertainty(fit.values[k] * name.factor, of_value.expanded() * name.factor);
    text += fmt::format("  {:<30} {:>14} {:>10} {:>6.2f}\n", one_line(name.name, 64), rounded.value,
                        rounded.u, of_value.k);
  }
  return text;
}

std::string filter_text(const ChannelModel& model) {
  const analysis::CompensationFilter& filter = *model.filter;
  std::string text =
      fmt::format("\n  {} filter of {} taps{} at {:.6g} Hz: passes to {:g} Hz{}\n",
                  filter.a.size() == 1 ? "FIR" : "IIR", filter.b.size(),
                  filter.a.size() == 1 ? "" : fmt::format(" and {} poles", filter.a.size() - 1),
                  filter.rate_hz, filter.cutoff_hz,
                  filter.stop_hz < 0.5 * filter.rate_hz
                      ? fmt::format(", stops from {:g} Hz by {:.0f} dB", filter.stop_hz,
                                    -20.0 * std::log10(filter.stop_gain))
                      : "");
  text += fmt::format("  output late by {} samples ({:.4g} ms), ripple {:.1e}, noise of the sensor "
                      "times {:.2g}\n",
                      filter.delay_samples, 1e3 * filter.delay_samples / filter.rate_hz,
                      filter.ripple, filter.noise_gain);
  text += fmt::format("  {:>10} {:>12} {:>9} {:>14} {:>9}   error of the compensated response\n",
                      "f / Hz", "|C H| - 1", "U", "arg / deg", "U");
  for (const analysis::CompensatedPoint& point : model.compensated) {
    if (point.frequency_hz > filter.cutoff_hz) {
      continue;
    }
    const RoundedValue magnitude =
        round_by_uncertainty(point.measured_magnitude_error, 2.0 * point.u_magnitude);
    const RoundedValue phase =
        round_by_uncertainty(point.measured_phase_error_rad * degrees_per_radian,
                             2.0 * point.u_phase_rad * degrees_per_radian);
    text += fmt::format("  {:>10g} {:>12} {:>9} {:>14} {:>9}\n", point.frequency_hz,
                        magnitude.value, magnitude.u, phase.value, phase.u);
  }
  return text;
}

// Broken at spaces, later lines further in.
std::string wrapped(const std::string& text, const std::string& first, const std::string& later) {
  std::string result;
  std::string line = first;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (line.size() + 1 + word.size() > line_width && line.size() > later.size()) {
      result += line + '\n';
      line = later;
    }
    line += (line.back() == ' ' ? "" : " ") + word;
    at = end + 1;
  }
  return result + line + '\n';
}

} // namespace

std::string model_text(const ChannelModel& model) {
  std::string text = head(model) + candidates(model.choice);
  const std::string reason = reason_of(model.choice);
  text += '\n' + wrapped(fmt::format("{}{}{}", to_string(model.fit().kind),
                                     reason.empty() ? "" : ": ", reason),
                         "  ", "    ");
  text += parameters(model);
  if (model.filter) {
    text += filter_text(model);
  }
  for (const std::string& warning : model.warnings) {
    text += wrapped(one_line(warning), "  warning: ", "    ");
  }
  return text;
}

} // namespace dyncal::inline views
