#include "services/views/linearity/linearity_table.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "services/base/printable_text.hpp"
#include "services/base/rounding.hpp"
#include "services/views/language/linearity_sentences.hpp"
#include "services/views/objections/refusing_flags.hpp"
#include "services/views/report/json_number.hpp"

namespace dyncal::inline views {
namespace {

constexpr double percent = 100.0;
constexpr double degrees = 180.0 / std::numbers::pi;

std::string point_line(const LinearityPoint& point, bool is_reference) {
  const std::string measured = std::isfinite(point.measured_level_m_s2)
                                   ? fmt::format("{:.4g}", point.measured_level_m_s2)
                                   : "";
  std::string line = fmt::format("  {:>10} {:>10}", point.level_m_s2, measured);
  if (is_reference) {
    line += fmt::format(" {:>11} {:>9} {:>11} {:>9}  reference level", 0, "", 0, "");
  } else {
    const RoundedValue magnitude =
        round_by_uncertainty(percent * point.deviation_rel, percent * point.expanded_rel);
    const RoundedValue phase = round_by_uncertainty(degrees * point.phase_deviation_rad,
                                                    degrees * point.expanded_phase_rad);
    line += fmt::format(" {:>11} {:>9} {:>11} {:>9}{}", magnitude.value, magnitude.u, phase.value,
                        phase.u, point.deviates() ? "  beyond its U" : "");
  }
  if (const std::string& flag = point.doubting_flag; !flag.empty()) {
    line += fmt::format("  flag {}: {}", flag, verdict_on(parse_flag_name(flag)).reason);
  }
  return line + "\n";
}

std::string line_section(const LinearityLine& line) {
  const std::string axis = line.excited_axis.empty() ? "" : ", axis " + line.excited_axis;
  std::string text = fmt::format("{} at {} Hz{}\n", one_line(line.channel),
                                 one_line(line.frequency_text_hz), one_line(axis));
  text += fmt::format("  {:>10} {:>10} {:>11} {:>9} {:>11} {:>9}\n", "a / m/s^2", "measured",
                      "d|H| / %", "U / %", "d arg / deg", "U / deg");
  for (const LinearityPoint& point : line.points) {
    text += point_line(point, point.level_m_s2 == line.reference_level_m_s2);
  }
  const LinearityPoint& largest = line.largest();
  const RoundedValue stated =
      round_by_uncertainty(percent * largest.deviation_rel, percent * largest.expanded_rel);
  if (largest.expanded_rel > 0.0) {
    text += fmt::format("  largest deviation {} %, U = {} % (k = {:.2f}), at {} m/s^2\n",
                        stated.value, stated.u, largest.k, largest.level_m_s2);
  }
  return text + "\n";
}

nlohmann::ordered_json json_of(const LinearityPoint& point) {
  nlohmann::ordered_json json{{"level_m_s2", point.level_m_s2},
                              {"measured_level_m_s2", json_number(point.measured_level_m_s2)},
                              {"deviation_rel", point.deviation_rel},
                              {"U_deviation_rel", point.expanded_rel},
                              {"k", point.k},
                              {"phase_deviation_rad", point.phase_deviation_rad},
                              {"U_phase_deviation_rad", point.expanded_phase_rad},
                              {"deviates", point.deviates()}};
  if (!point.doubting_flag.empty()) {
    json["flag"] = point.doubting_flag;
  }
  return json;
}

} // namespace

std::string linearity_table(const AmplitudeLinearity& linearity) {
  std::string text;
  for (const LinearityLine& line : linearity.lines) {
    text += line_section(line);
  }
  for (const TranslatedText& note : linearity.notes) {
    text += one_line(note.english) + "\n";
  }
  return text + sentences::linearity_explained(Language::english) + "\n";
}

nlohmann::ordered_json linearity_json(const AmplitudeLinearity& linearity) {
  nlohmann::ordered_json lines = nlohmann::ordered_json::array();
  for (const LinearityLine& line : linearity.lines) {
    nlohmann::ordered_json points = nlohmann::ordered_json::array();
    for (const LinearityPoint& point : line.points) {
      points.push_back(json_of(point));
    }
    lines.push_back({{"channel", line.channel},
                     {"frequency_text_hz", line.frequency_text_hz},
                     {"excited_axis", line.excited_axis},
                     {"reference_level_m_s2", line.reference_level_m_s2},
                     {"points", std::move(points)}});
  }
  nlohmann::ordered_json notes = nlohmann::ordered_json::array();
  for (const TranslatedText& note : linearity.notes) {
    notes.push_back(note.english);
  }
  return {{"lines", std::move(lines)}, {"notes", std::move(notes)}};
}

} // namespace dyncal::inline views
