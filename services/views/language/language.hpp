// The languages of documents, and how each writes numbers and days. Plain functions, any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "services/base/error.hpp"

namespace dyncal::inline views {

enum class Language { english, german };

inline constexpr Language all_languages[] = {Language::english, Language::german};

// ISO 639-1: "en", "de".
[[nodiscard]] std::string_view code_of(Language language);

// "de,en": the first is the one that holds. Fails (bad_argument) for a code that is not known, one
// that comes twice, and none.
[[nodiscard]] Expected<std::vector<Language>> parse_languages(std::string_view codes);

// The digits of a number, with the language's decimal mark.
[[nodiscard]] std::string decimal(Language language, std::string number);
[[nodiscard]] std::vector<std::string> decimal(Language language, std::vector<std::string> numbers);

// Of "2026-03-01": "01.03.2026" in German. Of "2026-03-01T12:00:05Z": with " 12:00:05 UTC". What is
// neither stays as it is.
[[nodiscard]] std::string day_text(Language language, const std::string& day);
[[nodiscard]] std::string instant_text(Language language, const std::string& utc);

} // namespace dyncal::inline views
