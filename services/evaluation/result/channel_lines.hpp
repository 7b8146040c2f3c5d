// What one channel of a step tells of lines beside its excitation: which it could not tell from it,
// and how large others were that some step of the run cannot tell (analysis/sine/
// unresolved_lines.hpp).
//
// `amplitude` and `duration_s` are of the fitted sine and its record. Lines of the mains are
// measured in the unit of the channel, harmonics in parts of the amplitude. Plain data; any thread.
#pragma once

#include <string>
#include <vector>

#include "analysis/sine/unresolved_lines.hpp"
#include "analysis/uncertainty/line_power.hpp"

namespace dyncal::services {

struct MeasuredLine {
  analysis::LineKind kind = analysis::LineKind::mains;
  double line_hz = 0.0; // of the mains; 0 of a harmonic
  int order = 0;        // of a harmonic; 0 of the mains
  analysis::MeasuredAmplitude measured{};
};

struct ChannelLines {
  std::string channel; // "source/channel"
  std::string subject; // as rows of the budget name it: "the reference"
  bool counts_in_magnitude = true;
  double amplitude = 0.0;
  double duration_s = 0.0;
  std::vector<analysis::UnresolvedLine> unresolved;
  std::vector<MeasuredLine> measured;
};

} // namespace dyncal::services
