#include "services/views/report/stored_setup.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/instrument/adc_calibration.hpp"

namespace dyncal::inline views {
namespace {

std::string role_of(const Recipe& recipe, const std::string& channel) {
  const RoleNames& names = recipe.roles;
  if (channel == names.reference.text()) {
    return "reference";
  }
  if (channel == recipe.excitation().text()) {
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

// What a response does to H, which is multiplied by that of the reference and divided by that of a
// channel under calibration.
StoredCorrection response_correction(std::string name, const analysis::ReferenceResponse& response,
                                     bool is_divisor) {
  double magnitude2 = 0.0;
  double phase2 = 0.0;
  for (const analysis::ReferenceContribution& one : response.contributions) {
    magnitude2 += one.u_magnitude_rel * one.u_magnitude_rel;
    phase2 += one.u_phase_rad * one.u_phase_rad;
  }
  return {std::move(name), is_divisor ? -response.phase_rad : response.phase_rad, std::sqrt(phase2),
          is_divisor ? 1.0 / response.magnitude : response.magnitude, std::sqrt(magnitude2)};
}

} // namespace

StoredRoles stored_roles(const Recipe& recipe) {
  const RoleNames& names = recipe.roles;
  StoredRoles roles;
  roles.reference = names.reference.text();
  (is_without_sync(names.method) ? roles.excitation : roles.sync_acs) = recipe.excitation().text();
  if (!names.sync_sensor.source.empty()) {
    const std::string sync = names.sync_sensor.text();
    (role_of(recipe, sync) == "sync_dso" ? roles.sync_dso : roles.sync_dau) = sync;
  }
  for (const ChannelName& channel : names.dut) {
    roles.dut.push_back(channel.text());
  }
  if (names.temperature) {
    roles.temperature = names.temperature->text();
  }
  return roles;
}

StoredCorrections stored_corrections(const Recipe& recipe, const std::optional<AdcFile>& adc_file) {
  StoredCorrections corrections;
  corrections.reference_delay_s = recipe.reference_delay_s;
  if (!recipe.reference_standard.devices.empty()) {
    corrections.reference_standard = recipe.reference_standard;
  }
  corrections.channel_axes = recipe.channel_axes;
  if (!recipe.transverse_motion.points.empty()) {
    corrections.transverse_motion = recipe.transverse_motion;
  }
  if (recipe.method() == EvaluationMethod::sample_timestamping) {
    corrections.adc_calibration = recipe.adc_calibration;
    corrections.adc_file = adc_file;
  }
  if (recipe.method() == EvaluationMethod::series_timestamping) {
    corrections.dso_delay_s = recipe.series.dso_delay_s;
    corrections.u_dso_delay_s = recipe.series.u_dso_delay_s;
    corrections.trigger_phase_correction = recipe.series.trigger_phase_correction;
  }
  return corrections;
}

std::vector<StoredCorrection> applied_corrections(const Recipe& recipe, const RecipeStep& step) {
  const double w = step.frequency.angular();
  std::vector<StoredCorrection> applied;
  if (!recipe.reference_calibration.empty()) {
    if (const auto response = reference_response(recipe, step)) {
      applied.push_back(response_correction("reference_response", *response, false));
    }
  }
  for (const ChannelResponse& one : recipe.channel_responses) {
    if (const auto response =
            analysis::reference_response_at(one.points, step.frequency.hz(), step.level_m_s2)) {
      applied.push_back(
          response_correction("channel_response " + one.channel.text(), *response, true));
    }
  }
  if (recipe.reference_delay_s != 0.0) {
    applied.push_back({"reference_delay",
                       -w * recipe.reference_delay_s,
                       w * recipe.systematic.acs_delay_s,
                       {},
                       {}});
  }
  const EvaluationMethod method = recipe.method();
  if (method == EvaluationMethod::sample_timestamping && !recipe.adc_calibration.empty()) {
    if (const auto adc = analysis::adc_response_at(recipe.adc_calibration, step.frequency.hz())) {
      applied.push_back({"adc_phase_lag", -adc->phase_lag_rad, adc->u_phase_lag_rad, {}, {}});
    }
  }
  const SeriesSettings& series = recipe.series;
  if (method == EvaluationMethod::series_timestamping && series.dso_delay_s != 0.0) {
    applied.push_back({"dso_delay", -w * series.dso_delay_s, w * series.u_dso_delay_s, {}, {}});
  }
  return applied;
}

StoredFit stored_fit(const RunOutcome& outcome, const analysis::ChannelFit& fit) {
  return {fit, outcome.recipe ? role_of(*outcome.recipe, fit.channel) : std::string()};
}

std::vector<StoredStep> stored_steps(const RunOutcome& outcome) {
  std::vector<StoredStep> steps;
  for (const RecipeStep& step :
       outcome.recipe ? outcome.recipe->steps : std::vector<RecipeStep>()) {
    steps.push_back({step.step,
                     step.repetition,
                     step.frequency_text_hz,
                     step.frequency.hz(),
                     step.level_m_s2,
                     step.settling_s,
                     step.duration_s,
                     applied_corrections(*outcome.recipe, step),
                     {}});
    if (const StepResult* result = result_of(outcome, step)) {
      for (const analysis::ChannelFit& fit : result->fits) {
        if (fit.channel != result->channel) {
          steps.back().fits.push_back(stored_fit(outcome, fit));
        }
      }
    }
  }
  return steps;
}

void add_measured_excitation(const RunOutcome& outcome, StoredPoint& point) {
  if (!outcome.recipe) {
    return;
  }
  const ChannelName& reference = outcome.recipe->reference();
  const auto fit = std::ranges::find(point.fits, reference.text(), &analysis::ChannelFit::channel);
  if (fit == point.fits.end()) {
    return;
  }
  point.measured_frequency_hz = fit->frequency.hz();
  point.u_measured_frequency_hz = fit->u_frequency_hz;
  if (is_in_m_s2(outcome, reference)) {
    point.measured_level_m_s2 = fit->fit.amplitude();
    point.u_measured_level_m_s2 = fit->fit.u_amplitude();
  }
}

} // namespace dyncal::inline views
