// What a channel has at the frequency of a step beside the excitation (hum, ripple of the
// amplifier, narrow-band noise, folded harmonics), bounded at the end of a run by what the same
// channel showed of it in steps of other frequencies.
//
//   u(A) / A = u(theta) = L(d) sqrt(h^2) / (sqrt(2) A)  (analysis/sine/unresolved_lines.hpp; L = 1
//                                                       but for the mains)
//
// h^2: analysis/uncertainty/background_power.hpp, in the unit of the channel, from steps that were
// driven; of harmonics line_power.hpp, in parts of the amplitude: they have the same part at all
// frequencies of the run, and from the sixth on all are taken to be alike. The quiet time before
// the step counts too, where a line lasts in it; but where other steps show less of it than their
// quiet time does, in this proportion. A line of the mains that no driven step shows apart is not
// there where its kindred are not (low multiples of the same parity); else it keeps its flag,
// whatever quiet time shows, for an amplifier may hum while it drives. So does a harmonic that
// nothing shows. Whatever else is at the frequency counts where it is significant, by what it
// exceeds the mains and the scatter along the step's own record, which hold it too. A line of the
// mains that beats with the excitation is no change within the step: that flag goes where a
// significant line may make as large a one.
//
// Hum is a bounded sine: whatever its phase, the error is at most h L, which is 2 u for u = h / 2.
// It may come with the same phase in every repetition (a generator locked to the mains, steps at a
// regular distance) or not: half of its variance is a row that repeats, so that a mean of any
// number keeps u >= h L / 2 and is covered in either case. A harmonic repeats.
//
// Belongs to one thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

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

  struct Measured {
    StepOfChannel where;
    analysis::MeasuredAmplitude line;
    double excitation = 0.0;
    double duration_s = 0.0;
  };
  using MeasuredLines = std::map<Line, std::vector<Measured>>;

  struct Bound {
    double square = 0.0; // h^2
    bool from_driven_steps = false;
    bool significant = false;
  };
  struct HeldNoise {
    double u = 0.0; // in the unit of the channel; 0: not known
    double duration_s = 0.0;
  };

  [[nodiscard]] bool is_new(const StepOfChannel& where, std::uint32_t attempt);
  [[nodiscard]] const std::vector<Measured>& driven(const Line& line) const;
  [[nodiscard]] const std::vector<Measured>& in_quiet(const Line& line) const;
  [[nodiscard]] std::optional<double> driven_to_quiet(const Line& line,
                                                      const StepOfChannel& where) const;
  [[nodiscard]] Bound bound_of(const Line& line, const StepOfChannel& where, double excitation,
                               const HeldNoise& held) const;
  [[nodiscard]] Bound bound_of_mains(const ChannelLines& channel,
                                     const analysis::UnresolvedLine& line,
                                     const StepOfChannel& where) const;
  [[nodiscard]] std::optional<double> square_of_harmonic(const std::string& channel,
                                                         int order) const;
  struct SettledMains {
    double u2 = 0.0;    // relative
    double beats = 0.0; // by how much the value may seem to change (largest_beat_rel())
  };
  [[nodiscard]] SettledMains settle_mains(const ChannelLines& channel, StepResult& result) const;
  // u^2 of magnitude and phase, before anything of it is held already.
  [[nodiscard]] double background_of(const ChannelLines& channel, const StepResult& result) const;
  void settle_backgrounds(std::span<const double> of_mains, StepResult& result) const;
  void settle_harmonics(const ChannelLines& channel, StepResult& result) const;

  std::map<StepOfChannel, std::uint32_t> known_; // with the attempt
  MeasuredLines driven_;
  MeasuredLines quiet_;
};

} // namespace dyncal::inline evaluation
