#include "services/views/lab_file/documented_conditions.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "services/base/parsed_number.hpp"
#include "services/views/language/journal_sentences.hpp"
#include "services/views/report/amendments.hpp"

namespace dyncal::inline views {
namespace {

struct ConditionKeys {
  const char* quantity; // of a logged condition
  Sentence name;
  std::optional<MeasuredCondition> Conditions::*member;
  const char* value; // keys of laboratory file and amendment
  const char* expanded;
};
constexpr ConditionKeys condition_keys[] = {
    {"temperature", sentences::temperature, &Conditions::temperature_degc, "temperature_degc",
     "U_temperature_k"},
    {"humidity", sentences::humidity, &Conditions::humidity_percent, "humidity_percent",
     "U_humidity_percent"},
    {"pressure", sentences::pressure, &Conditions::pressure_hpa, "pressure_hpa", "U_pressure_hpa"}};

TranslatedText measured_sentence(const LoggedCondition& logged, const Sentence& name) {
  return in_all_languages([&](Language language) {
    const auto number = [&](double value) {
      return decimal(language, fmt::format("{:.4g}", value));
    };
    return sentences::was_measured(
        language, name(language), logged.source, number(logged.minimum), number(logged.maximum),
        logged.unit, number(logged.mean), logged.unit, logged.count,
        logged.problem.empty() ? "" : sentences::some_missing(language, logged.problem));
  });
}

void take_logged(const StoredResult& result, DocumentedConditions& documented,
                 std::vector<Sentence>& typed) {
  for (const ConditionKeys& keys : condition_keys) {
    const auto logged =
        std::ranges::find(result.conditions, keys.quantity, &LoggedCondition::quantity);
    auto& condition = documented.conditions.*keys.member;
    if (logged != result.conditions.end() && logged->count > 0 && std::isfinite(logged->mean)) {
      condition = MeasuredCondition{logged->mean, logged->expanded_over_run()};
      documented.origins.push_back(measured_sentence(*logged, keys.name));
    } else if (condition) {
      typed.push_back(keys.name);
    }
    if (logged != result.conditions.end() && logged->count == 0) {
      documented.origins.push_back(in_all_languages([&](Language language) {
        return sentences::was_not_measured(language, keys.name(language), logged->source,
                                           logged->problem);
      }));
    }
  }
}

void take_amended(const std::vector<JournalEntry>& journal, DocumentedConditions& documented,
                  std::vector<Sentence>& typed) {
  for (const ConditionKeys& keys : condition_keys) {
    const auto value = amended(journal, keys.value);
    const auto expanded = amended(journal, keys.expanded);
    auto& condition = documented.conditions.*keys.member;
    if (!value && !expanded) {
      continue;
    }
    MeasuredCondition changed = condition.value_or(MeasuredCondition{});
    changed.value = parsed_number<double>(value.value_or("")).value_or(changed.value);
    changed.expanded = parsed_number<double>(expanded.value_or("")).value_or(changed.expanded);
    condition = changed;
    std::erase_if(typed, [&](const Sentence& one) {
      return one.in(Language::english) == keys.name.in(Language::english);
    });
    documented.origins.push_back(in_all_languages(
        [&](Language language) { return sentences::as_corrected(language, keys.name(language)); }));
  }
}

} // namespace

DocumentedConditions documented_conditions(const StoredResult& result, const Conditions& typed) {
  DocumentedConditions documented{typed, {}};
  std::vector<Sentence> by_hand;
  take_logged(result, documented, by_hand);
  take_amended(result.journal, documented, by_hand);
  if (!by_hand.empty()) {
    documented.origins.push_back(in_all_languages([&](Language language) {
      std::string names;
      for (const Sentence& one : by_hand) {
        names += (names.empty() ? "" : ", ") + one(language);
      }
      return sentences::entered_by_hand(language, names);
    }));
  }
  Conditions& conditions = documented.conditions;
  conditions.mounting = amended(result.journal, "mounting").value_or(conditions.mounting);
  conditions.orientation = amended(result.journal, "orientation").value_or(conditions.orientation);
  return documented;
}

void amend(const std::vector<JournalEntry>& journal, SensorFile& sensor) {
  const auto take = [&](const char* key, std::string& text) {
    text = amended(journal, key).value_or(text);
  };
  take("manufacturer", sensor.manufacturer);
  take("owner_identification", sensor.owner_identification);
  take("received", sensor.received);
  take("condition", sensor.condition);
  take("positive_direction", sensor.positive_direction);
}

void amend(const std::vector<JournalEntry>& journal, Contact& customer) {
  customer.name = amended(journal, "customer").value_or(customer.name);
}

} // namespace dyncal::inline views
