// The texts of uncertainty budgets in documents, in all languages.
#pragma once

#include "services/views/language/sentence.hpp"

namespace dyncal::inline views::sentences {

inline constexpr Sentence budget_of{"Uncertainty budget of {}", "Messunsicherheitsbudget von {}"};
inline constexpr Sentence budget_at{"Uncertainty budget of {} at {} Hz, {} m/s²",
                                    "Messunsicherheitsbudget von {} bei {} Hz, {} m/s²"};
inline constexpr Sentence budget_annex{"Annex: uncertainty budgets at all frequencies",
                                       "Anhang: Messunsicherheitsbudgets bei allen Frequenzen"};
inline constexpr Sentence budget_model{
    "Of a single result, the first valid one at this frequency: |H| is the amplitude of the sensor "
    "over that of the reference, times what its calibration corrects, φ the difference of their "
    "phases. Known deviations are corrected; what is not known of them remains as factors of 1, "
    "angles of 0° and delays of 0 µs. Sensitivities are those of |H| and φ to the quantity; "
    "contributions add in squares.",
    "Eines Einzelergebnisses, des ersten gültigen bei dieser Frequenz: |H| ist die Amplitude des "
    "Kalibriergegenstands durch die des Bezugsnormals, mal dem, was dessen Kalibrierung "
    "korrigiert, "
    "φ der Unterschied ihrer Phasen. Bekannte Abweichungen sind korrigiert; was von ihnen "
    "unbekannt ist, bleibt als Faktoren 1, Winkel 0° und Laufzeiten 0 µs. "
    "Empfindlichkeitskoeffizienten sind die von |H| und φ gegen die Größe; Beiträge addieren sich "
    "quadratisch."};
inline constexpr Sentence budget_note{
    "Standard uncertainties (k = 1) of a single result, the first valid one at each frequency; "
    "rows add in squares. In the mean over the repetitions, what is drawn in each averages, what "
    "is the same in all does not; its U also holds the scatter of the repetitions.",
    "Standardmessunsicherheiten (k = 1) eines Einzelergebnisses, des ersten gültigen bei jeder "
    "Frequenz; die Zeilen addieren sich quadratisch. Im Mittelwert über die Wiederholungen "
    "mittelt sich, was in jeder neu ist, und bleibt, was in allen gleich ist; sein U enthält auch "
    "die Streuung der Wiederholungen."};
inline constexpr Sentence budget_magnitude{"Magnitude", "Übertragungskoeffizient"};
inline constexpr Sentence budget_phase{"Phase", "Phasenverschiebung"};
inline constexpr Sentence of_the_value{"Magnitude: <i>u</i> / % of the value",
                                       "Übertragungskoeffizient: <i>u</i> / % des Werts"};
inline constexpr Sentence in_degrees{"Phase: <i>u</i> / °", "Phasenverschiebung: <i>u</i> / °"};
inline constexpr Sentence quantity{"quantity", "Größe"};
inline constexpr Sentence unit_of_quantity{"unit", "Einheit"};
inline constexpr Sentence estimate{"estimate", "Schätzwert"};
inline constexpr Sentence standard_uncertainty{"standard uncertainty",
                                               "Standardmess&shy;unsicherheit"};
inline constexpr Sentence distribution{"distribution", "Verteilung"};
inline constexpr Sentence sensitivity_coefficient{"sensitivity",
                                                  "Empfindlichkeits&shy;koeffizient"};
inline constexpr Sentence contribution{"contribution", "Beitrag"};
inline constexpr Sentence degrees_of_freedom{"degrees of freedom", "Freiheits&shy;grade"};
inline constexpr Sentence in_repetitions{"in repetitions", "in Wiederholungen"};
inline constexpr Sentence small_rows{"{} others, each below 1 % of <i>u</i>",
                                     "{} weitere, je unter 1 % von <i>u</i>"};
inline constexpr Sentence others{"others", "übrige"};
inline constexpr Sentence single_result{"single result", "Einzelergebnis"};
inline constexpr Sentence expanded_of_mean{
    "Mean over {} repetitions, with their scatter: U = {}, k = {}.",
    "Mittelwert über {} Wiederholungen, mit ihrer Streuung: erweiterte Messunsicherheit U = {}, "
    "Erweiterungsfaktor k = {}."};

} // namespace dyncal::inline views::sentences
