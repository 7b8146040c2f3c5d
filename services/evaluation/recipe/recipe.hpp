// What a run is to measure and how it is evaluated: the plan of its steps, the channels with a
// role, corrections and known uncertainties.
//
// The common part serves every method; what a method alone needs stands in its roles, one of four.
// `dyncal run` and `dyncal analyse` make a recipe from the bench file (services/run/run_plan.hpp),
// the analysis service reads it from the contract's message (recipe_message.hpp), so that it
// evaluates benches it has never heard of. Standard uncertainties begin with u_. Plain data; any
// thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "analysis/instrument/adc_calibration.hpp"
#include "analysis/instrument/reference_calibration.hpp"
#include "analysis/method/sample_stamping.hpp"
#include "services/base/error.hpp"
#include "services/contract/channel_name.hpp"
#include "services/contract/dut_phase.hpp"
#include "services/contract/evaluation_method.hpp"
#include "services/contract/role_rules.hpp"

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

// Sensor and reference are channels of one system.
struct AnalogueRoles {
  ChannelName reference;
  ChannelName excitation; // the steps are found in it: the reference, or sync beside it
  std::vector<ChannelName> dut;
};

// Sensors and reference are stamped in UTC.
struct AbsoluteTimeRoles {
  ChannelName reference;
  ChannelName excitation; // as above
  std::vector<ChannelName> dut;
};

struct SampleStampingRoles {
  ChannelName reference;
  ChannelName sync_acs;
  ChannelName sync_dau;
  std::vector<ChannelName> dut; // empty: all channels of the DAU but sync and temperature
  std::vector<analysis::AdcCalibrationPoint> adc_calibration; // of sync_dau; empty: no correction
  double u_adc_delay_s = 0.0; // of an ADC without calibration; 0: not stated

  // The sensors have stamps of their own, beside the DAU that records sync.
  [[nodiscard]] bool own_clocks() const { return has_own_clocks(dut, sync_dau); }
};

struct SeriesRoles {
  ChannelName reference;
  ChannelName sync_acs;
  ChannelName sync_dso;
  std::vector<ChannelName> dut; // of one sensor
  std::uint32_t shots = 0;      // of a step
  bool trigger_phase_correction = true;
  double dso_delay_s = 0.0; // from the oscilloscope's trigger point to its trigger output
  double u_dso_delay_s = 0.0;
  double u_acs_rate_rel = 0.0; // of the ACS's clock, for sample rates
  double u_dso_rate_rel = 0.0; // of the oscilloscope's clock
};

using Roles = std::variant<SampleStampingRoles, AnalogueRoles, SeriesRoles, AbsoluteTimeRoles>;

// What one method or another has beside channels with a role.
struct MethodDetails {
  std::vector<analysis::AdcCalibrationPoint> adc_calibration;
  std::uint32_t shots = 0;
  bool trigger_phase_correction = true;
  double dso_delay_s = 0.0;
  double u_dso_delay_s = 0.0;
  double u_acs_rate_rel = 0.0;
  double u_dso_rate_rel = 0.0;
  double u_adc_delay_s = 0.0;
};

// Those of the names' method; details that it does not have are dropped. An excitation channel that
// is not named is the reference.
[[nodiscard]] Roles make_roles(RoleNames names, MethodDetails details);

struct Recipe {
  std::string bench;
  std::string run;
  Roles roles;
  std::optional<ChannelName> temperature;
  std::vector<RecipeStep> steps;
  bool settling_from_data = false;      // RecipeStep::settling_s is the longest that is left out
  std::uint64_t monte_carlo_trials = 0; // 0: no cross-check
  bool whole_record = false;            // one step; nothing is searched, nothing is left out
  double frequency_search_rel = 1e-3;   // 0: the frequency is known exactly in every clock
  // Part by which the measured level of a step may be off the planned one without a flag.
  double level_deviation_rel = 0.1;
  double clock_tolerance_rel = 2e-4; // how right the crystals of ACS and DAU are
  DutPhase dut_phase = DutPhase::delay;
  std::vector<double> mains_hz{analysis::usual_mains_hz.begin(), analysis::usual_mains_hz.end()};
  double reference_delay_s = 0.0; // of the reference's channel against the ACS's sync
  std::vector<analysis::ReferenceCalibrationPoint> reference_calibration; // empty: it reads right
  analysis::SystematicUncertainty systematic;
  std::string text; // of the bench file, for those who read the message
  std::string sha256;
  // What the bench file says of each source, by its name; without one it is not known.
  std::map<std::string, std::string> source_settings;

  [[nodiscard]] EvaluationMethod method() const;
  [[nodiscard]] const ChannelName& reference() const;
  [[nodiscard]] const std::vector<ChannelName>& dut() const;
  // All with a role, the reference first.
  [[nodiscard]] std::vector<ChannelName> channels() const;
  // The sources of the channels under calibration, each once.
  [[nodiscard]] std::vector<std::string> dut_sources() const;
  // The sources whose samples the evaluation needs, each once: the ACS first.
  [[nodiscard]] std::vector<std::string> sources() const;
};

// The roles as the rules of services/contract/role_rules.hpp look at them.
[[nodiscard]] RoleNames role_names(const Recipe& recipe);

// Fails (bad_argument) with what this version cannot evaluate: roles that the method does not
// allow, no steps, settings that the method does not have, steps at which the reference was not
// calibrated.
[[nodiscard]] Expected<void> check_recipe(const Recipe& recipe);

} // namespace dyncal::inline evaluation
