// Amplitude linearity: how H of a sensor changes with the level of the excitation at one frequency.
//
//   deviation   |H(a)| / |H(a_ref)| - 1, and arg H(a) - arg H(a_ref) within (-pi, pi]
//   U           of that difference: what both levels have in common (common_part.hpp,
//               shared_between_levels()) is left out, since it shifts both alike
//   a_ref       the level that is asked for, or of each line the highest whose value has no flag
//               that forbids a certificate (refusing_flags.hpp): the highest is the least uncertain
//
// The reference is taken to be linear between the levels but for what its certificate names beside
// its sensitivity, which counts for each level on its own. Levels are those that were planned.
//
// What is left out is a note: a value without U, a frequency without the level that was asked for.
// Fails (bad_argument) where no channel has two levels at a frequency. Any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/views/language/sentence.hpp"
#include "services/views/report/result_file.hpp"

namespace dyncal::inline views {

struct LinearityPoint {
  double level_m_s2 = 0.0;          // as planned
  double measured_level_m_s2 = 0.0; // NaN: not known
  double deviation_rel = 0.0;
  double expanded_rel = 0.0; // U of it; 0 of the reference level itself
  double k = 0.0;
  double phase_deviation_rad = 0.0;
  double expanded_phase_rad = 0.0;
  std::string doubting_flag{}; // its name: it forbids a certificate; empty: none

  // Beyond its U, in magnitude or phase.
  [[nodiscard]] bool deviates() const;
};

struct LinearityLine { // of one channel at one frequency
  std::string channel{};
  std::string frequency_text_hz{};
  std::string excited_axis{};
  double reference_level_m_s2 = 0.0;
  std::vector<LinearityPoint> points{}; // by level, the reference level among them

  // Of the magnitude.
  [[nodiscard]] const LinearityPoint& largest() const;
};

struct AmplitudeLinearity {
  std::vector<LinearityLine> lines{};
  std::vector<TranslatedText> notes{};
};

[[nodiscard]] Expected<AmplitudeLinearity>
amplitude_linearity_of(const StoredResult& result, const std::vector<std::string>& channels,
                       std::optional<double> reference_level_m_s2);

} // namespace dyncal::inline views
