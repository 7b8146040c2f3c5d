#include "services/views/report/mean_check.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <map>
#include <numeric>
#include <vector>

#include <fmt/core.h>

#include "services/base/version.hpp"
#include "services/evaluation/mean_points.hpp"
#include "services/evaluation/outcome_agreement.hpp"

namespace dyncal::inline views {
namespace {

using SingleResults = std::vector<const StepResult*>;

// A method that gives no phase says NaN.
std::complex<double> phasor_of(double magnitude, double phase_rad) {
  return std::polar(magnitude, std::isnan(phase_rad) ? 0.0 : phase_rad);
}

FrequencyPoint point_of(const StoredValue& value) {
  FrequencyPoint point;
  point.frequency_text_hz = value.frequency_text_hz;
  point.frequency_hz = value.frequency_hz;
  point.level_m_s2 = value.level_m_s2;
  point.mean.magnitude = value.magnitude;
  point.mean.u_magnitude = 0.5 * value.of_magnitude.expanded;
  point.mean.phase_rad = value.phase_rad;
  point.mean.u_phase_rad = 0.5 * value.of_phase.expanded;
  return point;
}

bool lies_among(const StoredValue& value, const SingleResults& singles) {
  const std::complex<double> mean = phasor_of(value.magnitude, value.phase_rad);
  std::vector<std::complex<double>> phasors;
  double u = 0.0;
  for (const StepResult* single : singles) {
    phasors.push_back(phasor_of(single->magnitude, single->phase_rad));
    const double u_phase = std::isnan(single->u_phase_rad) ? 0.0 : single->u_phase_rad;
    u = std::max(u, std::hypot(single->u_magnitude, single->magnitude * u_phase));
  }
  const std::complex<double> centre =
      std::accumulate(phasors.begin(), phasors.end(), std::complex<double>()) /
      static_cast<double>(phasors.size());
  return std::any_of(phasors.begin(), phasors.end(), [&](const std::complex<double>& phasor) {
    return std::abs(mean - centre) <= std::abs(phasor - centre) + u;
  });
}

bool is_of_point(double frequency_hz, double level_m_s2, const StoredValue& value) {
  return frequency_hz == value.frequency_hz &&
         (level_m_s2 == value.level_m_s2 ||
          (std::isnan(level_m_s2) && std::isnan(value.level_m_s2)));
}

std::string text_of(const StoredValue& value) {
  return fmt::format("{} at {} Hz: |H| {:.6g}, phase {:.6g} rad", value.channel,
                     value.frequency_text_hz, value.magnitude, value.phase_rad);
}

std::optional<std::string> outlier(const std::vector<StoredValue>& values,
                                   const SingleResults& singles) {
  for (const StoredValue& value : values) {
    SingleResults of_point;
    std::copy_if(singles.begin(), singles.end(), std::back_inserter(of_point),
                 [&](const StepResult* single) {
                   return is_of_point(single->frequency_hz, single->level_m_s2, value);
                 });
    if (!of_point.empty() && !lies_among(value, of_point)) {
      return text_of(value);
    }
  }
  return std::nullopt;
}

std::optional<std::string> difference(const std::vector<StoredValue>& values,
                                      const SingleResults& singles) {
  const std::vector<FrequencyPoint> means = mean_points(singles);
  TransferFunction published;
  TransferFunction again;
  published.channel = values.front().channel;
  for (const StoredValue& value : values) {
    const auto own = std::find_if(means.begin(), means.end(), [&](const FrequencyPoint& mean) {
      return is_of_point(mean.frequency_hz, mean.level_m_s2, value);
    });
    if (own == means.end()) {
      return text_of(value);
    }
    published.points.push_back(point_of(value));
    again.points.push_back(*own);
  }
  const std::string found = mean_difference(published, again);
  return found.empty() ? std::nullopt : std::optional(found);
}

// A value or a U that is null is nobody's number; what needs one says so.
bool states_something(const StoredValue& value) {
  return std::isfinite(value.magnitude) && value.of_magnitude.expanded > 0.0 &&
         (std::isnan(value.phase_rad) || value.of_phase.expanded > 0.0);
}

std::optional<std::string> foreign_mean(const StoredResult& result) {
  std::map<std::string, std::vector<StoredValue>> values;
  for (const StoredValue& value : result.values) {
    if (states_something(value)) {
      values[value.channel].push_back(value);
    }
  }
  std::map<std::string, SingleResults> singles;
  for (const StoredPoint& point : result.points) {
    if (point.valid) {
      singles[point.channel].push_back(&point);
    }
  }
  const bool is_of_this_version = result.analysis_software == software_version();
  for (const auto& [channel, means] : values) {
    auto found =
        is_of_this_version ? difference(means, singles[channel]) : outlier(means, singles[channel]);
    if (found) {
      return found;
    }
  }
  return std::nullopt;
}

} // namespace

Expected<void> check_means(const StoredResult& result) {
  const auto foreign = foreign_mean(result);
  if (!foreign) {
    return {};
  }
  return fail(ErrorCode::no_result,
              fmt::format("{}: a mean is not that of its single results ({}): the file was "
                          "changed, or another program published as the analysis of its run",
                          result.file.string(), *foreign));
}

} // namespace dyncal::inline views
