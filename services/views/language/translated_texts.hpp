// Several texts in one language. Plain function, any thread.
#pragma once

#include <string>
#include <vector>

#include "services/views/language/sentence.hpp"

namespace dyncal::inline views {

[[nodiscard]] inline std::vector<std::string> texts_in(Language language,
                                                       const std::vector<TranslatedText>& texts) {
  std::vector<std::string> chosen;
  chosen.reserve(texts.size());
  for (const TranslatedText& text : texts) {
    chosen.push_back(text.in(language));
  }
  return chosen;
}

} // namespace dyncal::inline views
