#include "services/views/report/stated_value.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "services/base/per_enumerator.hpp"
#include "services/base/rounding.hpp"
#include "services/contract/evaluation_method.hpp"
#include "services/views/language/statement_sentences.hpp"

namespace dyncal::inline views {
namespace {

StatedValue stated(const RoundedValue& rounded, const ExpandedUncertainty& uncertainty) {
  return {rounded.value, rounded.u, fmt::format("{:.2f}", uncertainty.k)};
}

RoundedPhase rounded_phase(const StoredValue& value) {
  return round_phase(value.phase_rad, value.of_phase.expanded);
}

template <class ValueOf>
std::string range_of(const std::vector<StoredPoint>& points, int decimals, Language language,
                     ValueOf value_of) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const StoredPoint& point : points) {
    if (const double value = value_of(point); std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  const auto text = [&](double value) {
    return decimal(language, fmt::format("{:.{}f}", value, decimals));
  };
  return low > high ? "" : sentences::range(language, text(low), text(high));
}

bool is_usable(double value, const ExpandedUncertainty& uncertainty) {
  return std::isfinite(value) && std::isfinite(uncertainty.expanded) &&
         uncertainty.expanded > 0.0 && std::isfinite(uncertainty.k) && uncertainty.k >= 1.0;
}

} // namespace

StatedValue stated_magnitude(const StoredValue& value) {
  return stated(round_by_uncertainty(value.magnitude, value.of_magnitude.expanded),
                value.of_magnitude);
}

StatedValue stated_phase_rad(const StoredValue& value) {
  return stated(rounded_phase(value).radians, value.of_phase);
}

StatedValue stated_phase_deg(const StoredValue& value) {
  return stated(rounded_phase(value).degrees, value.of_phase);
}

std::string stated_text(double value, const analysis::CombinedUncertainty& of_value,
                        const std::string& unit, Language language) {
  const RoundedValue rounded = round_by_uncertainty(value, of_value.expanded());
  return sentences::value_with_u(language, decimal(language, rounded.value), unit,
                                 decimal(language, rounded.u), unit,
                                 decimal(language, fmt::format("{:.2f}", of_value.k)));
}

bool can_be_stated(const StoredValue& value) {
  return is_usable(value.magnitude, value.of_magnitude) &&
         is_usable(value.phase_rad, value.of_phase) && value.coverage_probability > 0.0 &&
         value.coverage_probability < 1.0;
}

std::string advice_on_repetitions(const std::vector<StoredValue>& values, Language language) {
  double largest_k = 0.0;
  for (const StoredValue& value : values) {
    largest_k = std::max({largest_k, value.of_magnitude.k, value.of_phase.k});
  }
  return advice_on_repetitions(largest_k, language);
}

std::string temperature_range(const std::vector<StoredPoint>& points, Language language) {
  return range_of(points, 1, language, [](const StoredPoint& point) {
    return point.temperature_degc.value_or(StoredPoint::nan_value);
  });
}

std::string level_range(const std::vector<StoredPoint>& points, Language language) {
  return range_of(points, 3, language,
                  [](const StoredPoint& point) { return point.measured_level_m_s2; });
}

double measured_level_m_s2(const StoredResult& result, const StoredValue& value) {
  double sum_m_s2 = 0.0;
  int count = 0;
  for (const StoredPoint& point : result.points) {
    if (point.valid && point.channel == value.channel && point.frequency_hz == value.frequency_hz &&
        point.level_m_s2 == value.level_m_s2 && std::isfinite(point.measured_level_m_s2)) {
      sum_m_s2 += point.measured_level_m_s2;
      ++count;
    }
  }
  return count > 0 ? sum_m_s2 / count : nan("");
}

std::vector<std::string> responding_channels(const StoredResult& result) {
  std::vector<std::string> responding;
  for (const StoredChannel& channel : result.channels) {
    if (channel.responds) {
      responding.push_back(channel.channel);
    }
  }
  return responding;
}

std::optional<drivers::SourceDescription> described_source(const StoredResult& result,
                                                           const std::string& channel) {
  const auto found =
      std::ranges::find(result.sources, channel.substr(0, channel.find('/')), &RunSource::source);
  return found == result.sources.end() ? std::nullopt : std::optional(found->description);
}

std::vector<std::string> first_of(std::vector<std::string> texts, std::size_t most) {
  if (texts.size() > most) {
    const std::size_t others = texts.size() - most;
    texts.resize(most);
    texts.push_back(fmt::format("and {} more", others));
  }
  return texts;
}

std::string coverage_percent(double probability, Language language) {
  return decimal(language, fmt::format("{:.2f} %", 100.0 * probability));
}

std::string method_description(const std::string& method, Language language) {
  const auto known = parse_enumerator<EvaluationMethod>(method);
  if (!known) {
    return method;
  }
  switch (*known) {
  case EvaluationMethod::analogue:
    return sentences::analogue(language);
  case EvaluationMethod::sample_timestamping:
    return sentences::sample_timestamping(language);
  case EvaluationMethod::series_timestamping:
    return sentences::series_timestamping(language);
  case EvaluationMethod::absolute_time:
    return sentences::absolute_time(language);
  }
  return method;
}

std::string frequency_range(const std::vector<StoredValue>& values, Language language) {
  if (values.empty()) {
    return sentences::no_frequency(language);
  }
  const auto [low, high] = std::minmax_element(
      values.begin(), values.end(),
      [](const StoredValue& a, const StoredValue& b) { return a.frequency_hz < b.frequency_hz; });
  const std::string lowest = decimal(language, low->frequency_text_hz);
  return values.size() == 1
             ? sentences::one_frequency(language, lowest)
             : sentences::frequency_range(language, values.size(), lowest,
                                          decimal(language, high->frequency_text_hz));
}

} // namespace dyncal::inline views
