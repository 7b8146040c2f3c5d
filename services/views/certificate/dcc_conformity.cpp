#include "services/views/certificate/dcc_conformity.hpp"

#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/per_enumerator.hpp"
#include "services/views/certificate/dcc.hpp"
#include "services/views/conformity/stated_conformity.hpp"
#include "services/views/language/certificate_sentences.hpp"

namespace dyncal::inline views {
namespace {

using JudgedValues = std::vector<const JudgedValue*>;

std::string conformity_word(analysis::ConformityStatement statement) {
  return per_enumerator(statement,
                        {"pass", "conditionalPass", "conditionalFail", "noPass", "fail"});
}

std::string joined_of(const JudgedValues& values,
                      const std::function<std::string(const JudgedValue&)>& of) {
  std::vector<std::string> texts;
  texts.reserve(values.size());
  for (const JudgedValue* value : values) {
    texts.push_back(of(*value));
  }
  return fmt::format("{}", fmt::join(texts, " "));
}

// With U and k where there are any.
void add_list(XmlElement list, std::string_view type, const Sentence& name,
              const std::string& values, std::string_view unit, const JudgedValues& of = {}) {
  XmlElement quantity = list.add("dcc:quantity").attribute("refType", type);
  add_text(quantity, "dcc:name", name);
  XmlElement numbers = quantity.add("si:realListXMLList");
  numbers.add("si:valueXMLList", values);
  numbers.add("si:unitXMLList", unit);
  if (of.empty()) {
    return;
  }
  XmlElement expanded =
      numbers.add("si:measurementUncertaintyUnivariateXMLList").add("si:expandedMUXMLList");
  expanded.add("si:valueExpandedMUXMLList", joined_of(of, [](const JudgedValue& value) {
                 return stated_deviation(value).expanded;
               }));
  expanded.add("si:coverageFactorXMLList", joined_of(of, [](const JudgedValue& value) {
                 return fmt::format("{:.2f}", value.k);
               }));
  expanded.add("si:coverageProbabilityXMLList",
               joined_of(of, [](const JudgedValue&) { return std::string("0.9545"); }));
}

void add_numbers(XmlElement meta_data, const ToleranceRow& row, const JudgedValues& values) {
  const std::string unit = per_enumerator(row.unit, {"\\percent", "\\decibel", "\\degree"});
  XmlElement list =
      meta_data.add("dcc:data").add("dcc:list").attribute("refType", "basic_1IndexTable");
  add_list(list, "vibration_frequency basic_nominalValue basic_tableIndex0",
           sentences::excitation_frequency,
           joined_of(values, [](const JudgedValue& value) { return value.frequency_text_hz; }),
           "\\hertz");
  add_list(
      list, "vibration_accelerationAmplitude basic_nominalValue", sentences::planned_amplitude,
      joined_of(values,
                [](const JudgedValue& value) { return fmt::format("{:g}", value.level_m_s2); }),
      "\\metre\\second\\tothe{-2}");
  add_list(
      list, "basic_measurementError", sentences::deviation,
      joined_of(values, [](const JudgedValue& value) { return stated_deviation(value).value; }),
      unit, values);
  add_list(list, "basic_toleranceLimitLower", sentences::lower_limit, fmt::format("{}", row.lower),
           unit);
  add_list(list, "basic_toleranceLimitUpper", sentences::upper_limit, fmt::format("{}", row.upper),
           unit);
}

std::string sentence_of(const JudgedValue& value, Language language) {
  const std::string probability = probability_text(value, language);
  return sentences::judged_value(
      language, decimal(language, value.frequency_text_hz),
      decimal(language, fmt::format("{:g}", value.level_m_s2)), name_of(value.statement, language),
      probability.empty() ? "" : sentences::conformity_probability(language, probability),
      value.reason.empty() ? "" : " (" + value.reason.in(language) + ")");
}

// Of one channel and limit; `values` is not empty.
void add_row(XmlElement list, const ConformityReport& report, const JudgedValues& values) {
  const JudgedValue& first = *values.front();
  const ToleranceRow& row = report.tolerances.rows[first.row];
  JudgedValues known;
  std::vector<TranslatedText> texts{
      in_all_languages([&](Language language) { return row_text(row, language); })};
  for (const JudgedValue* value : values) {
    if (std::isfinite(value->deviation)) {
      known.push_back(value);
    }
    texts.push_back(
        in_all_languages([&](Language language) { return sentence_of(*value, language); }));
  }
  XmlElement meta_data = list.add("dcc:metaData").attribute("refType", "basic_conformity");
  add_text(meta_data, "dcc:name", in_all_languages([&](Language language) {
             return sentences::conformity_of(language, first.channel, first.row + 1);
           }));
  meta_data.add("dcc:convention", analysis::to_string(report.tolerances.rule));
  meta_data.add("dcc:reference", single_line(report.tolerances.specification));
  XmlElement declaration = meta_data.add("dcc:declaration");
  for (const TranslatedText& text : texts) {
    add_content(declaration, text);
  }
  if (!known.empty()) {
    meta_data.add("dcc:conformityXMLList", joined_of(known, [](const JudgedValue& value) {
                    return conformity_word(value.statement);
                  }));
    add_numbers(meta_data, row, known);
  }
}

} // namespace

void add_conformity_statements(XmlElement list, const std::optional<ConformityReport>& report) {
  if (!report) {
    return;
  }
  const std::string specification = single_line(report->tolerances.specification);
  XmlElement rule = list.add("dcc:statement").attribute("refType", "basic_decisionRule");
  add_text(rule, "dcc:name", sentences::decision_rule);
  rule.add("dcc:convention", analysis::to_string(report->tolerances.rule));
  rule.add("dcc:norm", "ILAC-G8:09/2019");
  rule.add("dcc:reference", specification);
  add_text(rule, "dcc:declaration", in_all_languages([&](Language language) {
             return rule_text(report->tolerances, language) + " " + digits_text(language);
           }));
  XmlElement verdict = list.add("dcc:statement").attribute("refType", "basic_conformity");
  add_text(verdict, "dcc:name", sentences::conformity_statement);
  verdict.add("dcc:reference", specification);
  XmlElement declaration = verdict.add("dcc:declaration");
  add_content(declaration,
              in_all_languages([&](Language language) { return verdict_text(*report, language); }));
  for (const TranslatedText& note : report->notes) {
    add_content(declaration, note);
  }
  verdict.add("dcc:conformity", conformity_word(report->statement()));
}

void add_conformity(XmlElement list, const std::optional<ConformityReport>& report) {
  if (!report) {
    return;
  }
  const std::vector<JudgedValue>& all = report->values;
  for (std::size_t place = 0; place < all.size();) {
    JudgedValues values;
    const JudgedValue& first = all[place];
    for (; place < all.size() && all[place].channel == first.channel && all[place].row == first.row;
         ++place) {
      values.push_back(&all[place]);
    }
    add_row(list, *report, values);
  }
}

} // namespace dyncal::inline views
