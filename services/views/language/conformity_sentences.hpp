// What documents say of tolerances, in all languages.
#pragma once

#include "services/views/language/sentence.hpp"

namespace dyncal::inline views::sentences {

inline constexpr Sentence limit_of{"{}, limit {}", "{}, Grenze {}"};
inline constexpr Sentence deviation_column{"deviation", "Abweichung"};
inline constexpr Sentence statement_column{"statement", "Aussage"};
inline constexpr Sentence pass{"pass", "konform"};
inline constexpr Sentence conditional_pass{"conditional pass", "bedingt konform"};
inline constexpr Sentence conditional_fail{"conditional fail", "bedingt nicht konform"};
inline constexpr Sentence undecided{"undecided", "nicht entschieden"};
inline constexpr Sentence fail{"fail", "nicht konform"};
inline constexpr Sentence of_magnitude{"magnitude", "Übertragungskoeffizient"};
inline constexpr Sentence of_phase{"phase", "Phasenverschiebung"};
inline constexpr Sentence single{"{} {}", "{} {}"};
inline constexpr Sentence from_to_in{"{} {} to {} {}", "{} {} bis {} {}"};
inline constexpr Sentence from_level{", from {} m/s^2", ", ab {} m/s^2"};
inline constexpr Sentence up_to_level{", up to {} m/s^2", ", bis {} m/s^2"};
inline constexpr Sentence from_nominal{"from {}", "von {}"};
inline constexpr Sentence from_degrees{"from {} deg{}", "von {} deg{}"};
inline constexpr Sentence from_value_at{"from the value at {} Hz{}", "vom Wert bei {} Hz{}"};
inline constexpr Sentence false_pass_risk{
    " The risk that a pass is false is at most 2.3 %.",
    " Das Risiko, dass die Aussage konform falsch ist, ist höchstens 2,3 %."};
inline constexpr Sentence simple_acceptance{
    "Simple acceptance (ILAC-G8:09/2019): pass within the tolerance limits, else fail; the risk "
    "that a pass is false is up to 50 % for a value at a limit.",
    "Einfache Annahme (ILAC-G8:09/2019): konform innerhalb der Toleranzgrenzen, sonst nicht "
    "konform; das Risiko, dass die Aussage konform falsch ist, ist bei einem Wert an einer Grenze "
    "bis zu 50 %."};
inline constexpr Sentence guard_band{
    "Guard band (ILAC-G8:09/2019): pass within the tolerance limits less w = {} U, else fail.{}",
    "Schutzabstand (ILAC-G8:09/2019): konform innerhalb der um w = {} U verengten "
    "Toleranzgrenzen, sonst nicht konform.{}"};
inline constexpr Sentence guard_band_non_binary{
    "Guard band, non-binary (ILAC-G8:09/2019): pass within the tolerance limits less w = {} U; "
    "conditional pass within the limits; conditional fail less than w beyond them; else fail.{}",
    "Schutzabstand, nicht binär (ILAC-G8:09/2019): konform innerhalb der um w = {} U verengten "
    "Toleranzgrenzen; bedingt konform innerhalb der Grenzen; bedingt nicht konform um weniger als "
    "w außerhalb; sonst nicht konform.{}"};
inline constexpr Sentence no_value_in_range{"no value is within its limits' range",
                                            "kein Wert liegt im Bereich der Grenzen"};
inline constexpr Sentence digits{
    "Decided with all digits of value and U, before they were rounded; a value at a limit is "
    "within it. The probability is that of the true value to be within the tolerance limits, for a "
    "normal distribution (Student's t of few repetitions) with this U.",
    "Entschieden mit allen Stellen von Wert und U, vor dem Runden; ein Wert an einer Grenze liegt "
    "innerhalb. Die Wahrscheinlichkeit ist die des wahren Werts, innerhalb der Toleranzgrenzen zu "
    "liegen, für eine Normalverteilung (bei wenigen Wiederholungen Students t) mit diesem U."};
inline constexpr Sentence place_of_value{"{} Hz, {} m/s²: {}", "{} Hz, {} m/s²: {}"};

// Why a value is undecided, and what limits and values have no partner.
inline constexpr Sentence flag_says{"flag {}: {}", "Kennzeichnung {}: {}"};
inline constexpr Sentence no_usable_u{"the result has no value with a usable U",
                                      "das Ergebnis hat keinen Wert mit brauchbarem U"};
inline constexpr Sentence guard_band_too_wide{
    "the guard band is wider than half the tolerance: nothing could pass",
    "der Schutzabstand ist größer als die halbe Toleranz: nichts könnte konform sein"};
inline constexpr Sentence no_reference_value{
    "there is no value at the reference frequency of {} Hz and this level",
    "es gibt keinen Wert bei der Bezugsfrequenz von {} Hz und diesem Pegel"};
inline constexpr Sentence at_reference_frequency{"at the reference frequency: {}",
                                                 "bei der Bezugsfrequenz: {}"};
inline constexpr Sentence planned_without_value{"planned, but there is no value",
                                                "geplant, aber es gibt keinen Wert"};
inline constexpr Sentence limit_not_measured{"limit {} ({}{}): no value was measured within it",
                                             "Grenze {} ({}{}): in ihr ist kein Wert gemessen"};
inline constexpr Sentence no_limit_applies{"{}: no limit of the {} applies at {}",
                                           "{}: keine Grenze ({}) gilt bei {}"};
inline constexpr Sentence no_limit_for_channel{"{}: no limit is for this channel",
                                               "{}: keine Grenze gilt für diesen Kanal"};

} // namespace dyncal::inline views::sentences
