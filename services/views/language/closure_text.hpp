// What must hold over a whole run, in the languages of documents. Any thread.
#pragma once

#include <string_view>

#include "services/evaluation/result/closure.hpp"
#include "services/views/language/sentence.hpp"

namespace dyncal::inline views {

[[nodiscard]] std::string_view closure_title(ClosureKind kind, Language language);
// "closes"
[[nodiscard]] std::string_view verdict_text(Verdict verdict, Language language);

// closure_line(); in other languages than English, in which the evaluation says what it found, with
// the numbers: "dau/x: Phase gegen 0 Hz: gefunden 0,3 rad, Grenze 0,1 rad".
[[nodiscard]] TranslatedText closure_line_text(const std::string& channel, const Closure& closure);

} // namespace dyncal::inline views
