#include "services/views/lab_file/documented_conditions.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "services/base/parsed_number.hpp"
#include "services/views/language/journal_sentences.hpp"
#include "services/views/language/reason_text.hpp"
#include "services/views/report/amendments.hpp"
#include "services/views/report/combined_conditions.hpp"
#include "services/views/report/condition_keys.hpp"

namespace dyncal::inline views {
namespace {

struct NamedCondition : ConditionKeys {
  Sentence name;
  std::optional<MeasuredCondition> Conditions::*member;
};
constexpr NamedCondition named_conditions[] = {
    {condition_keys[0], sentences::temperature, &Conditions::temperature_degc},
    {condition_keys[1], sentences::humidity, &Conditions::humidity_percent},
    {condition_keys[2], sentences::pressure, &Conditions::pressure_hpa}};

// What a result combines; 0: it is of one run.
std::string runs_text(std::size_t stating, std::size_t combined, Language language) {
  if (combined == 0) {
    return sentences::the_run(language);
  }
  return stating == combined ? sentences::all_runs(language, combined)
                             : sentences::some_runs(language, stating, combined);
}

TranslatedText measured_sentence(const JoinedCondition& joined, const Sentence& name,
                                 std::size_t combined) {
  const LoggedCondition& logged = joined.logged;
  return in_all_languages([&](Language language) {
    const auto number = [&](double value) {
      return decimal(language, fmt::format("{:.4g}", value));
    };
    return sentences::was_measured(
        language, name(language), runs_text(joined.runs, combined, language), logged.source,
        number(logged.minimum), number(logged.maximum), logged.unit,
        combined == 0 ? "" : sentences::of_means_of_runs(language), number(logged.mean),
        logged.unit, logged.count,
        logged.problem.empty()
            ? ""
            : sentences::some_missing(language, reason_text(language, logged.problem)));
  });
}

void take_logged(const StoredResult& result, DocumentedConditions& documented,
                 std::vector<Sentence>& typed) {
  for (const NamedCondition& keys : named_conditions) {
    const auto joined = joined_condition(result.conditions, keys.quantity);
    auto& condition = documented.conditions.*keys.member;
    if (joined && joined->runs > 0) {
      condition = MeasuredCondition{joined->logged.mean, joined->logged.expanded_over_run()};
      documented.origins.push_back(measured_sentence(*joined, keys.name, result.combined.size()));
    } else if (condition) {
      typed.push_back(keys.name);
    }
    if (joined && joined->runs == 0) {
      const LoggedCondition& logged = joined->logged;
      documented.origins.push_back(in_all_languages([&](Language language) {
        return sentences::was_not_measured(language, keys.name(language), logged.source,
                                           reason_text(language, logged.problem));
      }));
    }
  }
}

void take_amended(const std::vector<JournalEntry>& journal, DocumentedConditions& documented,
                  std::vector<Sentence>& typed) {
  for (const NamedCondition& keys : named_conditions) {
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
