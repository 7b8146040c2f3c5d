// What one channel of a step tells of lines beside its excitation: which it could not tell from it,
// and how large others were that some step of the run cannot tell (analysis/sine/
// unresolved_lines.hpp, background_spectrum.hpp): while this step was driven, and in the quiet time
// before it, where they last (stationary_line.hpp).
//
// `amplitude` and `duration_s` are of the fitted sine and its record. Harmonics are measured in
// parts of the amplitude, everything else in the unit of the channel. Plain data; any thread.
#pragma once

#include <string>
#include <vector>

#include "analysis/sine/unresolved_lines.hpp"
#include "analysis/uncertainty/line_power.hpp"

namespace dyncal::inline evaluation {

struct MeasuredLine {
  analysis::LineKind kind = analysis::LineKind::mains;
  double line_hz = 0.0; // of the mains and of a background; 0 of a harmonic
  int order = 0;        // of a harmonic; else 0
  analysis::MeasuredAmplitude measured{};
};

struct ChannelLines {
  std::string channel; // "source/channel"
  std::string subject; // as rows of the budget name it: "the reference"
  bool counts_in_magnitude = true;
  double frequency_hz = 0.0; // planned
  double amplitude = 0.0;
  double duration_s = 0.0;
  std::vector<analysis::UnresolvedLine> unresolved;
  std::vector<MeasuredLine> measured;
  std::vector<MeasuredLine> in_quiet{};
};

} // namespace dyncal::inline evaluation
