#include "services/views/conformity/conformity_json.hpp"

#include "services/views/conformity/stated_conformity.hpp"
#include "services/views/report/json_number.hpp"

namespace dyncal::inline views {
namespace {

using Json = nlohmann::ordered_json;

Json value_json(const JudgedValue& value, const ToleranceRow& row) {
  const StatedDeviation stated = stated_deviation(value);
  return {{"channel", value.channel},
          {"frequency_text_hz", value.frequency_text_hz},
          {"frequency_hz", value.frequency_hz},
          {"level_m_s2", value.level_m_s2},
          {"limit", value.row + 1},
          {"quantity", row.is_of_phase() ? "phase" : "magnitude"},
          {"unit", symbol_of(row.unit)},
          {"deviation", json_number(value.deviation)},
          {"U_deviation", json_number(value.expanded)},
          {"k", json_number(value.k)},
          {"lower_limit", row.lower},
          {"upper_limit", row.upper},
          {"statement", analysis::to_string(value.statement)},
          {"probability", json_number(value.probability)},
          {"reason", value.reason.english},
          {"text",
           {{"deviation", stated.value},
            {"U_deviation", stated.expanded},
            {"probability", probability_text(value)}}}};
}

} // namespace

Json conformity_json(const ConformityReport& report, const StoredResult& result) {
  const Tolerances& tolerances = report.tolerances;
  Json json{{"bench", result.bench},
            {"run", result.run},
            {"result_sha256", result.sha256},
            {"specification", tolerances.specification},
            {"rule", analysis::to_string(tolerances.rule)},
            {"guard_factor", tolerances.guard_factor},
            {"rule_text", rule_text(tolerances)},
            {"statement", analysis::to_string(report.statement())},
            {"verdict", verdict_text(report)},
            {"limits", Json::array()},
            {"values", Json::array()},
            {"notes", Json::array()}};
  for (const TranslatedText& note : report.notes) {
    json["notes"].push_back(note.english);
  }
  for (const ToleranceRow& row : tolerances.rows) {
    json["limits"].push_back(row_text(row));
  }
  for (const JudgedValue& value : report.values) {
    json["values"].push_back(value_json(value, tolerances.rows[value.row]));
  }
  return json;
}

} // namespace dyncal::inline views
