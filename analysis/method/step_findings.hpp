// What the evaluation of a step found along its record, beside the values: to be said by whoever
// states them. Plain data, any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/method/clock_link.hpp"
#include "analysis/step/short_disturbance.hpp"
#include "analysis/uncertainty/ratio_change.hpp"

namespace dyncal::analysis {

struct PointFindings {
  std::optional<RatioChange> change{}; // of the ratio to the reference, within the step
  bool too_short_for_noise = false;    // slow noise, of which the few periods show too little
};

struct KnockedChannel {
  std::string channel;
  ShortDisturbance knock; // to be cut out
};

struct StepFindings {
  std::vector<PointFindings> points; // in the order of the points
  std::vector<KnockedChannel> knocks;
  std::optional<ClockLink> clock_link{}; // where both clocks have UTC
};

} // namespace dyncal::analysis
