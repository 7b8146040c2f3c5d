// What documents say of who conducted a run, of its corrections, notes and logged conditions, in
// all languages.
#pragma once

#include <array>
#include <string_view>

#include "services/views/language/sentence.hpp"

namespace dyncal::inline views::sentences {

inline constexpr Sentence performed_by{"Performed by", "Durchgeführt von"};
inline constexpr Sentence measurement_performed_by{"Measurement performed by",
                                                   "Messung durchgeführt von"};
inline constexpr Sentence run_conducted_by{"Run conducted by", "Messlauf durchgeführt von"};
inline constexpr Sentence comment{"Comment", "Bemerkung"};
inline constexpr Sentence comment_on_run{"Comment on the run", "Bemerkung zum Messlauf"};
inline constexpr Sentence corrected{"Corrected", "Berichtigt"};
inline constexpr Sentence origin_of_these{"Origin of these", "Herkunft"};
inline constexpr Sentence origin_of_conditions{"Origin of the conditions",
                                               "Herkunft der Bedingungen"};
inline constexpr Sentence journal{"Annex: notes and events", "Anhang: Notizen und Ereignisse"};
inline constexpr Sentence instant_column{"instant (UTC)", "Zeitpunkt (UTC)"};
inline constexpr Sentence kind_column{"kind", "Art"};
inline constexpr Sentence by_column{"by", "von"};
inline constexpr Sentence text_column{"text", "Text"};
inline constexpr Sentence note{"note", "Notiz"};
inline constexpr Sentence event{"event", "Ereignis"};
inline constexpr Sentence said_by_program{"{}", "„{}“"}; // as it stands in the journal
inline constexpr Sentence amendment{"amendment", "Berichtigung"};

inline constexpr Sentence amended{"{} corrected to {} on {} by {}{}: {}",
                                  "{} berichtigt in {} am {} von {}{}: {}"};
inline constexpr Sentence was_before{", was {}", ", zuvor {}"};
inline constexpr Sentence key_of_source{"{} of {}", "{} von {}"};

// What may be amended, by its key.
struct AmendableName {
  std::string_view key;
  Sentence name;
};
inline constexpr std::array amendable_names{
    AmendableName{"serial", {"serial number", "Seriennummer"}},
    AmendableName{"model", {"model", "Typ"}},
    AmendableName{"manufacturer", {"manufacturer", "Hersteller"}},
    AmendableName{"owner_identification", {"owner's identification", "Kennzeichen des Besitzers"}},
    AmendableName{"received", {"day of receipt", "Tag des Eingangs"}},
    AmendableName{"condition", {"condition at receipt", "Zustand bei Eingang"}},
    AmendableName{"customer", {"customer", "Auftraggeber"}},
    AmendableName{"operator", {"operator", "Bearbeiter"}},
    AmendableName{"comment", {"comment", "Bemerkung"}},
    AmendableName{"positive_direction", {"positive direction", "positive Richtung"}},
    AmendableName{"mounting", {"mounting", "Befestigung"}},
    AmendableName{"orientation", {"orientation", "Lage"}},
    AmendableName{"temperature_degc", {"temperature in °C", "Temperatur in °C"}},
    AmendableName{"U_temperature_k", {"U of the temperature in K", "U der Temperatur in K"}},
    AmendableName{"humidity_percent", {"humidity in %", "Luftfeuchte in %"}},
    AmendableName{"U_humidity_percent", {"U of the humidity in %", "U der Luftfeuchte in %"}},
    AmendableName{"pressure_hpa", {"pressure in hPa", "Luftdruck in hPa"}},
    AmendableName{"U_pressure_hpa", {"U of the pressure in hPa", "U des Luftdrucks in hPa"}},
};

inline constexpr Sentence temperature{"temperature", "Temperatur"};
inline constexpr Sentence humidity{"humidity", "Luftfeuchte"};
inline constexpr Sentence pressure{"pressure", "Luftdruck"};
inline constexpr Sentence was_measured{
    "The {} was measured over {} by {}: {} to {} {}, mean{} {} {}, {} readings{}.",
    "{} über {} gemessen mit „{}“: {} bis {} {}, Mittelwert{} {} {}, {} Ablesungen{}."};
inline constexpr Sentence the_run{"the run", "den Messlauf"};
inline constexpr Sentence all_runs{"all {} runs", "alle {} Messläufe"};
inline constexpr Sentence some_runs{"{} of the {} runs (the others state none)",
                                    "{} der {} Messläufe (die übrigen nennen keinen Wert)"};
inline constexpr Sentence of_means_of_runs{" of the runs' means", " der Mittelwerte der Messläufe"};
inline constexpr Sentence some_missing{"; some are missing: {}", "; einige fehlen: {}"};
inline constexpr Sentence was_not_measured{"The {} was not measured, though {} was to: {}.",
                                           "{} nicht gemessen, obwohl „{}“ es sollte: {}."};
inline constexpr Sentence as_corrected{"The {} is as it was corrected afterwards.",
                                       "{} wie nachträglich berichtigt."};
inline constexpr Sentence entered_by_hand{"Entered by hand, not measured over the run: {}.",
                                          "Von Hand eingetragen, nicht über den Messlauf gemessen: "
                                          "{}."};

} // namespace dyncal::inline views::sentences
