// The measured response of each channel, read from result files (result.schema.json) for fitting a
// model: what every value has by itself, and what all have in common.
//
// u of a value is U / 2, so that few repetitions count as little as they should. Its parts come
// from the budgets of its points: what is drawn independently in every repetition, as the mean of
// the repetitions states it, is the value's own; of what repeats, a delay is common to all
// frequencies, the reference has a gain, a delay and a phase in common as far as all frequencies
// have them, and the rest is each value's own (shared_phase_uncertainty.hpp). Files without budgets
// have everything as their own.
//
// Values are left out, each with its reason, when they are null, when their phase or magnitude is
// hardly known, and when a flag says that they may be wrong beyond u; a flag that this version does
// not know counts as such. Several files are joined: a row of the same name is the same error.
//
// Fails (bad_file) with file, key and what to do. Plain functions, any thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/response/response_fit.hpp"
#include "services/base/error.hpp"
#include "services/base/work_count.hpp"

namespace dyncal::inline views {

struct MeasuredValue {
  std::string file;
  std::string frequency_text_hz;
  analysis::ResponsePoint point; // u: its own
  double u_magnitude_rel = 0.0;  // with what is common
  double u_phase_rad = 0.0;
  std::vector<std::string> flag_names;
};

struct ValueLeftOut {
  std::string file;
  std::string frequency_text_hz;
  std::string reason;
};

struct MeasuredResponse {
  std::string channel;
  std::string unit;
  std::vector<MeasuredValue> values;
  std::vector<ValueLeftOut> left_out;
  analysis::CommonResponseUncertainty common;
  bool has_budgets = true;     // false: all of u counts as each value's own
  double sample_rate_hz = 0.0; // of the channel's source, measured; 0: not known

  [[nodiscard]] std::vector<analysis::ResponsePoint> points() const;
};

struct ResponseSelection {
  std::vector<std::string> channels; // empty: all that respond
  bool include_flagged = false;
};

// In the order of the first file, at least one.
[[nodiscard]] Expected<std::vector<MeasuredResponse>>
read_responses(const std::vector<std::filesystem::path>& files, const ResponseSelection& selection,
               const SharedWorkCount& count = nullptr);

// May the value be wrong beyond its u?
[[nodiscard]] bool makes_unusable(const std::string& flag_name);

} // namespace dyncal::inline views
