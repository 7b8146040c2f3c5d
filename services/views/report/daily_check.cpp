#include "services/views/report/daily_check.hpp"

#include "services/views/language/statement_sentences.hpp"

namespace dyncal::inline views {

namespace {

std::string state_text(const std::string& state, Language language) {
  for (const Sentence& known :
       {sentences::in_control, sentences::warning, sentences::action, sentences::too_few_results}) {
    if (state == known.in(Language::english)) {
      return known(language);
    }
  }
  return state;
}

} // namespace

std::string sentence_of(const DailyCheck& check, Language language) {
  if (!check.left_out.empty()) {
    return sentences::check_left_out(language, check.sensor, check.left_out);
  }
  if (check.run.empty()) {
    return sentences::check_itself(language, check.sensor);
  }
  return sentences::check_result(
      language, check.sensor, check.run,
      language == Language::english ? check.began_utc : instant_text(language, check.began_utc),
      state_text(check.state, language));
}

} // namespace dyncal::inline views
