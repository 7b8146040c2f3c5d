// What must hold over a whole run, in the languages of documents. Any thread.
#pragma once

#include <string_view>

#include "services/evaluation/result/closure.hpp"
#include "services/views/language/language.hpp"

namespace dyncal::inline views {

[[nodiscard]] std::string_view closure_title(ClosureKind kind, Language language);
// "closes"
[[nodiscard]] std::string_view verdict_text(Verdict verdict, Language language);

} // namespace dyncal::inline views
