#include "services/views/language/closure_text.hpp"

#include "services/base/per_enumerator.hpp"
#include "services/views/language/sentence.hpp"

namespace dyncal::inline views {

std::string_view closure_title(ClosureKind kind, Language language) {
  return language == Language::english
             ? title_of(kind)
             : per_enumerator<ClosureKind, std::string_view>(
                   kind, {"Takt des Kalibriergegenstands", "Verhältnis der Takte in jedem Schritt",
                          "Frequenz der Anregung", "Amplitude der Anregung", "gezählte Abtastwerte",
                          "Wiederholungen eines Punkts", "Streuung der Wiederholungen",
                          "erster Punkt, am Ende wiederholt", "Phase gegen die Gruppenlaufzeit",
                          "andere Gruppenlaufzeiten", "Phase gegen 0 Hz",
                          "Laufzeiten gleichartiger Kanäle", "Takte der Kanäle eines Sensors"});
}

std::string_view verdict_text(Verdict verdict, Language language) {
  static constexpr Sentence texts[] = {
      {"closes", "stimmt"}, {"open", "stimmt nicht"}, {"not possible", "nicht möglich"}};
  return per_enumerator(verdict, texts).in(language);
}

} // namespace dyncal::inline views
