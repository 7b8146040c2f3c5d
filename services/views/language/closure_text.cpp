#include "services/views/language/closure_text.hpp"

#include "services/base/per_enumerator.hpp"

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
                          "Laufzeiten gleichartiger Kanäle", "Takte der Kanäle eines Sensors",
                          "Sync gegen UTC"});
}

std::string_view verdict_text(Verdict verdict, Language language) {
  static constexpr Sentence texts[] = {
      {"closes", "stimmt"}, {"open", "stimmt nicht"}, {"not possible", "nicht möglich"}};
  return per_enumerator(verdict, texts).in(language);
}

TranslatedText closure_line_text(const std::string& channel, const Closure& closure) {
  const std::string unit = closure.unit == "1" ? "" : " " + closure.unit;
  const auto number = [&](double value) {
    return decimal(Language::german, fmt::format("{:.3g}", value)) + unit;
  };
  return {closure_line(channel, closure),
          fmt::format("{}: {}: gefunden {}, Grenze {}", channel,
                      closure_title(closure.kind, Language::german), number(closure.value),
                      number(closure.limit))};
}

} // namespace dyncal::inline views
