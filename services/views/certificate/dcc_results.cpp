#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/rounding.hpp"
#include "services/views/certificate/dcc.hpp"
#include "services/views/language/certificate_sentences.hpp"
#include "services/views/language/report_sentences.hpp"
#include "services/views/language/statement_sentences.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

using Values = std::vector<StoredValue>;
using Statement = StatedValue (*)(const StoredValue&);

std::string joined(const Values& values, const std::function<std::string(const StoredValue&)>& of) {
  std::vector<std::string> texts;
  texts.reserve(values.size());
  for (const StoredValue& value : values) {
    texts.push_back(of(value));
  }
  return fmt::format("{}", fmt::join(texts, " "));
}

XmlElement add_quantity(XmlElement list, std::string_view type, const Sentence& name) {
  XmlElement quantity = list.add("dcc:quantity").attribute("refType", type);
  add_text(quantity, "dcc:name", name);
  return quantity;
}

// Without uncertainty: what was planned.
void add_plain_list(XmlElement quantity, const std::string& values, std::string_view unit) {
  XmlElement list = quantity.add("si:realListXMLList");
  list.add("si:valueXMLList", values);
  list.add("si:unitXMLList", unit);
}

void add_measured_list(XmlElement parent, const Values& values, Statement stated,
                       std::string_view unit) {
  XmlElement list = parent.add("si:realListXMLList");
  list.add("si:valueXMLList",
           joined(values, [&](const StoredValue& value) { return stated(value).value; }));
  list.add("si:unitXMLList", unit);
  XmlElement expanded =
      list.add("si:measurementUncertaintyUnivariateXMLList").add("si:expandedMUXMLList");
  expanded.add("si:valueExpandedMUXMLList",
               joined(values, [&](const StoredValue& value) { return stated(value).expanded; }));
  expanded.add("si:coverageFactorXMLList",
               joined(values, [&](const StoredValue& value) { return stated(value).k; }));
  expanded.add("si:coverageProbabilityXMLList", joined(values, [](const StoredValue& value) {
                 return fmt::format("{:.4f}", value.coverage_probability);
               }));
  expanded.add("si:distributionXMLList",
               joined(values, [](const StoredValue&) { return std::string("normal"); }));
}

// U in per cent of the magnitude.
void add_relative_uncertainty(XmlElement quantity, const Values& values) {
  XmlElement list = quantity.add("dcc:relativeUncertainty").add("dcc:relativeUncertaintyXmlList");
  list.add("si:valueXMLList", joined(values, [](const StoredValue& value) {
             return rounded_uncertainty(100.0 * value.of_magnitude.expanded / value.magnitude);
           }));
  list.add("si:unitXMLList", "\\percent");
}

std::string description_of(const CertifiedChannel& channel, bool forced, Language language) {
  std::string text =
      sentences::result_description(language, sentences::sign_convention.in(language));
  if (const std::string advice = advice_on_repetitions(channel.values, language); !advice.empty()) {
    text += " " + advice;
  }
  return forced ? sentences::result_forced(language, text) : text;
}

void add_channel(XmlElement results, const CertifiedChannel& channel, bool forced) {
  XmlElement result = results.add("dcc:result").attribute("refType", "dyncal_transferFunction");
  add_text(result, "dcc:name", in_all_languages([&](Language language) {
             return sentences::transfer_function_of(language, channel.channel);
           }));
  add_text(result, "dcc:description", in_all_languages([&](Language language) {
             return description_of(channel, forced, language);
           }));
  XmlElement list =
      result.add("dcc:data").add("dcc:list").attribute("refType", "basic_1IndexTable");
  add_plain_list(
      add_quantity(list, "vibration_frequency basic_nominalValue basic_tableIndex0",
                   sentences::excitation_frequency),
      joined(channel.values, [](const StoredValue& value) { return value.frequency_text_hz; }),
      "\\hertz");
  add_plain_list(
      add_quantity(list, "vibration_accelerationAmplitude basic_nominalValue",
                   sentences::planned_amplitude),
      joined(channel.values,
             [](const StoredValue& value) { return fmt::format("{:g}", value.level_m_s2); }),
      "\\metre\\second\\tothe{-2}");
  XmlElement magnitude = add_quantity(list, "vibration_magnitude", sentences::magnitude);
  add_measured_list(magnitude, channel.values, stated_magnitude, channel.unit);
  add_relative_uncertainty(magnitude, channel.values);
  XmlElement phase = add_quantity(list, "vibration_phase", sentences::phase).add("si:hybrid");
  add_measured_list(phase, channel.values, stated_phase_rad, "\\radian");
  add_measured_list(phase, channel.values, stated_phase_deg, "\\degree");
  add_plain_list(add_quantity(list, "dyncal_repetitions", sentences::number_of_repetitions),
                 joined(channel.values,
                        [](const StoredValue& value) { return std::to_string(value.repetitions); }),
                 "\\one");
}

} // namespace

std::string result_name(const std::string& channel, Language language) {
  return sentences::transfer_function_of(language, channel);
}

void add_results(XmlElement measurement_result, const std::vector<CertifiedChannel>& channels,
                 bool forced) {
  XmlElement results = measurement_result.add("dcc:results");
  for (const CertifiedChannel& channel : channels) {
    add_channel(results, channel, forced);
  }
}

} // namespace dyncal::inline views
