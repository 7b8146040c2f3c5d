// The channel of an instrument that records a pulse-per-second output. Plain data.
#pragma once

#include <string>

#include "analysis/clock/sampled_pulses.hpp"

namespace dyncal::drivers::pps {

struct PulseSettings {
  std::string channel;
  analysis::SampledPulses::Edge edge = analysis::SampledPulses::Edge::rising;
  double delay_s = 0.0; // from the second to the pulse at the input: cable, receiver
  double u_delay_s = 0.0;
};

} // namespace dyncal::drivers::pps
