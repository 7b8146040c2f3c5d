// What report, certificate and other documents say alike of method, values and result, in all
// languages.
#pragma once

#include "services/views/language/sentence.hpp"

namespace dyncal::inline views::sentences {

inline constexpr Sentence sign_convention{
    "The transfer function H is the complex ratio of the sensor's output to the reference "
    "quantity. Its phase arg H is the phase of the output minus the phase of the reference "
    "quantity, both of the form cos(2πft + φ) (ISO 2041): positive if the output leads, negative "
    "if it is delayed. It is stated within (−π, π], that is (−180°, 180°].",
    "Die Übertragungsfunktion H ist das komplexe Verhältnis der Ausgangsgröße des "
    "Kalibriergegenstands zur Bezugsgröße. Ihre Phasenverschiebung arg H ist die Phase der "
    "Ausgangsgröße minus der Phase der Bezugsgröße, beide in der Form cos(2πft + φ) (ISO 2041): "
    "positiv, wenn die Ausgangsgröße voreilt, negativ, wenn sie verzögert ist. Sie ist innerhalb "
    "(−π, π] angegeben, das ist (−180°, 180°]."};
inline constexpr Sentence rounding_rule{
    "Expanded uncertainties have two significant digits; each value is rounded to the decimal "
    "place of its expanded uncertainty (JCGM 100:2008, 7.2.6).",
    "Erweiterte Messunsicherheiten haben zwei signifikante Stellen; jeder Wert ist auf die Stelle "
    "seiner erweiterten Messunsicherheit gerundet (JCGM 100:2008, 7.2.6)."};
inline constexpr Sentence repeat_more{
    "So few repetitions hardly show how much they scatter, which makes k large: repeat more often, "
    "five times or more.",
    "So wenige Wiederholungen zeigen kaum, wie sehr sie streuen; daher ist der Erweiterungsfaktor "
    "k "
    "groß: fünf oder mehr Wiederholungen machen ihn kleiner."};
inline constexpr Sentence analogue{
    "Sensor and reference are channels of one recording system with a common clock; magnitude and "
    "phase follow from sine approximation of both.",
    "Kalibriergegenstand und Bezugsnormal sind Kanäle eines Erfassungssystems mit gemeinsamem "
    "Takt; "
    "Übertragungskoeffizient und Phasenverschiebung folgen aus der Sinusapproximation beider."};
inline constexpr Sentence sample_timestamping{
    "Every sample of the digital sensor has a time stamp; a synchronisation signal that both the "
    "sensor's acquisition unit and the reference system record links their clocks; magnitude and "
    "phase follow from sine approximation over the stamped samples.",
    "Jeder Abtastwert des digitalen Sensors hat einen Zeitstempel; ein Synchronisationssignal, das "
    "die Erfassungseinheit des Sensors und das Referenzsystem aufzeichnen, verbindet ihre Uhren; "
    "Übertragungskoeffizient und Phasenverschiebung folgen aus der Sinusapproximation über die "
    "Abtastwerte mit Zeitstempeln."};
inline constexpr Sentence series_timestamping{
    "The digital sensor records a series of samples after a trigger; an oscilloscope records the "
    "synchronisation signal and the trigger; magnitude and phase follow from sine approximation "
    "over all series.",
    "Der digitale Sensor zeichnet nach einem Trigger eine Serie von Abtastwerten auf; ein "
    "Oszilloskop zeichnet Synchronisationssignal und Trigger auf; Übertragungskoeffizient und "
    "Phasenverschiebung folgen aus der Sinusapproximation über alle Serien."};
inline constexpr Sentence absolute_time{
    "The samples of sensor and reference both have time stamps in UTC; magnitude and phase follow "
    "from sine approximation over the stamped samples.",
    "Die Abtastwerte von Kalibriergegenstand und Bezugsnormal haben Zeitstempel in UTC; "
    "Übertragungskoeffizient und Phasenverschiebung folgen aus der Sinusapproximation über die "
    "Abtastwerte mit Zeitstempeln."};
inline constexpr Sentence no_frequency{"no frequency", "keine Frequenz"};
inline constexpr Sentence one_frequency{"{} Hz", "{} Hz"};
inline constexpr Sentence frequency_range{"{} values from {} Hz to {} Hz",
                                          "{} Werte von {} Hz bis {} Hz"};
inline constexpr Sentence range{"{} to {}", "{} bis {}"};
inline constexpr Sentence value_with_u{"{} {}, U = {} {} (k = {})", "{} {}, U = {} {} (k = {})"};

// The daily check of a bench.
inline constexpr Sentence check_left_out{
    "The daily check of the bench with sensor {} was left out: {}",
    "Die tägliche Prüfung des Messplatzes mit Sensor {} ist unterblieben: {}"};
inline constexpr Sentence check_itself{"This run is of the check sensor of the bench, {}",
                                       "Dieser Messlauf ist vom Prüfsensor des Messplatzes, {}"};
inline constexpr Sentence check_result{"Daily check of the bench with sensor {}, run {} of {}: {}",
                                       "Tägliche Prüfung des Messplatzes mit Sensor {}, Messlauf "
                                       "{} vom {}: {}"};
inline constexpr Sentence in_control{"in control", "unter Kontrolle"};
inline constexpr Sentence warning{"warning", "Warnung"};
inline constexpr Sentence action{"action", "Eingriff nötig"};
inline constexpr Sentence too_few_results{"too few results", "zu wenige Ergebnisse"};

// What a result was held against.
inline constexpr Sentence kept_in_store{
    "The result file is the one that the store has of the run, since {} (SHA-256 {}...).",
    "Die Ergebnisdatei ist die, die das Archiv von dem Messlauf hat, seit {} (SHA-256 {}...)."};
inline constexpr Sentence combines_runs{
    "The result combines {} runs, for each of which the sensor was mounted anew, and each of which "
    "was held against its recording or the store: {}.",
    "Das Ergebnis fasst {} Messläufe zusammen, für deren jeden der Kalibriergegenstand neu "
    "montiert "
    "wurde und deren jeder gegen seine Aufzeichnung oder das Archiv geprüft wurde: {}."};
inline constexpr Sentence same_digits{
    "The recording of the run, evaluated once more, gives the same results to the last digit.",
    "Die Aufzeichnung des Messlaufs, noch einmal ausgewertet, ergibt dieselben Ergebnisse bis zur "
    "letzten Stelle."};
inline constexpr Sentence same_values{"the same values and U", "dieselben Werte und U"};
inline constexpr Sentence other_values{"values and U that differ by at most {} u",
                                       "Werte und U, die um höchstens {} u abweichen"};
inline constexpr Sentence by_another_version{
    "The recording of the run, evaluated once more by another version of the software than {}, "
    "gives {}.",
    "Die Aufzeichnung des Messlaufs, mit einer anderen Version der Software als {} noch einmal "
    "ausgewertet, ergibt {}."};
inline constexpr Sentence same_part{
    "The recording of the run, evaluated once more, gives {} of {} single results with deviations "
    "of at most {} u.",
    "Die Aufzeichnung des Messlaufs, noch einmal ausgewertet, ergibt {} der {} Einzelergebnisse "
    "mit "
    "Abweichungen von höchstens {} u."};
inline constexpr Sentence recording_lacks{
    "The recording of the run lacks samples of {} of {} single results.",
    "In der Aufzeichnung des Messlaufs fehlen Abtastwerte von {} der {} Einzelergebnisse."};
inline constexpr Sentence no_recording{
    "There is no recording of the run that it could be evaluated from once more.",
    "Es gibt keine Aufzeichnung des Messlaufs, aus der er noch einmal ausgewertet werden könnte."};

} // namespace dyncal::inline views::sentences
