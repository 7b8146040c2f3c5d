#include "services/views/linearity/amplitude_linearity.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "analysis/base/phasor.hpp"
#include "services/views/language/linearity_sentences.hpp"
#include "services/views/objections/refusing_flags.hpp"
#include "services/views/report/common_part.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

using analysis::CombinedUncertainty;

// The means of one channel at one frequency, by level.
struct LevelledValues {
  std::vector<const StoredValue*> values{};
  std::vector<std::string> flags{}; // that forbid a certificate; empty: none
};

TranslatedText left_out(const StoredValue& value, const Sentence& why) {
  return in_all_languages([&](Language language) {
    return why(language, value.channel, decimal(language, value.frequency_text_hz),
               decimal(language, fmt::format("{}", value.level_m_s2)));
  });
}

using LineKey = std::tuple<std::string, double, std::string>; // channel, frequency, axis

std::map<LineKey, LevelledValues> lines_of(const StoredResult& result,
                                           const std::vector<std::string>& channels,
                                           AmplitudeLinearity& linearity) {
  std::map<LineKey, LevelledValues> lines;
  for (const StoredValue& value : result.values) {
    if (std::ranges::find(channels, value.channel) == channels.end()) {
      continue;
    }
    if (!can_be_stated(value)) {
      linearity.notes.push_back(left_out(value, sentences::left_out_without_u));
      continue;
    }
    lines[{value.channel, value.frequency_hz, value.excited_axis}].values.push_back(&value);
  }
  std::erase_if(lines, [](const auto& line) { return line.second.values.size() < 2; });
  for (auto& [key, line] : lines) {
    std::ranges::stable_sort(line.values, {}, &StoredValue::level_m_s2);
    for (const StoredValue* value : line.values) {
      // A delay that is not stated shifts the phases of all levels alike.
      line.flags.push_back(doubting_flag(result, *value, false));
    }
  }
  return lines;
}

// Index into the line; its size: it has none.
std::size_t reference_of(const LevelledValues& line, std::optional<double> level_m_s2) {
  if (level_m_s2) {
    const auto found = std::ranges::find(line.values, *level_m_s2, &StoredValue::level_m_s2);
    return static_cast<std::size_t>(found - line.values.begin());
  }
  for (std::size_t i = line.values.size(); i-- > 0;) {
    if (line.flags[i].empty()) {
      return i;
    }
  }
  return line.values.size() - 1;
}

CombinedUncertainty relative(const CombinedUncertainty& uncertainty, double magnitude) {
  return {uncertainty.u / magnitude, uncertainty.degrees_of_freedom, uncertainty.k};
}

analysis::SharedUncertainty shared_at(const CommonParts& common, const StoredValue& one,
                                      const StoredValue& other) {
  const auto first = common.find(identity_of(one));
  const auto second = common.find(identity_of(other));
  return first == common.end() || second == common.end()
             ? analysis::SharedUncertainty{}
             : shared_between_levels(first->second, second->second);
}

// The logarithm of the ratio, whose u is relative, so that what is shared cancels exactly.
analysis::Expected<LinearityPoint> point_against(const StoredValue& value,
                                                 const StoredValue& reference,
                                                 const analysis::SharedUncertainty& shared) {
  const analysis::ComparedResult x = comparable(value);
  const analysis::ComparedResult y = comparable(reference);
  DYNCAL_TRY(const auto magnitude,
             analysis::difference_of(std::log(x.magnitude), relative(x.of_magnitude, x.magnitude),
                                     std::log(y.magnitude), relative(y.of_magnitude, y.magnitude),
                                     shared.magnitude_rel * shared.magnitude_rel));
  DYNCAL_TRY(const auto phase,
             analysis::difference_of(analysis::wrap_phase(x.phase_rad - y.phase_rad), x.of_phase,
                                     0.0, y.of_phase, shared.phase_rad * shared.phase_rad));
  const double ratio = std::exp(magnitude.value);
  return LinearityPoint{.level_m_s2 = value.level_m_s2,
                        .deviation_rel = ratio - 1.0,
                        .expanded_rel = ratio * magnitude.of_value.expanded(),
                        .k = magnitude.of_value.k,
                        .phase_deviation_rad = phase.value,
                        .expanded_phase_rad = phase.of_value.expanded()};
}

LinearityLine line_against(const LevelledValues& levelled, std::size_t reference,
                           const StoredResult& result, const CommonParts& common,
                           std::vector<TranslatedText>& notes) {
  const StoredValue& of_reference = *levelled.values[reference];
  LinearityLine line{.channel = of_reference.channel,
                     .frequency_text_hz = of_reference.frequency_text_hz,
                     .excited_axis = of_reference.excited_axis,
                     .reference_level_m_s2 = of_reference.level_m_s2};
  for (std::size_t i = 0; i < levelled.values.size(); ++i) {
    const StoredValue& value = *levelled.values[i];
    analysis::Expected<LinearityPoint> point = LinearityPoint{.level_m_s2 = value.level_m_s2};
    if (i != reference) {
      point = point_against(value, of_reference, shared_at(common, value, of_reference));
    }
    if (!point) {
      notes.push_back(left_out(value, sentences::left_out_unclear));
      continue;
    }
    point->measured_level_m_s2 = measured_level_m_s2(result, value);
    point->doubting_flag = levelled.flags[i];
    line.points.push_back(std::move(*point));
  }
  return line;
}

std::string source_of(const std::string& channel) {
  return channel.substr(0, channel.find('/'));
}

} // namespace

bool LinearityPoint::deviates() const {
  return std::abs(deviation_rel) > expanded_rel ||
         std::abs(phase_deviation_rad) > expanded_phase_rad;
}

const LinearityPoint& LinearityLine::largest() const {
  return *std::ranges::max_element(
      points, {}, [](const LinearityPoint& point) { return std::abs(point.deviation_rel); });
}

Expected<AmplitudeLinearity> amplitude_linearity_of(const StoredResult& result,
                                                    const std::vector<std::string>& channels,
                                                    std::optional<double> reference_level_m_s2) {
  AmplitudeLinearity linearity;
  std::map<std::string, CommonParts> common;
  for (const auto& line : lines_of(result, channels, linearity)) {
    const auto& levelled = line.second;
    const std::size_t reference = reference_of(levelled, reference_level_m_s2);
    const std::string& channel = std::get<0>(line.first);
    if (reference == levelled.values.size()) {
      linearity.notes.push_back(in_all_languages([&](Language language) {
        return sentences::not_at_reference_level(
            language, channel, decimal(language, levelled.values.front()->frequency_text_hz),
            decimal(language, fmt::format("{}", *reference_level_m_s2)));
      }));
      continue;
    }
    const std::string source = source_of(channel);
    const auto [parts, is_new] = common.try_emplace(source);
    if (is_new) {
      parts->second = common_parts_of(result, source);
    }
    linearity.lines.push_back(
        line_against(levelled, reference, result, parts->second, linearity.notes));
  }
  if (linearity.lines.empty()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: no channel has values at two levels of one frequency{}",
                            result.file.string(),
                            reference_level_m_s2
                                ? fmt::format(", one of them {} m/s^2", *reference_level_m_s2)
                                : ""));
  }
  return linearity;
}

} // namespace dyncal::inline views
