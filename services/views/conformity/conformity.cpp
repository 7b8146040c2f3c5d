#include "services/views/conformity/conformity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/response/comparison.hpp"
#include "services/views/conformity/stated_conformity.hpp"
#include "services/views/language/conformity_sentences.hpp"
#include "services/views/language/flag_text.hpp"
#include "services/views/objections/refusing_flags.hpp"
#include "services/views/report/result_file.hpp"

namespace dyncal::inline views {
namespace {

using analysis::CombinedUncertainty;
using analysis::ConformityStatement;

constexpr double percent = 100.0;
constexpr double degrees = 180.0 / std::numbers::pi;
constexpr double turn_deg = 360.0;
constexpr double db_per_decade = 20.0;

bool is_between(double value, double from, double to) {
  constexpr double same_rel = 1e-9;
  return value >= from * (1.0 - same_rel) && value <= to * (1.0 + same_rel);
}

bool covers(const ToleranceRow& row, const std::string& channel, double frequency_hz,
            double level_m_s2) {
  return (row.channel.empty() || row.channel == channel) &&
         is_between(frequency_hz, row.from_hz, row.to_hz) &&
         is_between(level_m_s2, row.from_level_m_s2.value_or(level_m_s2),
                    row.to_level_m_s2.value_or(level_m_s2));
}

TranslatedText doubt_about(const StoredResult& result, const StoredValue& value, bool of_phase) {
  const std::string name = doubting_flag(result, value, of_phase);
  if (name.empty()) {
    return {};
  }
  const ResultFlag flag = parse_flag_name(name);
  return in_all_languages([&](Language language) {
    return sentences::flag_says(language, name,
                                language == Language::german ? german_meaning_of(flag)
                                                             : verdict_on(flag).reason);
  });
}

// Of that frequency, and of the same level and axis if there are several.
const StoredValue* value_at(const std::vector<StoredValue>& values, double frequency_hz,
                            const StoredValue& like) {
  std::vector<const StoredValue*> found;
  for (const StoredValue& value : values) {
    if (is_between(value.frequency_hz, frequency_hz, frequency_hz)) {
      found.push_back(&value);
    }
  }
  const auto same = std::ranges::find_if(found, [&](const StoredValue* value) {
    return value->level_m_s2 == like.level_m_s2 && value->excited_axis == like.excited_axis;
  });
  if (same != found.end()) {
    return *same;
  }
  return found.size() == 1 ? found.front() : nullptr;
}

CombinedUncertainty scaled(const ExpandedUncertainty& of_value, double factor) {
  return {.u = factor * of_value.u, .degrees_of_freedom = of_value.nu_eff, .k = of_value.k};
}

// In per cent or degrees; nothing: there is no U. `reference` may be null.
std::optional<analysis::Difference> deviation_of(const StoredValue& value, const ToleranceRow& row,
                                                 const StoredValue* reference) {
  analysis::Difference deviation;
  double subtrahend = percent;
  CombinedUncertainty of_subtrahend{.u = 0.0};
  if (row.is_of_phase()) {
    const auto without_delay = [&](const StoredValue& one) {
      return degrees * one.phase_rad + turn_deg * one.frequency_hz * row.nominal_delay_s;
    };
    const double from = reference == nullptr ? row.nominal_deg : without_delay(*reference);
    deviation = {std::remainder(without_delay(value) - from, turn_deg),
                 scaled(value.of_phase, degrees)};
    subtrahend = 0.0;
    if (reference != nullptr) {
      of_subtrahend = scaled(reference->of_phase, degrees);
    }
  } else {
    const double nominal = reference == nullptr ? row.nominal : reference->magnitude;
    deviation = {percent * value.magnitude / nominal,
                 scaled(value.of_magnitude, percent / nominal)};
    if (reference != nullptr) {
      of_subtrahend =
          scaled(reference->of_magnitude, percent * value.magnitude / nominal / nominal);
    }
  }
  if (reference != nullptr) {
    const auto difference =
        analysis::difference_of(deviation.value, deviation.of_value, subtrahend, of_subtrahend);
    return difference ? std::optional(*difference) : std::nullopt;
  }
  deviation.value -= subtrahend;
  return deviation;
}

double percent_of_db(double db) {
  return percent * (std::pow(10.0, db / db_per_decade) - 1.0);
}

// For people, in the unit of the row.
void state_deviation(const analysis::Difference& deviation, const ToleranceRow& row,
                     JudgedValue& judged) {
  judged.deviation = deviation.value;
  judged.expanded = deviation.of_value.expanded();
  judged.k = deviation.of_value.k;
  if (row.unit == ToleranceUnit::decibel) {
    const double ratio = 1.0 + deviation.value / percent;
    judged.deviation = db_per_decade * std::log10(ratio);
    judged.expanded *= db_per_decade / std::numbers::ln10 / percent / ratio;
  }
}

void decide(const Tolerances& tolerances, const StoredValue& value, const StoredValue* reference,
            JudgedValue& judged) {
  const ToleranceRow& row = tolerances.rows[judged.row];
  analysis::ToleranceLimits limits{row.lower, row.upper};
  if (row.unit == ToleranceUnit::decibel) {
    limits = {percent_of_db(row.lower), percent_of_db(row.upper)};
  }
  const auto deviation = deviation_of(value, row, reference);
  const auto conformity =
      analysis::decide_conformity(deviation ? deviation->value : JudgedValue::nan_value,
                                  deviation ? deviation->of_value : CombinedUncertainty{}, limits,
                                  tolerances.rule, tolerances.guard_factor);
  if (!conformity) {
    judged.reason = sentences::no_usable_u.translated();
    return;
  }
  state_deviation(*deviation, row, judged);
  judged.statement = conformity->statement;
  judged.probability = conformity->probability;
  if (2.0 * conformity->guard_band > limits.upper - limits.lower) {
    judged.reason = sentences::guard_band_too_wide.translated();
  }
}

JudgedValue judged_value(const StoredResult& result, const std::vector<StoredValue>& values,
                         const StoredValue& value, const Tolerances& tolerances,
                         std::size_t number) {
  JudgedValue judged{.channel = value.channel,
                     .frequency_text_hz = value.frequency_text_hz,
                     .frequency_hz = value.frequency_hz,
                     .level_m_s2 = value.level_m_s2,
                     .row = number};
  const ToleranceRow& row = tolerances.rows[number];
  const auto& relative_to_hz = row.relative_to_hz;
  const StoredValue* reference = nullptr;
  if (relative_to_hz) {
    reference = value_at(values, *relative_to_hz, value);
    if (reference == nullptr) {
      judged.reason = in_all_languages([&](Language language) {
        return sentences::no_reference_value(language,
                                             decimal(language, fmt::format("{}", *relative_to_hz)));
      });
      return judged;
    }
  }
  TranslatedText doubt = doubt_about(result, value, row.is_of_phase());
  if (doubt.empty() && reference != nullptr) {
    doubt = doubt_about(result, *reference, row.is_of_phase());
    if (!doubt.empty()) {
      doubt = in_all_languages([&](Language language) {
        return sentences::at_reference_frequency(language, doubt.in(language));
      });
    }
  }
  decide(tolerances, value, reference, judged);
  if (!doubt.empty()) {
    judged.statement = ConformityStatement::undecided;
    judged.probability = JudgedValue::nan_value;
    judged.reason = std::move(doubt);
  }
  return judged;
}

// Planned points in the range of a row that have no value.
void add_not_measured(const StoredResult& result, const std::vector<StoredValue>& values,
                      const std::string& channel, const Tolerances& tolerances, std::size_t number,
                      std::vector<JudgedValue>& judged) {
  std::set<std::pair<double, double>> seen;
  for (const StoredValue& value : values) {
    seen.emplace(value.frequency_hz, value.level_m_s2);
  }
  for (const StoredStep& step : result.steps) {
    if (covers(tolerances.rows[number], channel, step.frequency_hz, step.level_m_s2) &&
        seen.emplace(step.frequency_hz, step.level_m_s2).second) {
      judged.push_back({.channel = channel,
                        .frequency_text_hz = step.frequency_text_hz,
                        .frequency_hz = step.frequency_hz,
                        .level_m_s2 = step.level_m_s2,
                        .row = number,
                        .reason = sentences::planned_without_value.translated()});
    }
  }
}

void judge_channel(const StoredResult& result, const std::string& channel,
                   ConformityReport& report) {
  const Tolerances& tolerances = report.tolerances;
  const std::vector<StoredValue> values = result.values_of(channel);
  for (std::size_t number = 0; number < tolerances.rows.size(); ++number) {
    const ToleranceRow& row = tolerances.rows[number];
    for (const StoredValue& value : values) {
      const bool is_reference =
          row.relative_to_hz && value_at({value}, *row.relative_to_hz, value) != nullptr;
      if (!is_reference && covers(row, channel, value.frequency_hz, value.level_m_s2)) {
        report.values.push_back(judged_value(result, values, value, tolerances, number));
      }
    }
    add_not_measured(result, values, channel, tolerances, number, report.values);
  }
}

void note_limits_without_value(ConformityReport& report) {
  for (std::size_t number = 0; number < report.tolerances.rows.size(); ++number) {
    const bool is_measured = std::ranges::any_of(
        report.values, [&](const JudgedValue& value) { return value.row == number; });
    if (!is_measured) {
      report.all_limits_measured = false;
      const ToleranceRow& row = report.tolerances.rows[number];
      report.notes.push_back(in_all_languages([&](Language language) {
        return sentences::limit_not_measured(language, number + 1, range_text(row, language),
                                             row.channel.empty() ? "" : ", " + row.channel);
      }));
    }
  }
}

// Of one quantity, if it has limits at all.
void note_values_without_limit(const StoredResult& result, const std::string& channel,
                               bool of_phase, ConformityReport& report) {
  const auto& rows = report.tolerances.rows;
  const auto is_for = [&](const ToleranceRow& row) {
    return row.is_of_phase() == of_phase && (row.channel.empty() || row.channel == channel);
  };
  std::vector<std::string> places;
  for (const StoredValue& value : result.values_of(channel)) {
    const bool has_limit = std::ranges::any_of(rows, [&](const ToleranceRow& row) {
      return is_for(row) && covers(row, channel, value.frequency_hz, value.level_m_s2);
    });
    if (!has_limit) {
      places.push_back(place_text(identity_of(value),
                                  {.levels = have_several_levels(result.values), .axes = false}));
    }
  }
  if (std::ranges::any_of(rows, is_for) && !places.empty()) {
    report.notes.push_back(in_all_languages([&](Language language) {
      return sentences::no_limit_applies(
          language, channel,
          (of_phase ? sentences::of_phase : sentences::of_magnitude).in(language),
          decimal(language, fmt::format("{}", fmt::join(places, "; "))));
    }));
  }
}

} // namespace

ConformityStatement ConformityReport::statement() const {
  auto worst = values.empty() || !all_limits_measured ? ConformityStatement::undecided
                                                      : ConformityStatement::pass;
  for (const JudgedValue& value : values) {
    worst = std::max(worst, value.statement);
  }
  return worst;
}

ConformityReport judge_conformity(const StoredResult& result,
                                  const std::vector<std::string>& channels, Tolerances tolerances) {
  ConformityReport report{.tolerances = std::move(tolerances)};
  for (const std::string& channel : channels) {
    judge_channel(result, channel, report);
  }
  note_limits_without_value(report);
  for (const std::string& channel : channels) {
    note_values_without_limit(result, channel, false, report);
    note_values_without_limit(result, channel, true, report);
    const bool is_named = std::ranges::any_of(report.tolerances.rows, [&](const ToleranceRow& row) {
      return row.channel.empty() || row.channel == channel;
    });
    if (!is_named) {
      report.notes.push_back(in_all_languages(
          [&](Language language) { return sentences::no_limit_for_channel(language, channel); }));
    }
  }
  return report;
}

} // namespace dyncal::inline views
