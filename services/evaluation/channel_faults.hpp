// What some steps of a run show to be wrong with a channel, for the steps that cannot show it.
//
// Soft ends (analysis/step/peak_shape.hpp): an end stop that bends the peaks at one acceleration
// bends them at every larger one, also where filters or folding hide it. Where two steps show bent
// peaks, every step of at least 0.97 of the least such acceleration is
// flagged peaks_bent; but not one below an eighth of the sensor's rate if half of the least loss
// that was seen lies 4 u beyond what its own harmonics say.
//
// Samples in turn of two sensors (analysis/sine/alternating_samples.hpp), d_i with u_i of step i:
//
//   q = sum (d_i / u_i)^2       chi-squared with n degrees of freedom where there is but one sensor
//
// values_off_stamps of all steps where q without its largest term (a line of hum is no sensor) is
// met once in 10^4. Where q is met once in 100, a row of kind structure has what may be there: u^2
// is the mean of d_i^2 - u_i^2, weighted with u_i^-4, the same in all repetitions. No limit of q is
// below 2 n, for u_i is an estimate.
//
// Belongs to one thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

class ChannelFaults {
public:
  // In place of what an earlier attempt at the step has shown.
  void add(const StepResult& result);

  // The result with the flags and the budget that the others give it.
  [[nodiscard]] StepResult settled(StepResult result) const;

private:
  using Step = std::pair<std::uint32_t, std::uint32_t>; // with the repetition

  struct Shown {
    std::uint32_t attempt = 1;
    double acceleration = 0.0; // as the reference reads it
    std::string reference;
    std::optional<analysis::BentPeaks> bent{};
    analysis::AlternatingPart alternating{};
  };
  using ShownOfSteps = std::map<Step, Shown>;

  struct EndStop {
    std::size_t steps = 0;
    double acceleration = 0.0; // the least that showed it
    double loss_rel = 0.0;     // the least
  };

  [[nodiscard]] std::optional<EndStop> end_stop(const std::string& bent) const;
  [[nodiscard]] static bool is_excluded(const EndStop& stop, bool is_sensor,
                                        const StepResult& result);
  void settle_peaks(const std::string& bent, bool is_sensor, StepResult& result) const;
  void settle_alternation(StepResult& result) const;

  std::map<std::string, ShownOfSteps> shown_; // by channel under calibration
};

} // namespace dyncal::inline evaluation
