// Labels of figures in documents, in all languages.
#pragma once

#include "services/views/language/sentence.hpp"

namespace dyncal::inline views::sentences {

inline constexpr Sentence frequency_axis{"frequency in Hz", "Frequenz in Hz"};
inline constexpr Sentence magnitude_axis{"magnitude", "Übertragungskoeffizient"};
inline constexpr Sentence magnitude_in_axis{"magnitude in {}", "Übertragungskoeffizient in {}"};
inline constexpr Sentence magnitude_unknown_axis{"magnitude (unit not known)",
                                                 "Übertragungskoeffizient (Einheit unbekannt)"};
inline constexpr Sentence phase_axis{"phase (lead) in rad", "Phase (Voreilung) in rad"};
inline constexpr Sentence rest_of_phase_axis{"phase without delay in rad",
                                             "Phase ohne Laufzeit in rad"};
inline constexpr Sentence mean_label{"mean", "Mittelwert"};
inline constexpr Sentence mean_so_far_label{"mean so far", "bisheriger Mittelwert"};
inline constexpr Sentence mean_with_bar_label{"mean ± {}", "Mittelwert ± {}"};
inline constexpr Sentence flagged_label{"flagged, see below", "gekennzeichnet, siehe unten"};
inline constexpr Sentence delay_label{"group delay {} ms", "Gruppenlaufzeit {} ms"};
inline constexpr Sentence deviation_title{"{}: repetitions less their mean",
                                          "{}: Wiederholungen minus Mittelwert"};
inline constexpr Sentence magnitude_deviation_axis{"magnitude in %", "Übertr.-koeffizient in %"};
inline constexpr Sentence phase_deviation_axis{"phase in degrees", "Phase in Grad"};
inline constexpr Sentence residual_axis{"residual of the fit in %", "Rest der Anpassung in %"};
inline constexpr Sentence band_of_mean_label{"± {} of the mean{}", "± {} des Mittelwerts{}"};
inline constexpr Sentence largest_of_levels{", the largest of all levels",
                                            ", das größte aller Pegel"};
inline constexpr Sentence no_data{"no data", "keine Daten"};

} // namespace dyncal::inline views::sentences
