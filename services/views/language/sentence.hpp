// One text of documents in all their languages. It does not compile where a language lacks it, or
// has other places for values than another:
//
//   inline constexpr Sentence replaces{"Replaces no. {}", "Ersetzt Nr. {}"};
//   replaces(Language::german, number)
//
// A TranslatedText is one that is filled in already, for documents in several languages. Plain
// data, any thread.
#pragma once

#include <string>
#include <string_view>

#include <fmt/format.h>

#include "services/base/per_enumerator.hpp"
#include "services/views/language/language.hpp"

namespace dyncal::inline views {

struct TranslatedText {
  std::string english{};
  std::string german{};

  [[nodiscard]] const std::string& in(Language language) const {
    return language == Language::german ? german : english;
  }
  [[nodiscard]] bool empty() const { return english.empty(); }
};

class Sentence {
public:
  consteval Sentence(std::string_view english, std::string_view german)
      : english_(english), german_(german) {
    if (english.empty() || german.empty() || places_in(english) != places_in(german)) {
      throw "a language lacks the text, or a place for a value in it";
    }
  }

  [[nodiscard]] constexpr std::string_view in(Language language) const {
    return per_enumerator(language, {english_, german_});
  }
  // Filled in as by fmt::format().
  template <class... Values>
  [[nodiscard]] std::string operator()(Language language, const Values&... values) const {
    return fmt::format(fmt::runtime(in(language)), values...);
  }

  [[nodiscard]] TranslatedText translated() const {
    return {std::string(english_), std::string(german_)};
  }

private:
  static consteval std::size_t places_in(std::string_view text) {
    std::size_t count = 0;
    for (const char c : text) {
      count += c == '{' ? 1 : 0;
    }
    return count;
  }

  std::string_view english_;
  std::string_view german_;
};

// What `text_in` gives for each language.
template <class TextIn>
[[nodiscard]] TranslatedText in_all_languages(TextIn text_in) {
  return {text_in(Language::english), text_in(Language::german)};
}

} // namespace dyncal::inline views
