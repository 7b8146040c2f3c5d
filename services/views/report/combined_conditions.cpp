#include "services/views/report/combined_conditions.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "services/base/parsed_number.hpp"
#include "services/views/report/amendments.hpp"
#include "services/views/report/condition_keys.hpp"

namespace dyncal::inline views {
namespace {

// Who amended it last.
std::string amended_by(const StoredResult& run, const std::string& key) {
  std::string name;
  for (const JournalEntry& entry : run.journal) {
    if (std::ranges::find(entry.changes, key, &AmendedValue::key) != entry.changes.end()) {
      name = name_of(entry.by);
    }
  }
  return name;
}

// As the documents of the run state it; nothing: it was not to be logged.
std::optional<LoggedCondition> condition_of(const StoredResult& run, const ConditionKeys& keys) {
  const auto logged = std::ranges::find(run.conditions, keys.quantity, &LoggedCondition::quantity);
  std::optional<LoggedCondition> condition;
  if (logged != run.conditions.end()) {
    condition = *logged;
  }
  if (const auto value = parsed_number<double>(amended(run.journal, keys.value).value_or(""))) {
    const double logged_u = condition ? condition->expanded : 0.0;
    condition = LoggedCondition{.quantity = keys.quantity,
                                .unit = keys.unit,
                                .source = amended_by(run, keys.value),
                                .count = 1,
                                .minimum = *value,
                                .mean = *value,
                                .maximum = *value,
                                .expanded = logged_u,
                                .problem = {}};
  }
  const auto expanded = parsed_number<double>(amended(run.journal, keys.expanded).value_or(""));
  if (condition && expanded) {
    condition->expanded = *expanded;
  }
  if (condition && !condition->problem.empty()) {
    condition->problem = fmt::format("run {}: {}", run.run, condition->problem);
  }
  return condition;
}

bool is_stated(const LoggedCondition& condition) {
  return condition.count > 0 && std::isfinite(condition.mean);
}

void add_readings(const LoggedCondition& one, JoinedCondition& joined) {
  LoggedCondition& all = joined.logged;
  const bool is_first = joined.runs == 0;
  all.minimum = is_first ? one.minimum : std::min(all.minimum, one.minimum);
  all.maximum = is_first ? one.maximum : std::max(all.maximum, one.maximum);
  ++joined.runs;
  all.mean =
      is_first ? one.mean : all.mean + (one.mean - all.mean) / static_cast<double>(joined.runs);
  all.count += one.count;
}

} // namespace

std::vector<LoggedCondition> conditions_of_all(const std::vector<StoredResult>& runs) {
  std::vector<LoggedCondition> all;
  for (const StoredResult& run : runs) {
    for (const ConditionKeys& keys : condition_keys) {
      if (auto condition = condition_of(run, keys)) {
        all.push_back(std::move(*condition));
      }
    }
  }
  return all;
}

std::optional<JoinedCondition> joined_condition(const std::vector<LoggedCondition>& conditions,
                                                const std::string& quantity) {
  std::optional<JoinedCondition> joined;
  std::vector<std::string> sources;
  for (const LoggedCondition& one : conditions) {
    if (one.quantity != quantity) {
      continue;
    }
    if (!joined) {
      joined = JoinedCondition{.logged = one};
      joined->logged.count = 0;
    } else if (std::ranges::find(sources, one.source) == sources.end()) {
      joined->logged.source += ", " + one.source;
    }
    sources.push_back(one.source);
    LoggedCondition& all = joined->logged;
    all.expanded = std::max(all.expanded, one.expanded);
    all.problem = all.problem.empty() ? one.problem : all.problem;
    if (is_stated(one)) {
      add_readings(one, *joined);
    }
  }
  return joined;
}

} // namespace dyncal::inline views
