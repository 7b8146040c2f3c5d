// The texts of the report and what other documents share with it, in all languages: nothing else
// of a document is in any language but what laboratory, sensor and reference file, the bench file
// and instruments themselves say.
#pragma once

#include "services/views/language/sentence.hpp"

namespace dyncal::inline views::sentences {

// Edges of the pages, and letterhead.
inline constexpr Sentence calibration_report{"Calibration report", "Kalibrierschein"};
inline constexpr Sentence draft{"DRAFT", "ENTWURF"};
inline constexpr Sentence page{"page", "Seite"};
inline constexpr Sentence of_pages{"of", "von"};
inline constexpr Sentence number_mark{"No. {}", "Nr. {}"};
inline constexpr Sentence run_mark{"run {}", "Messlauf {}"};
inline constexpr Sentence bench_mark{"bench {}", "Messplatz {}"};
inline constexpr Sentence result_file_mark{"result file {}...", "Ergebnisdatei {}..."};
inline constexpr Sentence end_of{"End of {} {}", "Ende: {} {}"};
inline constexpr Sentence accreditation{"Accreditation {}", "Akkreditierung {}"};
inline constexpr Sentence replaces_number{"Replaces no. {}", "Ersetzt Nr. {}"};
inline constexpr Sentence run_line{"Run {}", "Messlauf {}"};
inline constexpr Sentence draft_of{"Draft of {}", "Entwurf vom {}"};
inline constexpr Sentence issued_on{"Issued {}", "Ausgestellt am {}"};
inline constexpr Sentence holding_language{
    "The text in the language that comes first is the one that holds.",
    "Es gilt der Wortlaut in der Sprache, die zuerst kommt."};

// Warnings.
inline constexpr Sentence forced{
    "THIS REPORT WAS FORCED: the software that evaluated the measurement refused it. The "
    "laboratory has issued it all the same. What spoke against it:",
    "DIESER BERICHT WURDE ERZWUNGEN: Die Software, die die Messung ausgewertet hat, lehnte ihn ab. "
    "Das Laboratorium hat ihn dennoch ausgestellt. Dagegen sprach:"};
inline constexpr Sentence interrupted{
    "The run was interrupted: not every planned step was measured.",
    "Der Messlauf wurde abgebrochen: Nicht jeder geplante Schritt ist gemessen."};
inline constexpr Sentence ended_early{"The run ended early: {}",
                                      "Der Messlauf endete vorzeitig: {}"};
inline constexpr Sentence does_not_hold{"What must hold over the run does not: {}",
                                        "Was über den Messlauf gelten muss, gilt nicht: {}"};
inline constexpr Sentence without_value{
    "{} single results have no value; the reasons stand below the tables.",
    "{} Einzelergebnisse haben keinen Wert; die Gründe stehen unter den Tabellen."};
inline constexpr Sentence have_flags{
    "Some values have flags (F1{}), which are explained below.",
    "Einige Werte haben Kennzeichnungen (F1{}), die unten erklärt sind."};
inline constexpr Sentence to_flag{" to F{}", " bis F{}"};

// Summary.
inline constexpr Sentence summary{"Summary", "Zusammenfassung"};
inline constexpr Sentence object{"Object", "Kalibriergegenstand"};
inline constexpr Sentence serial{"serial {}", "Seriennummer {}"};
inline constexpr Sentence firmware{"firmware {}", "Firmware {}"};
inline constexpr Sentence received{"Received", "Eingang"};
inline constexpr Sentence settings{"Settings", "Einstellungen"};
inline constexpr Sentence positive_direction{"Positive direction", "Positive Richtung"};
inline constexpr Sentence channels{"Channels", "Kanäle"};
inline constexpr Sentence customer{"Customer", "Auftraggeber"};
inline constexpr Sentence measured{"Measured", "Messung"};
inline constexpr Sentence measured_from{"{} to {}", "{} bis {}"};
inline constexpr Sentence measured_unknown{"not known: no stamps in UTC",
                                           "nicht bekannt: keine Zeitstempel in UTC"};
inline constexpr Sentence place{"Place", "Ort der Kalibrierung"};
inline constexpr Sentence bench_and_run{"Bench, run", "Messplatz, Messlauf"};
inline constexpr Sentence excitation{"Excitation", "Anregung"};
inline constexpr Sentence sinusoidal{"sinusoidal, {}; {} steps planned",
                                     "sinusförmig, {}; {} Schritte geplant"};
inline constexpr Sentence method{"Method", "Verfahren"};
inline constexpr Sentence by_interferometry{"{}:1999 (by laser interferometry); ",
                                            "{}:1999 (Laserinterferometrie); "};
inline constexpr Sentence by_comparison{"{}:2003 (by comparison to a reference transducer); ",
                                        "{}:2003 (Vergleich mit einem Bezugsnormal); "};
inline constexpr Sentence reference{"Reference", "Bezugsnormal, Rückführung"};
inline constexpr Sentence certificate_of{"certificate {} of {}{}", "Kalibrierschein {}, {}{}"};
inline constexpr Sentence check{"Check", "Prüfung des Messplatzes"};
inline constexpr Sentence conformity{"Conformity", "Konformitätsaussage"};
inline constexpr Sentence phase{"Phase", "Phasenverschiebung"};
inline constexpr Sentence uncertainty{"Uncertainty", "Messunsicherheit"};
inline constexpr Sentence relates_only{
    "The results relate only to the items calibrated, as they were received and in the conditions "
    "stated.",
    "Die Ergebnisse beziehen sich nur auf die kalibrierten Gegenstände, im Zustand ihres Eingangs "
    "und unter den angegebenen Bedingungen."};
inline constexpr Sentence departures{
    "What departs from the method, or is to be known with single values, stands under Flags.",
    "Was vom Verfahren abweicht oder zu einzelnen Werten zu wissen ist, steht unter "
    "Kennzeichnungen."};
inline constexpr Sentence remarks{"Remarks", "Bemerkungen"};
inline constexpr Sentence calibrated_by{"Calibrated by", "Kalibriert von"};
inline constexpr Sentence date{"Date: ", "Datum: "};

// Values.
inline constexpr Sentence transfer_function_of{"Transfer function of {}",
                                               "Übertragungsfunktion von {}"};
inline constexpr Sentence means{
    "Means over n repetitions. U is the expanded uncertainty, U = k u, for a coverage probability "
    "of {}; a is the amplitude of the excitation that the reference measured, in brackets where it "
    "is only planned.",
    "Mittelwerte über n Wiederholungen. |H| ist der Übertragungskoeffizient, φ die "
    "Phasenverschiebung. U ist die erweiterte Messunsicherheit, U = k u mit dem "
    "Erweiterungsfaktor k, für eine Überdeckungswahrscheinlichkeit von {}; a ist die vom "
    "Bezugsnormal gemessene Amplitude der Anregung, in Klammern, wo sie nur geplant ist."};
inline constexpr Sentence not_seen{
    "U holds what the records show and what the bench file states. Errors that leave no trace in "
    "the records are listed, each with the experiment that shows it, on the page \"what this "
    "measurement cannot see\" of the guide (what-it-cannot-see.md).",
    "U enthält, was die Aufzeichnungen zeigen und was die Messplatzdatei angibt. Abweichungen, die "
    "in den Aufzeichnungen keine Spur hinterlassen, nennt die Anleitung, jede mit dem Versuch, der "
    "sie zeigt (what-it-cannot-see.md)."};
inline constexpr Sentence flags_column{"flags", "Kennz."};
inline constexpr Sentence at_level{"{} at {} m/s²", "{} bei {} m/s²"};
inline constexpr Sentence repetition{"repetition", "Wiederholung"};
inline constexpr Sentence why_no_value{"why there is no value", "warum es keinen Wert gibt"};
inline constexpr Sentence without_a_value{"Without a value:", "Ohne Wert:"};
inline constexpr Sentence group_delay{
    "Group delay over all frequencies (from the slope of the phase{}): {}.",
    "Gruppenlaufzeit über alle Frequenzen (aus der Steigung der Phasenverschiebung{}): {}."};
inline constexpr Sentence at_levels{" at {} m/s²", " bei {} m/s²"};
inline constexpr Sentence figure_caption{
    "Repetitions (markers), mean with bars of the expanded uncertainty U (line); values with a "
    "flag have a ring. {}",
    "Wiederholungen (Zeichen), Mittelwert mit Balken der erweiterten Messunsicherheit U (Linie); "
    "Werte mit einer Kennzeichnung haben einen Ring. {}"};
inline constexpr Sentence delay_removed{"Of the phase a delay of {} is removed.",
                                        "Die Phase ist ohne die Laufzeit von {} gezeichnet."};
inline constexpr Sentence phase_continuous{"The phase is continuous over frequency.",
                                           "Die Phase ist über der Frequenz stetig fortgesetzt."};
inline constexpr Sentence deviation_caption{
    "Repetitions with bars of their standard uncertainty, against their mean (zero) with its "
    "expanded uncertainty U (band).",
    "Wiederholungen mit Balken ihrer Standardmessunsicherheit gegen ihren Mittelwert (Null) mit "
    "dessen erweiterter Messunsicherheit U (Band)."};
inline constexpr Sentence other_channels{"Other channels of the run",
                                         "Weitere Kanäle des Messlaufs"};
inline constexpr Sentence also_evaluated{
    "Evaluated as well; their values are in the result file. A channel responds if its magnitude "
    "is above three times its standard uncertainty at most frequencies.",
    "Ebenfalls ausgewertet; ihre Werte stehen in der Ergebnisdatei. Ein Kanal spricht an, wenn "
    "sein Übertragungskoeffizient bei den meisten Frequenzen über dem Dreifachen seiner "
    "Standardmessunsicherheit liegt."};
inline constexpr Sentence channel{"channel", "Kanal"};
inline constexpr Sentence unit{"unit", "Einheit"};
inline constexpr Sentence responds{"responds", "spricht an"};
inline constexpr Sentence largest{"largest", "größtes"};
inline constexpr Sentence yes{"yes", "ja"};
inline constexpr Sentence no{"no", "nein"};
inline constexpr Sentence flags{"Flags", "Kennzeichnungen"};
inline constexpr Sentence no_flag{"None of these values has a flag.",
                                  "Keiner dieser Werte hat eine Kennzeichnung."};
inline constexpr Sentence flag{"flag", "Kennzeichnung"};
inline constexpr Sentence found{"found", "gefunden"};
inline constexpr Sentence what_it_means{"what it means", "Bedeutung"};
inline constexpr Sentence all_frequencies{"{}: all frequencies", "{}: alle Frequenzen"};
inline constexpr Sentence single_results{"Annex: single results", "Anhang: Einzelergebnisse"};
inline constexpr Sentence single_results_note{
    "One result a step and repetition; u is a standard uncertainty (k = 1). The hash is the "
    "beginning of the SHA-256 of the samples used; the result file has all of it.",
    "Ein Ergebnis je Schritt und Wiederholung; u ist eine Standardmessunsicherheit (k = 1). Die "
    "Prüfsumme ist der Anfang der SHA-256 der verwendeten Abtastwerte; die Ergebnisdatei enthält "
    "sie ganz."};
inline constexpr Sentence repetition_short{"rep.", "Wdh."};
inline constexpr Sentence measured_amplitude{"measured <i>a</i>", "<i>a</i> gemessen"};
inline constexpr Sentence lost{"lost", "verloren"};
inline constexpr Sentence data{"data", "Daten"};
inline constexpr Sentence no_value{"no value", "kein Wert"};

} // namespace dyncal::inline views::sentences
