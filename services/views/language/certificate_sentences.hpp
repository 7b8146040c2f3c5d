// The texts of the DCC alone, in all languages. What it shares with the report is in
// report_sentences.hpp and statement_sentences.hpp.
#pragma once

#include "services/views/language/sentence.hpp"

namespace dyncal::inline views::sentences {

inline constexpr Sentence made_certificate{"{}: made this certificate",
                                           "{}: hat dieses Zertifikat erstellt"};
inline constexpr Sentence conducted_run{"{}: conducted the run", "{}: hat den Messlauf geführt"};
inline constexpr Sentence evaluated_run{"{}: evaluated the run",
                                        "{}: hat den Messlauf ausgewertet"};
inline constexpr Sentence replaced_certificate{"certificate that is replaced",
                                               "ersetzter Kalibrierschein"};
inline constexpr Sentence certificate_number{"Certificate number", "Nummer des Kalibrierscheins"};
inline constexpr Sentence bench_slash_run{"Bench / run", "Messplatz / Messlauf"};
inline constexpr Sentence digital_sensor{"Digital sensor", "Digitaler Sensor"};
inline constexpr Sentence serial_number{"Serial number", "Seriennummer"};
inline constexpr Sentence firmware_name{"Firmware", "Firmware"};
inline constexpr Sentence firmware_software{"firmware", "Firmware"};
inline constexpr Sentence owner_identification{"Identification of the owner",
                                               "Kennzeichen des Besitzers"};
inline constexpr Sentence issued_in_spite{"Issued in spite of objections",
                                          "Trotz Einwänden ausgestellt"};
inline constexpr Sentence certificate_forced{
    "THIS CERTIFICATE WAS FORCED: the software that evaluated the measurement refused it. The "
    "laboratory has issued it all the same. What spoke against it:",
    "DIESES ZERTIFIKAT WURDE ERZWUNGEN: Die Software, die die Messung ausgewertet hat, lehnte es "
    "ab. Das Laboratorium hat es dennoch ausgestellt. Dagegen sprach:"};
inline constexpr Sentence result_forced{
    "THIS CERTIFICATE WAS FORCED, see the first statement. {}",
    "DIESES ZERTIFIKAT WURDE ERZWUNGEN, siehe die erste Aussage. {}"};
inline constexpr Sentence performed_measurement{"performed the measurement",
                                                "hat die Messung durchgeführt"};
inline constexpr Sentence traceability{"Metrological traceability", "Metrologische Rückführung"};
inline constexpr Sentence reference_calibrated{
    "{} The reference ({}, serial number {}) was calibrated by {}, certificate {}{}.",
    "{} Das Bezugsnormal ({}, Seriennummer {}) wurde kalibriert von {}, Kalibrierschein {}{}."};
inline constexpr Sentence of_day{" of {}", " vom {}"};
inline constexpr Sentence decision_rule{"Decision rule", "Entscheidungsregel"};
inline constexpr Sentence conformity_statement{"Statement of conformity", "Konformitätsaussage"};

inline constexpr Sentence measurement{"Dynamic calibration with sinusoidal excitation",
                                      "Dynamische Kalibrierung mit sinusförmiger Anregung"};
inline constexpr Sentence primary_method{
    "Calibration by laser interferometry with sinusoidal excitation",
    "Kalibrierung durch Laserinterferometrie mit sinusförmiger Anregung"};
inline constexpr Sentence secondary_method{
    "Calibration by comparison to a reference transducer with sinusoidal excitation",
    "Kalibrierung durch Vergleich mit einem Bezugsnormal mit sinusförmiger Anregung"};
inline constexpr Sentence measurement_uncertainty{"Measurement uncertainty", "Messunsicherheit"};
inline constexpr Sentence stated_uncertainties{
    "Expanded uncertainties U = k u with the coverage factor k stated with each value, for the "
    "coverage probability stated with it; u from the contributions by the law of propagation. {}",
    "Erweiterte Messunsicherheiten U = k u mit dem bei jedem Wert angegebenen Erweiterungsfaktor "
    "k, für die bei ihm angegebene Überdeckungswahrscheinlichkeit; u aus den Beiträgen nach dem "
    "Fortpflanzungsgesetz. {}"};
inline constexpr Sentence monte_carlo{
    " Every single result was cross-checked by the Monte Carlo method.",
    " Jedes Einzelergebnis wurde durch die Monte-Carlo-Methode gegengeprüft."};
inline constexpr Sentence phase_convention{"Sign convention of the phase",
                                           "Vorzeichen der Phasenverschiebung"};
inline constexpr Sentence device_certificate{"Certificate {} of {}{}.",
                                             "Kalibrierschein {}, {}{}."};
inline constexpr Sentence reference_device{"Reference. {}{}", "Bezugsnormal. {}{}"};
inline constexpr Sentence calibrated_by_file{"Calibrated by {}", "Kalibriert nach {}"};
inline constexpr Sentence sensor_setting{"Setting of the sensor: {}",
                                         "Einstellung des Kalibriergegenstands: {}"};
inline constexpr Sentence positive_direction_of_axis{"Positive direction of the axis",
                                                     "Positive Richtung der Achse"};
inline constexpr Sentence sensor_temperature{"Temperature of the sensor",
                                             "Temperatur des Kalibriergegenstands"};
inline constexpr Sentence temperature_by_itself{
    "{} degrees Celsius, measured by the sensor itself, for information",
    "{} Grad Celsius, vom Kalibriergegenstand selbst gemessen, zur Information"};
inline constexpr Sentence excitation_level{"Level of the excitation", "Pegel der Anregung"};
inline constexpr Sentence level_as_planned{"sinusoidal, amplitude as planned",
                                           "sinusförmig, Amplitude wie geplant"};
inline constexpr Sentence level_of_reference{
    "sinusoidal, amplitude from the reference: {} m/s^2",
    "sinusförmig, Amplitude nach dem Bezugsnormal: {} m/s^2"};
inline constexpr Sentence sample_clock{"Sample clock", "Abtasttakt"};
inline constexpr Sentence clock_rate{"Source '{}': mean sample rate {}.",
                                     "Quelle '{}': mittlere Abtastrate {}."};
inline constexpr Sentence clock_rate_for_information{
    "Source '{}': mean sample rate {} Hz, for information: nothing is known of the uncertainty of "
    "the clock that it was compared with.",
    "Quelle '{}': mittlere Abtastrate {} Hz, zur Information: Über die Messunsicherheit der Uhr, "
    "mit der sie verglichen wurde, ist nichts bekannt."};
inline constexpr Sentence recipe_file{"Recipe: the bench file of the run",
                                      "Rezept: die Messplatzdatei des Messlaufs"};
inline constexpr Sentence result_hash{"SHA-256 of the result file", "SHA-256 der Ergebnisdatei"};
inline constexpr Sentence hash_of_recipe{"SHA-256 of the recipe", "SHA-256 des Rezepts"};
inline constexpr Sentence recording_hash{"SHA-256 of the recording", "SHA-256 der Aufzeichnung"};
inline constexpr Sentence known_with_values{"To be known with the values",
                                            "Zu den Werten zu wissen"};
inline constexpr Sentence flag_at{"{} at {}: flag {}: {}", "{} bei {}: Kennzeichnung {}: {}"};
inline constexpr Sentence at_all_frequencies{"all frequencies", "allen Frequenzen"};
inline constexpr Sentence losses_name{"Losses", "Verluste"};
inline constexpr Sentence no_losses{
    "No value stated here lacks samples for a reason that is not stated with it.",
    "Keinem hier angegebenen Wert fehlen Abtastwerte aus einem Grund, der nicht bei ihm steht."};

inline constexpr Sentence result_description{
    "Complex transfer function over frequency, means over the repetitions. {}",
    "Komplexe Übertragungsfunktion über der Frequenz, Mittelwerte über die Wiederholungen. {}"};
inline constexpr Sentence excitation_frequency{"Excitation frequency", "Frequenz der Anregung"};
inline constexpr Sentence planned_amplitude{"Amplitude of the excitation, as planned",
                                            "Amplitude der Anregung, wie geplant"};
inline constexpr Sentence magnitude{"Magnitude", "Übertragungskoeffizient"};
inline constexpr Sentence number_of_repetitions{"Number of repetitions", "Zahl der Wiederholungen"};
inline constexpr Sentence conformity_of{"Conformity of {}, limit {}",
                                        "Konformität von {}, Grenze {}"};
inline constexpr Sentence deviation{"Deviation", "Abweichung"};
inline constexpr Sentence lower_limit{"Lower tolerance limit of the deviation",
                                      "Untere Toleranzgrenze der Abweichung"};
inline constexpr Sentence upper_limit{"Upper tolerance limit of the deviation",
                                      "Obere Toleranzgrenze der Abweichung"};
inline constexpr Sentence judged_value{"{} Hz, {} m/s^2: {}{}{}", "{} Hz, {} m/s^2: {}{}{}"};
inline constexpr Sentence conformity_probability{", probability of conformity {}",
                                                 ", Wahrscheinlichkeit der Konformität {}"};

} // namespace dyncal::inline views::sentences
