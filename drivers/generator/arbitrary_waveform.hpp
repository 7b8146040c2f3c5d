// One period of an arbitrary waveform as the commands that load it into channel 1 of a generator
// and make it repeat.
//
//   family                        loading
//   Rigol DG800, DG900, DG1000Z   :SOURce1:TRACe:DATA:DAC16 VOLATILE,CON|END,#5<bytes><points>
//   and the virtual bench         in packets, points of 14 bits in two bytes, low byte first;
//                                 0 is -peak, 3FFF peak. Then the rate of the points:
//                                 :SOURce1:FUNCtion:ARB:MODE SRATE,
//                                 :SOURce1:FUNCtion:ARB:SRATe <points per second>,
//                                 :SOURce1:FUNCtion ARB
//
// A packet has 16384 points at most; a period has 8 to 8 000 000. Other families: other words, or
// too few points (DG4000: 16384), which nobody has tried here; they are refused by name. Pure
// functions; any thread.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/error.hpp"

namespace dyncal::drivers::generator {

struct WaveformCommand {
  std::string text;  // as people read it
  std::string block; // that follows it at once; empty: none
};

struct LoadedWaveform {
  double peak_v = 0.0; // amplitude that goes with it
  std::vector<WaveformCommand> commands;
};

// `identity`: the answer to *IDN?. Fails (refused) for an instrument that cannot, and
// (invalid_setting) for samples that are not finite, are all 0, or too few or too many, and for a
// rate that is not positive.
[[nodiscard]] Expected<LoadedWaveform>
load_waveform(std::string_view identity, std::span<const double> samples_v, double rate_hz);

} // namespace dyncal::drivers::generator
