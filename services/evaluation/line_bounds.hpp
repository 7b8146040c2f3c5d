// Hum and folded harmonics beside the excitation, bounded at the end of a run by what the same
// channels showed of them where they could be told: at other steps and in the quiet time between.
//
//   u(A) / A = u(theta) = L(d) sqrt(E[h^2]) / (sqrt(2) A) (analysis/sine/unresolved_lines.hpp)
//
// E[h^2]: analysis/uncertainty/line_power.hpp, in the unit of the channel for the mains, in parts
// of its amplitude for harmonics. The mains comes with another phase in every repetition, a
// harmonic with the same; from the sixth harmonic on all are taken to be alike. A line that no step
// and no quiet time showed keeps its flag: there is no bound. What this takes for granted: hum is
// as large beside the step as elsewhere, and a harmonic has the same part of the amplitude at all
// frequencies of the run.
//
// Belongs to one thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "services/evaluation/result/step_result.hpp"

namespace dyncal::services {

class LineBounds {
public:
  // Takes what the result's channels show, once for every channel of a step; of a later attempt in
  // place of the earlier one.
  void add(const StepResult& result);

  // The result with its final budget and flags; not provisional any more. Its Monte Carlo check is
  // not drawn again.
  [[nodiscard]] StepResult settled(StepResult result) const;

private:
  using Line = std::tuple<std::string, analysis::LineKind, double, int>; // channel, Hz, order
  using StepOfChannel = std::tuple<std::string, std::uint32_t, std::uint32_t>;

  [[nodiscard]] bool is_new(const StepOfChannel& where, std::uint32_t attempt);
  [[nodiscard]] std::optional<double> square_of(const ChannelLines& channel,
                                                const analysis::UnresolvedLine& line) const;
  void settle(const ChannelLines& channel, StepResult& result) const;

  struct Measured {
    StepOfChannel where;
    analysis::MeasuredAmplitude amplitude;
  };

  std::map<StepOfChannel, std::uint32_t> known_; // with the attempt
  std::map<Line, std::vector<Measured>> measured_;
};

} // namespace dyncal::services
