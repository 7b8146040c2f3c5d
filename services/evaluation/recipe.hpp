// The recipe of a run as the evaluation uses it, and its way through the contract's Measurement
// message.
//
// `dyncal run` makes the message from the bench file; the analysis service makes the recipe from
// the message alone, so that it evaluates benches it has never heard of. Plain data; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "analysis/instrument/adc_calibration.hpp"
#include "analysis/method/sample_stamping.hpp"
#include "idl/dyncal.h"
#include "services/contract/channel_name.hpp"
#include "services/error.hpp"

namespace dyncal::services {

struct RecipeStep {
  std::uint32_t step = 0;
  std::uint32_t repetition = 0;
  std::string frequency_text_hz;
  analysis::Frequency frequency;
  double level_m_s2 = 0.0;
  double settling_s = 0.0;
  double duration_s = 0.0;
};

struct Recipe {
  std::string bench;
  std::string run;
  ChannelName reference;
  ChannelName sync_acs;
  wire::Method method = wire::METHOD_SAMPLE_TIMESTAMPING;
  ChannelName sync_dau;         // series time stamping: the oscilloscope's sync
  std::vector<ChannelName> dut; // empty: all channels of the DAU but sync and temperature
  std::optional<ChannelName> temperature;
  std::vector<RecipeStep> steps;
  bool settling_from_data = false;      // RecipeStep::settling_s is the longest that is left out
  std::uint64_t monte_carlo_trials = 0; // 0: no cross-check
  bool whole_record = false;            // one step; nothing is searched, nothing is left out
  double frequency_search_rel = 1e-3;   // 0: the frequency is known exactly in every clock
  double reference_delay_s = 0.0;       // of the reference's channel against the ACS's sync
  std::vector<analysis::AdcCalibrationPoint> adc_calibration; // empty: no correction
  analysis::SystematicUncertainty systematic;
  double dso_delay_s = 0.0; // from the oscilloscope's trigger point to its trigger output
  double u_dso_delay_s = 0.0;
  std::uint32_t shots = 0; // of a step, series time stamping
  bool trigger_phase_correction = true;
  double u_acs_rate_rel = 0.0;
  std::string sha256;

  // The steps are found in the reference itself, or in what the ACS has of sync; nothing else
  // records sync.
  [[nodiscard]] bool without_sync() const {
    return method == wire::METHOD_ABSOLUTE_TIME || method == wire::METHOD_ANALOGUE;
  }
  // The sensors have stamps of their own: everything is on UTC, or sync is recorded beside them.
  [[nodiscard]] bool stamped_apart() const;
  // Whose sample clock is reported on.
  [[nodiscard]] const std::string& sensor_source() const {
    return stamped_apart() ? dut.front().source : sync_dau.source;
  }
  // The sources of the channels under calibration, each once.
  [[nodiscard]] std::vector<std::string> dut_sources() const;
  // The sources whose samples the evaluation needs, each once: the ACS first.
  [[nodiscard]] std::vector<std::string> sources() const;
};

// Fails (bad_argument) with what this version cannot evaluate: another method, a role that is no
// "source/channel", no steps.
[[nodiscard]] Expected<Recipe> parse_recipe(const wire::Measurement& measurement);

} // namespace dyncal::services
