#include "services/views/report/stated_value.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "services/base/per_enumerator.hpp"
#include "services/base/rounding.hpp"
#include "services/contract/evaluation_method.hpp"

namespace dyncal::inline views {
namespace {

StatedValue stated(const RoundedValue& rounded, const ExpandedUncertainty& uncertainty) {
  return {rounded.value, rounded.u, fmt::format("{:.2f}", uncertainty.k)};
}

RoundedPhase rounded_phase(const StoredValue& value) {
  return round_phase(value.phase_rad, value.of_phase.expanded);
}

template <class ValueOf>
std::string range_of(const std::vector<StoredPoint>& points, int decimals, ValueOf value_of) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const StoredPoint& point : points) {
    if (const double value = value_of(point); std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  return low > high ? "" : fmt::format("{:.{}f} to {:.{}f}", low, decimals, high, decimals);
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
                        const std::string& unit) {
  const RoundedValue rounded = round_by_uncertainty(value, of_value.expanded());
  return fmt::format("{} {}, U = {} {} (k = {:.2f})", rounded.value, unit, rounded.u, unit,
                     of_value.k);
}

bool can_be_stated(const StoredValue& value) {
  return is_usable(value.magnitude, value.of_magnitude) &&
         is_usable(value.phase_rad, value.of_phase) && value.coverage_probability > 0.0 &&
         value.coverage_probability < 1.0;
}

std::string advice_on_repetitions(const std::vector<StoredValue>& values) {
  double largest_k = 0.0;
  for (const StoredValue& value : values) {
    largest_k = std::max({largest_k, value.of_magnitude.k, value.of_phase.k});
  }
  return advice_on_repetitions(largest_k);
}

std::string temperature_range(const std::vector<StoredPoint>& points) {
  return range_of(points, 1, [](const StoredPoint& point) {
    return point.temperature_degc.value_or(StoredPoint::nan_value);
  });
}

std::string level_range(const std::vector<StoredPoint>& points) {
  return range_of(points, 3, [](const StoredPoint& point) { return point.measured_level_m_s2; });
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

std::string coverage_percent(double probability) {
  return fmt::format("{:.2f} %", 100.0 * probability);
}

std::string sign_convention() {
  return "The transfer function H is the complex ratio of the sensor's output to the reference "
         "quantity. Its phase arg H is the phase of the output minus the phase of the reference "
         "quantity, both of the form cos(2 pi f t + phase) (ISO 2041): positive if the output "
         "leads, negative if it is delayed. It is stated within (-pi, pi], that is "
         "(-180 deg, 180 deg].";
}

std::string rounding_rule() {
  return "Expanded uncertainties have two significant digits; each value is rounded to the "
         "decimal place of its expanded uncertainty (JCGM 100:2008, 7.2.6).";
}

std::string method_description(const std::string& method) {
  const auto known = parse_enumerator<EvaluationMethod>(method);
  if (!known) {
    return method;
  }
  switch (*known) {
  case EvaluationMethod::analogue:
    return "Sensor and reference are channels of one recording system with a common clock; "
           "magnitude and phase follow from sine approximation of both.";
  case EvaluationMethod::sample_timestamping:
    return "Every sample of the digital sensor has a time stamp; a synchronisation signal that "
           "both the sensor's acquisition unit and the reference system record links their "
           "clocks; magnitude and phase follow from sine approximation over the stamped samples.";
  case EvaluationMethod::series_timestamping:
    return "The digital sensor records a series of samples after a trigger; an oscilloscope "
           "records the synchronisation signal and the trigger; magnitude and phase follow from "
           "sine approximation over all series.";
  case EvaluationMethod::absolute_time:
    return "The samples of sensor and reference both have time stamps in UTC; magnitude and phase "
           "follow from sine approximation over the stamped samples.";
  }
  return method;
}

std::string frequency_range(const std::vector<StoredValue>& values) {
  if (values.empty()) {
    return "no frequency";
  }
  const auto [low, high] = std::minmax_element(
      values.begin(), values.end(),
      [](const StoredValue& a, const StoredValue& b) { return a.frequency_hz < b.frequency_hz; });
  return values.size() == 1 ? fmt::format("{} Hz", low->frequency_text_hz)
                            : fmt::format("{} values from {} Hz to {} Hz", values.size(),
                                          low->frequency_text_hz, high->frequency_text_hz);
}

} // namespace dyncal::inline views
