// What speaks against a document, and why values are missing, in all languages.
#pragma once

#include "services/views/language/sentence.hpp"

namespace dyncal::inline views::sentences {

// The run as a whole.
inline constexpr Sentence run_interrupted{"the run was interrupted",
                                          "der Messlauf wurde abgebrochen"};
inline constexpr Sentence run_ended_early{"the run ended early: {}",
                                          "der Messlauf endete vorzeitig: {}"};
inline constexpr Sentence check_not_stated{
    "the bench demands a check with sensor '{}', and the result says neither when it was nor why "
    "it was left out",
    "der Messplatz verlangt eine Prüfung mit Sensor „{}“, und das Ergebnis nennt weder ihren "
    "Zeitpunkt noch, warum sie unterblieb"};
inline constexpr Sentence closure_is_open{"closure open: {}", "Gegenprobe stimmt nicht: {}"};
inline constexpr Sentence reason_in_result{"the result file gives the reason",
                                           "den Grund nennt die Ergebnisdatei"};

// Axes.
inline constexpr Sentence lies_across{
    "{0} lies across the excited axis {1}, and its uncertainty lacks what the exciter moves there: "
    "state it in the bench file (excitation.transverse_motion), have a channel along {1} under "
    "calibration beside it, and evaluate the run anew",
    "{0} liegt quer zur angeregten Achse {1}, und die Messunsicherheit enthält nicht, wie sich der "
    "Erreger dort bewegt: in der Messplatzdatei angeben (excitation.transverse_motion), einen "
    "Kanal entlang {1} mitkalibrieren und den Messlauf neu auswerten"};
inline constexpr Sentence axis_not_stated{
    "channels along {} are named, and the excited axis is not stated as one of x, y, z "
    "(excitation.axis in the bench file)",
    "Kanäle entlang {} sind genannt, und die angeregte Achse ist nicht als x, y oder z angegeben "
    "(excitation.axis in der Messplatzdatei)"};

// Values.
inline constexpr Sentence of_repetition{", repetition {}", ", Wiederholung {}"};
inline constexpr Sentence of_attempt{", attempt {}", ", Versuch {}"};
inline constexpr Sentence single_results_missing{
    "{}: {} single results have no value; the first at {}: {}",
    "{}: {} Einzelergebnisse haben keinen Wert; das erste bei {}: {}"};
inline constexpr Sentence steps_missing{"{}: {} of {} planned steps have a value",
                                        "{}: {} von {} geplanten Schritten haben einen Wert"};
inline constexpr Sentence value_without_u{
    "{} at {}: the result has no value with a usable U; it is left out",
    "{} bei {}: das Ergebnis hat keinen Wert mit brauchbarem U und ist ausgelassen"};
inline constexpr Sentence unexplained_loss{
    "{} at {}: {} samples were lost within the step, and no flag says why",
    "{} bei {}: im Schritt fehlen {} Abtastwerte, und keine Kennzeichnung sagt, warum"};

// Sensor, reference and days.
inline constexpr Sentence laboratory_file{"the laboratory file", "die Laboratoriumsdatei"};
inline constexpr Sentence another_serial{
    "the run was measured with serial number '{0}' (source {1}), the sensor file says '{2}'; if it "
    "is the same sensor, state in its file electronic_serial = \"{0}\"",
    "gemessen ist mit Seriennummer „{0}“ (Quelle {1}), die Sensordatei nennt „{2}“; ist es "
    "derselbe Sensor, dann in seiner Datei angeben: electronic_serial = \"{0}\""};
inline constexpr Sentence another_model{
    "the run was measured with model '{0}' (source {1}), the sensor file says '{2}'; if it is the "
    "same sensor, state in its file electronic_model = \"{0}\"",
    "gemessen ist mit Typ „{0}“ (Quelle {1}), die Sensordatei nennt „{2}“; ist es derselbe Sensor, "
    "dann in seiner Datei angeben: electronic_model = \"{0}\""};
inline constexpr Sentence certificate_after_measurement{
    "the certificate of the {} is of {}, after the measurement of {}",
    "der Kalibrierschein von „{}“ ist vom {}, nach der Messung vom {}"};
inline constexpr Sentence was_due{
    "the {} was to be calibrated again by {}, before the measurement of {}",
    "„{}“ war bis {} neu zu kalibrieren, vor der Messung vom {}"};
inline constexpr Sentence no_day_of_certificate{
    "{} does not say when the certificate of the {} was issued (issued)",
    "{} nennt nicht den Tag des Kalibrierscheins von „{}“ (issued)"};
inline constexpr Sentence no_end_of_validity{
    "{} does not say until when the {} may be used (valid_until, or interval_months)",
    "{} nennt nicht, bis wann „{}“ benutzt werden darf (valid_until oder interval_months)"};
inline constexpr Sentence received_after_measurement{
    "the sensor was received on {}, after the measurement of {}",
    "der Kalibriergegenstand ging am {} ein, nach der Messung vom {}"};
inline constexpr Sentence reference_lacks{"{} does not state reference.{}",
                                          "{} nennt nicht reference.{}"};
inline constexpr Sentence another_reference{
    "the run was measured against reference '{}' with certificate '{}' ({}), the laboratory file "
    "names '{}' with '{}': leave its table [reference] out",
    "gemessen ist gegen das Bezugsnormal „{}“ mit Kalibrierschein „{}“ ({}), die "
    "Laboratoriumsdatei nennt „{}“ mit „{}“: ihre Tabelle [reference] weglassen"};

// Whether the result file is what was measured.
inline constexpr Sentence amendment_not_in_store{
    "the store does not have the amendment of {} ('dyncal store add {}')",
    "das Archiv hat die Berichtigung vom {} nicht („dyncal store add {}“)"};
inline constexpr Sentence not_evaluated_again{
    "the recording of the run cannot be evaluated once more{}",
    "die Aufzeichnung des Messlaufs lässt sich nicht noch einmal auswerten{}"};
inline constexpr Sentence combined_not_in_store{
    "the store does not have the combined result ('dyncal store add')",
    "das Archiv hat das zusammengefasste Ergebnis nicht („dyncal store add“)"};
inline constexpr Sentence nothing_shows{
    "nothing shows that {} is what was measured: there is no recording beside it, and the store{} "
    "does not have it ('dyncal store add', or --store)",
    "nichts zeigt, dass {} das ist, was gemessen wurde: daneben ist keine Aufzeichnung, und das "
    "Archiv{} hat es nicht („dyncal store add“ oder --store)"};

} // namespace dyncal::inline views::sentences
