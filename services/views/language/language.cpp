#include "services/views/language/language.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "services/base/per_enumerator.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::size_t day_length = 10;

bool is_day(std::string_view text) {
  constexpr std::string_view form = "dddd-dd-dd";
  return text.size() == form.size() &&
         std::equal(text.begin(), text.end(), form.begin(), [](char c, char expected) {
           return expected == 'd' ? c >= '0' && c <= '9' : c == expected;
         });
}

} // namespace

std::string_view code_of(Language language) {
  return per_enumerator(language, {"en", "de"});
}

Expected<std::vector<Language>> parse_languages(std::string_view codes) {
  std::vector<Language> languages;
  for (std::size_t begin = 0; begin <= codes.size();) {
    const std::size_t end = std::min(codes.find(',', begin), codes.size());
    const std::string_view code = codes.substr(begin, end - begin);
    const auto* const known = std::ranges::find(all_languages, code, code_of);
    if (known == std::end(all_languages) ||
        std::ranges::find(languages, *known) != languages.end()) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("language '{}': documents are in en (English), de (German), or both, "
                              "as in \"de,en\"; the first is the one that holds",
                              codes));
    }
    languages.push_back(*known);
    begin = end + 1;
  }
  return languages;
}

std::string decimal(Language language, std::string number) {
  if (language == Language::german) {
    std::ranges::replace(number, '.', ',');
  }
  return number;
}

std::vector<std::string> decimal(Language language, std::vector<std::string> numbers) {
  for (std::string& number : numbers) {
    number = decimal(language, std::move(number));
  }
  return numbers;
}

std::string day_text(Language language, const std::string& day) {
  return language == Language::english || !is_day(day)
             ? day
             : fmt::format("{}.{}.{}", day.substr(8, 2), day.substr(5, 2), day.substr(0, 4));
}

std::string instant_text(Language language, const std::string& utc) {
  constexpr std::size_t second_length = 19;
  return utc.size() < second_length
             ? utc
             : fmt::format("{} {} UTC", day_text(language, utc.substr(0, day_length)),
                           utc.substr(day_length + 1, 8));
}

} // namespace dyncal::inline views
