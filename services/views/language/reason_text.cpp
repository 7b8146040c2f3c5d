#include "services/views/language/reason_text.hpp"

#include "services/views/language/objection_sentences.hpp"

namespace dyncal::inline views {

std::string reason_text(Language language, const std::string& english) {
  return language == Language::english ? english : sentences::reason_in_result(language);
}

} // namespace dyncal::inline views
