#include "services/views/report/run_setup_json.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/instrument/adc_calibration.hpp"
#include "services/evaluation/recipe/reference_correction.hpp"
#include "services/views/report/json_number.hpp"

namespace dyncal::services {
namespace {

using Json = nlohmann::ordered_json;

constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

const char* time_base_text(drivers::TimeBase base) {
  return base == drivers::TimeBase::utc ? "utc" : "local";
}

const char* stamp_instant_text(drivers::StampInstant instant) {
  switch (instant) {
  case drivers::StampInstant::data_ready_edge:
    return "data_ready_edge";
  case drivers::StampInstant::conversion:
    return "conversion";
  case drivers::StampInstant::trigger_edge:
    return "trigger_edge";
  case drivers::StampInstant::frame_start:
    return "frame_start";
  case drivers::StampInstant::frame_end:
    return "frame_end";
  case drivers::StampInstant::unknown:
    break;
  }
  return "unknown";
}

Json text_or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

// In descriptions 0 stands for what is not known.
Json known_or_null(double value) {
  return value == 0.0 ? Json(nullptr) : json_number(value);
}

Json channel_json(const drivers::ChannelDescription& channel) {
  const bool has_range = channel.minimum != channel.maximum;
  return {{"name", channel.name},
          {"quantity", text_or_null(channel.quantity)},
          {"unit", text_or_null(channel.unit)},
          {"minimum", has_range ? json_number(channel.minimum) : Json(nullptr)},
          {"maximum", has_range ? json_number(channel.maximum) : Json(nullptr)},
          {"resolution", known_or_null(channel.resolution)}};
}

Json source_json(const RunSource& source) {
  const drivers::SourceDescription& description = source.description;
  Json channels = Json::array();
  for (const drivers::ChannelDescription& channel : description.channels) {
    channels.push_back(channel_json(channel));
  }
  return {{"source", source.source},
          {"kind", to_string(source.kind)},
          {"device", text_or_null(description.device)},
          {"serial", text_or_null(description.serial)},
          {"firmware", text_or_null(description.firmware)},
          {"driver", text_or_null(description.driver)},
          {"software", text_or_null(source.software)},
          {"nominal_rate_hz", known_or_null(description.nominal_rate_hz)},
          {"time_base", time_base_text(description.time_base)},
          {"stamp_instant", stamp_instant_text(description.stamp_instant)},
          {"tick_s", known_or_null(description.tick_s)},
          {"stamp_uncertainty_s", known_or_null(description.stamp_uncertainty_s)},
          {"channels", std::move(channels)}};
}

Json adc_json(const std::vector<analysis::AdcCalibrationPoint>& points) {
  Json json = Json::array();
  for (const analysis::AdcCalibrationPoint& point : points) {
    json.push_back({{"frequency_hz", json_number(point.frequency_hz)},
                    {"test_amplitude_vpp", json_number(point.test_amplitude_vpp)},
                    {"gain", json_number(point.gain)},
                    {"u_gain", json_number(point.u_gain)},
                    {"phase_lag_rad", json_number(point.phase_lag_rad)},
                    {"u_phase_lag_rad", json_number(point.u_phase_lag_rad)}});
  }
  return json;
}

Json correction_json(const char* name, double phase_rad, double u_phase_rad) {
  return {{"name", name},
          {"phase_rad", json_number(phase_rad)},
          {"phase_deg", json_number(phase_rad * degrees_per_radian)},
          {"u_phase_rad", json_number(u_phase_rad)}};
}

// What the response of the reference does to H, which is multiplied by it.
Json reference_json(const analysis::ReferenceResponse& response) {
  double magnitude2 = 0.0;
  double phase2 = 0.0;
  for (const analysis::ReferenceContribution& one : response.contributions) {
    magnitude2 += one.u_magnitude_rel * one.u_magnitude_rel;
    phase2 += one.u_phase_rad * one.u_phase_rad;
  }
  Json json = correction_json("reference_response", response.phase_rad, std::sqrt(phase2));
  json["magnitude_factor"] = json_number(response.magnitude);
  json["u_magnitude_rel"] = json_number(std::sqrt(magnitude2));
  return json;
}

std::string role_of(const Recipe& recipe, const std::string& channel) {
  const RoleNames names = role_names(recipe);
  if (channel == names.reference.text()) {
    return "reference";
  }
  if (channel == names.sync_acs.text()) {
    return is_without_sync(names.method) ? "excitation" : "sync_acs";
  }
  if (!names.sync_sensor.source.empty() && channel == names.sync_sensor.text()) {
    return names.method == EvaluationMethod::series_timestamping ? "sync_dso" : "sync_dau";
  }
  return "dut";
}

bool is_in_m_s2(const RunOutcome& outcome, const ChannelName& name) {
  for (const RunSource& source : outcome.sources) {
    for (const drivers::ChannelDescription& channel : source.description.channels) {
      if (source.source == name.source && channel.name == name.channel) {
        return channel.unit == R"(\metre\second\tothe{-2})";
      }
    }
  }
  return false;
}

// The first valid result of a step: what its reference and sync show is common to all channels.
const StepResult* result_of(const RunOutcome& outcome, const RecipeStep& step) {
  const auto found =
      std::find_if(outcome.results.begin(), outcome.results.end(), [&](const StepResult& one) {
        return one.valid && one.step == step.step && one.repetition == step.repetition;
      });
  return found == outcome.results.end() ? nullptr : &*found;
}

Json step_json(const RunOutcome& outcome, const RecipeStep& step) {
  Json json{{"step", step.step},
            {"repetition", step.repetition},
            {"frequency_text_hz", step.frequency_text_hz},
            {"frequency_hz", json_number(step.frequency.hz())},
            {"level_m_s2", json_number(step.level_m_s2)},
            {"settling_s", json_number(step.settling_s)},
            {"duration_s", json_number(step.duration_s)},
            {"corrections", applied_corrections_json(*outcome.recipe, step)},
            {"fits", Json::array()}};
  if (const StepResult* result = result_of(outcome, step)) {
    for (const analysis::ChannelFit& fit : result->fits) {
      if (fit.channel != result->channel) {
        json["fits"].push_back(fit_json(outcome, fit));
      }
    }
  }
  return json;
}

} // namespace

nlohmann::ordered_json sources_json(const RunOutcome& outcome) {
  Json json = Json::array();
  for (const RunSource& source : outcome.sources) {
    json.push_back(source_json(source));
  }
  return json;
}

nlohmann::ordered_json roles_json(const Recipe& recipe) {
  const RoleNames names = role_names(recipe);
  Json json{{"reference", names.reference.text()}};
  if (!names.sync_acs.source.empty()) {
    json[is_without_sync(names.method) ? "excitation" : "sync_acs"] = names.sync_acs.text();
  }
  if (!names.sync_sensor.source.empty()) {
    json[role_of(recipe, names.sync_sensor.text())] = names.sync_sensor.text();
  }
  json["dut"] = Json::array();
  for (const ChannelName& channel : names.dut) {
    json["dut"].push_back(channel.text());
  }
  if (recipe.temperature) {
    json["temperature"] = recipe.temperature->text();
  }
  return json;
}

nlohmann::ordered_json corrections_json(const Recipe& recipe,
                                        const std::optional<AdcFile>& adc_file) {
  Json json{{"reference_delay_s", json_number(recipe.reference_delay_s)}};
  if (const auto* stamped = std::get_if<SampleStampingRoles>(&recipe.roles)) {
    json["adc_calibration"] = adc_json(stamped->adc_calibration);
    json["adc_file"] = adc_file ? Json{{"path", adc_file->path},
                                       {"channel", adc_file->channel},
                                       {"sha256", adc_file->sha256}}
                                : Json(nullptr);
  }
  if (const auto* series = std::get_if<SeriesRoles>(&recipe.roles)) {
    json["dso_delay_s"] = json_number(series->dso_delay_s);
    json["u_dso_delay_s"] = json_number(series->u_dso_delay_s);
    json["trigger_phase_correction"] = series->trigger_phase_correction;
  }
  return json;
}

nlohmann::ordered_json applied_corrections_json(const Recipe& recipe, const RecipeStep& step) {
  const double w = step.frequency.angular();
  Json json = Json::array();
  if (!recipe.reference_calibration.empty()) {
    if (const auto response = reference_response(recipe, step)) {
      json.push_back(reference_json(*response));
    }
  }
  if (recipe.reference_delay_s != 0.0) {
    json.push_back(correction_json("reference_delay", -w * recipe.reference_delay_s,
                                   w * recipe.systematic.acs_delay_s));
  }
  if (const auto* stamped = std::get_if<SampleStampingRoles>(&recipe.roles);
      stamped != nullptr && !stamped->adc_calibration.empty()) {
    if (const auto adc = analysis::adc_response_at(stamped->adc_calibration, step.frequency.hz())) {
      json.push_back(correction_json("adc_phase_lag", -adc->phase_lag_rad, adc->u_phase_lag_rad));
    }
  }
  if (const auto* series = std::get_if<SeriesRoles>(&recipe.roles);
      series != nullptr && series->dso_delay_s != 0.0) {
    json.push_back(
        correction_json("dso_delay", -w * series->dso_delay_s, w * series->u_dso_delay_s));
  }
  return json;
}

nlohmann::ordered_json fit_json(const RunOutcome& outcome, const analysis::ChannelFit& fit) {
  const analysis::SineFit& sine = fit.fit;
  Json covariance = Json::array();
  for (const double element : sine.covariance) {
    covariance.push_back(json_number(element));
  }
  const double samples = static_cast<double>(std::max<std::uint64_t>(sine.samples, 1));
  return {{"channel", fit.channel},
          {"role", outcome.recipe ? Json(role_of(*outcome.recipe, fit.channel)) : Json(nullptr)},
          {"frequency_hz", json_number(fit.frequency.hz())},
          {"u_frequency_hz", json_number(fit.u_frequency_hz)},
          {"phase_origin_ns", fit.phase_origin_ns},
          {"sine", json_number(sine.sine)},
          {"cosine", json_number(sine.cosine)},
          {"offset", json_number(sine.offset)},
          {"covariance", std::move(covariance)},
          {"amplitude", json_number(sine.amplitude())},
          {"u_amplitude", json_number(sine.u_amplitude())},
          {"phase_rad", json_number(sine.phase_rad())},
          {"phase_deg", json_number(sine.phase_rad() * degrees_per_radian)},
          {"u_phase_rad", json_number(sine.u_phase_rad())},
          {"residual_rms", json_number(std::sqrt(sine.rss / samples))},
          {"samples", sine.samples}};
}

nlohmann::ordered_json steps_json(const RunOutcome& outcome) {
  Json json = Json::array();
  if (outcome.recipe) {
    for (const RecipeStep& step : outcome.recipe->steps) {
      json.push_back(step_json(outcome, step));
    }
  }
  return json;
}

std::optional<MeasuredExcitation> measured_excitation(const RunOutcome& outcome,
                                                      const StepResult& result) {
  if (!outcome.recipe) {
    return std::nullopt;
  }
  const ChannelName& reference = outcome.recipe->reference();
  const auto fit =
      std::find_if(result.fits.begin(), result.fits.end(), [&](const analysis::ChannelFit& one) {
        return one.channel == reference.text();
      });
  return fit == result.fits.end()
             ? std::nullopt
             : std::optional(MeasuredExcitation{&*fit, is_in_m_s2(outcome, reference)});
}

} // namespace dyncal::services
