// The texts of the report on what was measured with, in all languages: conditions, losses, clock,
// equipment, software, recipe.
#pragma once

#include "services/views/language/sentence.hpp"

namespace dyncal::inline views::sentences {

inline constexpr Sentence conditions{"Conditions", "Umgebungs- und Messbedingungen"};
inline constexpr Sentence with_expanded{"{} {}, U = {} {} (k = 2)", "{} {}, U = {} {} (k = 2)"};
inline constexpr Sentence ambient_temperature{"Ambient temperature", "Umgebungstemperatur"};
inline constexpr Sentence relative_humidity{"Relative humidity", "Relative Luftfeuchte"};
inline constexpr Sentence air_pressure{"Air pressure", "Luftdruck"};
inline constexpr Sentence mounting{"Mounting", "Montage"};
inline constexpr Sentence orientation{"Orientation", "Orientierung"};
inline constexpr Sentence own_temperature{"Temperature of the sensor, measured by itself",
                                          "Temperatur des Kalibriergegenstands, von ihm selbst "
                                          "gemessen"};
inline constexpr Sentence excited_axis{"Excited axis", "Angeregte Achse"};
inline constexpr Sentence measured_excitation{"Amplitude of the excitation, measured",
                                              "Amplitude der Anregung, gemessen"};
inline constexpr Sentence level_deviation{"Largest deviation from the planned amplitude",
                                          "Größte Abweichung von der geplanten Amplitude"};
inline constexpr Sentence pause_from{"pause from", "Pause von"};
inline constexpr Sentence pause_to{"to", "bis"};
inline constexpr Sentence pause_reason{"reason", "Grund"};
inline constexpr Sentence losses{"Losses within the evaluated steps",
                                 "Verluste in den ausgewerteten Schritten"};
inline constexpr Sentence source{"source", "Quelle"};
inline constexpr Sentence samples_used{"samples used", "verwendete Abtastwerte"};
inline constexpr Sentence did_not_come{"did not come", "ausgeblieben"};
inline constexpr Sentence came_unusable{"came unusable", "unbrauchbar"};
inline constexpr Sentence dropped{"dropped by a full buffer", "durch vollen Puffer verworfen"};
inline constexpr Sentence not_trusted{"stamp not trusted", "Zeitstempel nicht vertraut"};
inline constexpr Sentence not_measured{"not measured", "nicht gemessen"};
inline constexpr Sentence closures_of{"Closures of {}", "Gegenproben von {}"};
inline constexpr Sentence must_hold{"what must hold", "was gelten muss"};
inline constexpr Sentence value{"value", "Wert"};
inline constexpr Sentence limit{"limit", "Grenze"};
inline constexpr Sentence clock_of{"Sample clock of {}", "Abtasttakt von {}"};
inline constexpr Sentence mean_rate{"Mean sample rate", "Mittlere Abtastrate"};
inline constexpr Sentence rate_without_uncertainty{
    "{} Hz (nothing is known of its uncertainty)",
    "{} Hz (über die Messunsicherheit ist nichts bekannt)"};
inline constexpr Sentence rate_deviation{"Deviation from the nominal rate",
                                         "Abweichung von der Nennrate"};
inline constexpr Sentence intervals{"Sample intervals", "Abtastintervalle"};
inline constexpr Sentence median{"Median, smallest, largest", "Median, kleinstes, größtes"};
inline constexpr Sentence standard_deviation{"Standard deviation", "Standardabweichung"};
inline constexpr Sentence tick{"Resolution of the stamps", "Auflösung der Zeitstempel"};
inline constexpr Sentence events{"Events (steps, gaps, doubled samples)",
                                 "Ereignisse (Sprünge, Lücken, doppelte Werte)"};
inline constexpr Sentence lost_in_run{"Samples lost over the whole run",
                                      "Über den ganzen Messlauf verlorene Abtastwerte"};
inline constexpr Sentence clock_figures{
    "The figures of the sample clock are in the run folder.",
    "Die Bilder des Abtasttakts stehen im Ordner des Messlaufs."};
inline constexpr Sentence figure_left_out{"A figure of the run folder is left out{}",
                                          "Ein Bild des Messlaufs fehlt{}"};
inline constexpr Sentence equipment{"Equipment", "Messeinrichtung"};
inline constexpr Sentence equipment_name{"equipment", "Gerät"};
inline constexpr Sentence equipment_serial{"serial", "Seriennummer"};
inline constexpr Sentence equipment_certificate{"certificate", "Kalibrierschein"};
inline constexpr Sentence equipment_issuer{"calibrated by", "kalibriert von"};
inline constexpr Sentence equipment_days{"from, until", "vom, gültig bis"};
inline constexpr Sentence acquisition{"Acquisition of the sensor (source {})",
                                      "Erfassung des Kalibriergegenstands (Quelle {})"};
inline constexpr Sentence device_of_source{"{} (source {})", "{} (Quelle {})"};
inline constexpr Sentence adc_of{"ADC {} of {}", "ADU {} von {}"};
inline constexpr Sentence devices{"Annex: devices and corrections",
                                  "Anhang: Geräte und Korrektionen"};
inline constexpr Sentence device{"device", "Gerät"};
inline constexpr Sentence device_firmware{"firmware", "Firmware"};
inline constexpr Sentence nominal_rate{"nominal rate / Hz", "Nennrate / Hz"};
inline constexpr Sentence time_base{"time base", "Zeitbasis"};
inline constexpr Sentence local_time{"local", "eigene Uhr"};
inline constexpr Sentence software_column{"software", "Software"};
inline constexpr Sentence corrections{"Corrections", "Korrektionen"};
inline constexpr Sentence reference_delay{"Delay of the reference", "Laufzeit des Bezugsnormals"};
inline constexpr Sentence none{"none", "keine"};
inline constexpr Sentence sync_adc{"Sync ADC of the acquisition unit",
                                   "Sync-ADU der Erfassungseinheit"};
inline constexpr Sentence not_corrected{"not corrected", "nicht korrigiert"};
inline constexpr Sentence calibrated_at{"calibrated at {} frequencies",
                                        "kalibriert bei {} Frequenzen"};
inline constexpr Sentence trigger_delay{"Delay of the oscilloscope's trigger",
                                        "Laufzeit des Triggers des Oszilloskops"};
inline constexpr Sentence delay_with_u{"{} µs, u = {} µs", "{} µs, u = {} µs"};
inline constexpr Sentence applied{"applied", "angewandt"};
inline constexpr Sentence to_the_phase{"to the phase / °", "auf die Phase / °"};
inline constexpr Sentence largest_u{"largest <i>u</i> / °", "größtes <i>u</i> / °"};
inline constexpr Sentence from_to{"{} to {}", "{} bis {}"};
inline constexpr Sentence reference_response{"response of the reference",
                                             "Übertragungsfunktion des Bezugsnormals"};
inline constexpr Sentence channel_response{"response of the channel {}",
                                           "Übertragungsfunktion des Kanals {}"};
inline constexpr Sentence adc_phase_lag{"phase lag of the sync ADC",
                                        "Phasenverzögerung des Sync-ADU"};
inline constexpr Sentence software{"Annex: software and hashes", "Anhang: Software und Prüfsummen"};
inline constexpr Sentence conducted_with{"Run conducted with", "Messlauf geführt mit"};
inline constexpr Sentence evaluated_by{"Evaluated by", "Ausgewertet von"};
inline constexpr Sentence on_host{"on host", "auf Rechner"};
inline constexpr Sentence dds_of_analysis{"DDS implementation of the analysis",
                                          "DDS-Implementierung der Auswertung"};
inline constexpr Sentence made_by{"Report made by", "Dokument erstellt von"};
inline constexpr Sentence held_against{"Held against", "Geprüft gegen"};
inline constexpr Sentence result_file{"Result file", "Ergebnisdatei"};
inline constexpr Sentence its_hash{"its SHA-256", "ihre SHA-256"};
inline constexpr Sentence recipe_hash{"SHA-256 of the recipe", "SHA-256 der Messplatzdatei"};
inline constexpr Sentence recipe{"Annex: recipe (bench file without its comments)",
                                 "Anhang: Messplatzdatei (ohne ihre Kommentare)"};

} // namespace dyncal::inline views::sentences
