// What a run is to measure and how it is evaluated: the plan of its steps, the channels with a
// role, corrections and known uncertainties.
//
// What a method does not have is empty, or nothing looks at it. `dyncal run` and `dyncal analyse`
// make a recipe from the bench file (services/run/run_plan.hpp), the analysis service reads it from
// the contract's message (recipe_message.hpp), so that it evaluates benches it has never heard of.
// Standard uncertainties begin with u_. Plain data; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/instrument/adc_calibration.hpp"
#include "analysis/instrument/reference_calibration.hpp"
#include "analysis/method/sample_stamping.hpp"
#include "services/base/error.hpp"
#include "services/contract/channel_axis.hpp"
#include "services/contract/channel_name.hpp"
#include "services/contract/channel_response.hpp"
#include "services/contract/dut_phase.hpp"
#include "services/contract/evaluation_method.hpp"
#include "services/contract/reference_standard.hpp"
#include "services/contract/role_rules.hpp"
#include "services/contract/transverse_motion.hpp"

namespace dyncal::inline evaluation {

struct RecipeStep {
  std::uint32_t step = 0;
  std::uint32_t repetition = 0;
  std::string frequency_text_hz;
  analysis::Frequency frequency;
  double level_m_s2 = 0.0;
  std::string excited_axis{}; // "x", "y", "z" or another name; empty: not stated
  double settling_s = 0.0;
  double duration_s = 0.0;
};

// What series time stamping has beside its channels.
struct SeriesSettings {
  std::uint32_t shots = 0; // of a step
  bool trigger_phase_correction = true;
  double dso_delay_s = 0.0; // from the oscilloscope's trigger point to its trigger output
  double u_dso_delay_s = 0.0;
  double u_acs_rate_rel = 0.0; // of the ACS's clock, for sample rates
  double u_dso_rate_rel = 0.0; // of the oscilloscope's clock
};

struct Recipe {
  std::string bench;
  std::string run;
  RoleNames roles; // no channels under calibration: all of the DAU but sync and temperature
  // Of the ADC that records sync in sample time stamping.
  std::vector<analysis::AdcCalibrationPoint> adc_calibration; // empty: no correction
  double u_adc_delay_s = 0.0;                                 // without calibration; 0: not stated
  SeriesSettings series;
  std::vector<RecipeStep> steps;
  bool settling_from_data = false;      // RecipeStep::settling_s is the longest that is left out
  std::uint64_t monte_carlo_trials = 0; // 0: no cross-check
  bool whole_record = false;            // one step; nothing is searched, nothing is left out
  // Of a multi-sine's waveform, of which the steps of a repetition are the lines; 0: one step is
  // excited after the other.
  double multisine_period_s = 0.0;
  double frequency_search_rel = 1e-3; // 0: the frequency is known exactly in every clock
  // Part by which the measured level of a step may be off the planned one without a flag.
  double level_deviation_rel = 0.1;
  double clock_tolerance_rel = 2e-4; // how right the crystals of ACS and DAU are
  DutPhase dut_phase = DutPhase::delay;
  std::vector<double> mains_hz{analysis::usual_mains_hz.begin(), analysis::usual_mains_hz.end()};
  double reference_delay_s = 0.0; // of the reference's channel against the ACS's sync
  std::vector<analysis::ReferenceCalibrationPoint> reference_calibration; // empty: it reads right
  std::vector<ChannelResponse> channel_responses; // of channels under calibration, taken from H
  ReferenceStandard reference_standard;           // of documents; without devices: not stated
  std::vector<ChannelAxis> channel_axes;          // of channels whose names do not say it
  TransverseMotion transverse_motion;
  analysis::SystematicUncertainty systematic;
  std::string text; // of the bench file, for those who read the message
  std::string sha256;
  // What the bench file says of each source, by its name; without one it is not known.
  std::map<std::string, std::string> source_settings;
  // The source that hands out evaluated steps in place of samples (contract/reference_step.hpp), of
  // which reference and sync_acs are then names alone; empty: none does.
  std::string reference_table{};

  [[nodiscard]] EvaluationMethod method() const { return roles.method; }
  [[nodiscard]] bool is_multisine() const { return multisine_period_s > 0.0; }
  // Steps that are excited together; they follow one another.
  [[nodiscard]] std::size_t lines_at_once() const;
  [[nodiscard]] std::size_t excitations() const { return steps.size() / lines_at_once(); }
  [[nodiscard]] const ChannelName& reference() const { return roles.reference; }
  [[nodiscard]] const std::vector<ChannelName>& dut() const { return roles.dut; }
  // The channel of the ACS that the steps are found in: sync, or the reference where there is none.
  [[nodiscard]] const ChannelName& excitation() const {
    return roles.sync_acs.source.empty() ? roles.reference : roles.sync_acs;
  }
  // All with a role that have samples, the reference first.
  [[nodiscard]] std::vector<ChannelName> channels() const;
  // The sources of the channels under calibration, each once.
  [[nodiscard]] std::vector<std::string> dut_sources() const;
  // The sources whose samples the evaluation needs, each once: the ACS first.
  [[nodiscard]] std::vector<std::string> sources() const;
};

// Fails (bad_argument) with what this version cannot evaluate: roles that the method does not
// allow, no steps, settings that the method or a multi-sine does not have, lines of one that
// collide, steps at which the reference, or a channel whose response is stated, was not calibrated.
[[nodiscard]] Expected<void> check_recipe(const Recipe& recipe);

// Of the reference at the step's frequency and planned level, by its calibration; without one: 1.
[[nodiscard]] analysis::Expected<analysis::ReferenceResponse>
reference_response(const Recipe& recipe, const RecipeStep& step);
// Of the ADC that records sync at the DAU, at the step's frequency, by its calibration; without
// one: no correction, and the uncertainty of the delay that the recipe states.
[[nodiscard]] analysis::Expected<analysis::AdcResponse> adc_response(const Recipe& recipe,
                                                                     const RecipeStep& step);

} // namespace dyncal::inline evaluation
