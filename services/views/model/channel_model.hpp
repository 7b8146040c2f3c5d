// The model of one channel: the order that its values support, and, where it is asked for, the
// filter that undoes it, with all that a reader should be warned of.
//
// Fails (bad_file, bad_argument) in one sentence that names file, channel and option. Plain
// function, any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/response/compensation_filter.hpp"
#include "analysis/response/response_choice.hpp"
#include "services/base/error.hpp"
#include "services/views/model/measured_response.hpp"

namespace dyncal::inline views {

struct FilterRequest {
  bool iir = false;
  double rate_hz = 0.0;   // 0: the measured rate of the channel's source
  double cutoff_hz = 0.0; // 0: the highest fitted frequency
  int taps = 0;           // 0: by the width between pass and stop band
  std::optional<int> delay_samples{};
};

struct ModelRequest {
  std::optional<analysis::ResponseKind> kind{}; // empty: by the values
  std::optional<FilterRequest> filter{};
};

struct ChannelModel {
  MeasuredResponse measured;
  analysis::ResponseChoice choice;
  std::optional<analysis::CompensationFilter> filter;
  std::vector<analysis::CompensatedPoint> compensated; // of each value
  std::vector<std::string> warnings;

  [[nodiscard]] const analysis::FittedResponse& fit() const { return *choice.best().fit; }
};

[[nodiscard]] Expected<ChannelModel> model_channel(MeasuredResponse measured,
                                                   const ModelRequest& request);

// "P = 0.024"; what is smaller than rounding allows is "P < 1e-15".
[[nodiscard]] std::string probability_text(double probability);

// Why this order: one sentence.
[[nodiscard]] std::string reason_of(const analysis::ResponseChoice& choice);

} // namespace dyncal::inline views
