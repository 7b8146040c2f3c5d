// What documents and tables say of amplitude linearity, in all languages.
#pragma once

#include "services/views/language/sentence.hpp"

namespace dyncal::inline views::sentences {

inline constexpr Sentence amplitude_linearity{"Amplitude linearity", "Amplitudenlinearität"};
inline constexpr Sentence linearity_explained{
    "Deviations from the value at the reference level; U is that of the difference, without what "
    "both levels have in common. The reference is taken to be linear but for what its certificate "
    "names beside its sensitivity.",
    "Abweichungen vom Wert beim Bezugspegel; U ist die der Differenz, ohne das, was beide Pegel "
    "gemeinsam haben. Das Bezugsnormal gilt als linear, soweit sein Kalibrierschein neben dem "
    "Übertragungskoeffizienten nichts anderes nennt."};
inline constexpr Sentence linearity_of{"{} at {} Hz", "{} bei {} Hz"};
inline constexpr Sentence reference_level_column{"reference level", "Bezugspegel"};
inline constexpr Sentence measured_level_column{"measured / (m/s²)", "gemessen / (m/s²)"};
inline constexpr Sentence flag_column{"flag", "Kennzeichnung"};
inline constexpr Sentence largest_deviation{
    "Largest deviation {} %, U = {} % (k = {}), at {} m/s².",
    "Größte Abweichung {} %, U = {} % (k = {}), bei {} m/s²."};
inline constexpr Sentence left_out_without_u{"{} at {} Hz, {} m/s² is left out: it has no U",
                                             "{} bei {} Hz, {} m/s² fehlt: der Wert hat kein U"};
inline constexpr Sentence left_out_unclear{
    "{} at {} Hz, {} m/s² is left out: its U is not above what both levels have in common",
    "{} bei {} Hz, {} m/s² fehlt: sein U liegt nicht über dem, was beide Pegel gemeinsam haben"};
inline constexpr Sentence not_at_reference_level{"{} at {} Hz was not measured at {} m/s²",
                                                 "{} wurde bei {} Hz nicht mit {} m/s² gemessen"};

} // namespace dyncal::inline views::sentences
