#include "analysis/adc_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

tl::unexpected<Error> failure(ErrorCode code, std::string message) {
  return tl::unexpected(Error{code, std::move(message)});
}

std::string number(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (!text.empty() && text.back() == '.') text.pop_back();
  return text;
}

bool same(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b));
}

bool by_amplitude_and_frequency(const AdcCalibrationPoint& a, const AdcCalibrationPoint& b) {
  if (!same(a.test_amplitude_vpp, b.test_amplitude_vpp)) return a.test_amplitude_vpp < b.test_amplitude_vpp;
  return a.frequency_hz < b.frequency_hz;
}

Expected<std::vector<AdcCalibrationPoint>> of_one_amplitude(std::span<const AdcCalibrationPoint> points, std::optional<double> wanted_vpp) {
  if (points.empty()) return failure(ErrorCode::invalid_argument, "the ADC calibration has no points");
  double chosen = points.front().test_amplitude_vpp;
  for (const AdcCalibrationPoint& point : points) {
    if (!(point.frequency_hz > 0.0) || !(point.gain > 0.0) || !std::isfinite(point.phase_lag_rad))
      return failure(ErrorCode::invalid_argument, "the ADC calibration has a point without frequency, gain or phase");
    if (wanted_vpp) {
      if (std::abs(std::log(point.test_amplitude_vpp / *wanted_vpp)) < std::abs(std::log(chosen / *wanted_vpp)))
        chosen = point.test_amplitude_vpp;
    } else if (!same(point.test_amplitude_vpp, chosen)) {
      return failure(ErrorCode::invalid_argument, "the ADC calibration has several test amplitudes (" + number(chosen) + " and " +
                                                      number(point.test_amplitude_vpp) + " Vpp), choose one");
    }
  }
  if (wanted_vpp && !(std::abs(std::log2(chosen / *wanted_vpp)) <= 1.0))
    return failure(ErrorCode::out_of_calibration, "the ADC was not calibrated near " + number(*wanted_vpp) +
                                                      " Vpp, the nearest test amplitude is " + number(chosen) + " Vpp");
  std::vector<AdcCalibrationPoint> result;
  std::copy_if(points.begin(), points.end(), std::back_inserter(result),
               [&](const AdcCalibrationPoint& point) { return same(point.test_amplitude_vpp, chosen); });
  std::sort(result.begin(), result.end(), by_amplitude_and_frequency);
  return result;
}

struct FrontEnd { // g0 e^{-i w tau} / (1 + i f / fc); inverse_corner2 = 1 / fc^2
  double log_gain = 0.0;
  double delay_s = 0.0;
  double inverse_corner2 = 0.0;

  [[nodiscard]] double log_gain_at(double f) const { return log_gain - 0.5 * std::log1p(inverse_corner2 * f * f); }
  [[nodiscard]] double lag_at(double f) const { return 2.0 * pi * f * delay_s + std::atan(f * std::sqrt(inverse_corner2)); }
};

FrontEnd approximate(const std::vector<AdcCalibrationPoint>& points) {
  double n = 0.0, x = 0.0, xx = 0.0, y = 0.0, xy = 0.0;
  const double scale = points.back().frequency_hz * points.back().frequency_hz;
  for (const AdcCalibrationPoint& point : points) {
    const double square = point.frequency_hz * point.frequency_hz / scale;
    const double inverse = 1.0 / (point.gain * point.gain);
    n += 1.0;
    x += square;
    xx += square * square;
    y += inverse;
    xy += square * inverse;
  }
  FrontEnd model;
  const double determinant = n * xx - x * x;
  const double slope = determinant > 0.0 ? (n * xy - x * y) / determinant : 0.0;
  const double start = (y - slope * x) / n;
  if (slope > 0.0 && start > 0.0) {
    model.log_gain = -0.5 * std::log(start);
    model.inverse_corner2 = slope / start / scale;
  } else {
    model.log_gain = -0.5 * std::log(y / n);
  }
  double fl = 0.0, ff = 0.0;
  for (const AdcCalibrationPoint& point : points) {
    fl += point.frequency_hz * (point.phase_lag_rad - model.lag_at(point.frequency_hz));
    ff += point.frequency_hz * point.frequency_hz;
  }
  model.delay_s = fl / ff / (2.0 * pi);
  return model;
}

struct Interpolated {
  double value = 0.0;
  double u = 0.0;
};

// Linear between points i and i + 1; values and their u over frequencies f.
Interpolated interpolate(const std::vector<double>& f, const std::vector<double>& values, const std::vector<double>& u, std::size_t i,
                         double at) {
  const double weight = (at - f[i]) / (f[i + 1] - f[i]);
  const auto second_difference = [&](std::size_t first) { // divided: half the curvature
    const double left = (values[first + 1] - values[first]) / (f[first + 1] - f[first]);
    const double right = (values[first + 2] - values[first + 1]) / (f[first + 2] - f[first + 1]);
    return std::abs(right - left) / (f[first + 2] - f[first]);
  };
  double curvature = 0.0;
  if (i > 0) curvature = second_difference(i - 1);
  if (i + 2 < f.size()) curvature = std::max(curvature, second_difference(i));
  const double missed = curvature * (at - f[i]) * (f[i + 1] - at) / std::sqrt(3.0);
  return {values[i] + weight * (values[i + 1] - values[i]),
          std::sqrt(std::pow((1.0 - weight) * u[i], 2) + std::pow(weight * u[i + 1], 2) + missed * missed)};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

// Standard deviation of single points from their distance to the line through their neighbours.
double scatter_about_neighbours(const std::vector<double>& f, const std::vector<double>& values) {
  std::vector<double> deviations;
  for (std::size_t i = 1; i + 1 < f.size(); ++i) {
    const double weight = (f[i] - f[i - 1]) / (f[i + 1] - f[i - 1]);
    const double deviation = values[i] - (1.0 - weight) * values[i - 1] - weight * values[i + 1];
    deviations.push_back(std::abs(deviation) / std::sqrt(1.0 + weight * weight + (1.0 - weight) * (1.0 - weight)));
  }
  return deviations.empty() ? 0.0 : 1.4826 * median(std::move(deviations));
}

// Repeated measurements of one frequency become their mean; u_* hold the sum of squared deviations until all are known.
struct Group {
  AdcCalibrationPoint mean;
  double count = 0.0;
};

std::vector<Group> gather(std::span<const AdcCalibrationPoint> sorted, double& gain_squares, double& phase_squares, double& freedom) {
  std::vector<Group> groups;
  for (std::size_t begin = 0; begin < sorted.size();) {
    std::size_t end = begin;
    Group group{sorted[begin], 0.0};
    double gain = 0.0, lag = 0.0;
    for (; end < sorted.size() && same(sorted[end].frequency_hz, group.mean.frequency_hz); ++end) {
      gain += sorted[end].gain;
      lag += sorted[end].phase_lag_rad;
      group.count += 1.0;
    }
    group.mean.gain = gain / group.count;
    group.mean.phase_lag_rad = lag / group.count;
    for (std::size_t i = begin; i < end; ++i) {
      gain_squares += std::pow(sorted[i].gain / group.mean.gain - 1.0, 2);
      phase_squares += std::pow(sorted[i].phase_lag_rad - group.mean.phase_lag_rad, 2);
    }
    freedom += group.count - 1.0;
    groups.push_back(group);
    begin = end;
  }
  return groups;
}

std::vector<AdcCalibrationPoint> points_of_one_amplitude(std::span<const AdcCalibrationPoint> sorted) {
  double gain_squares = 0.0, phase_squares = 0.0, freedom = 0.0;
  const std::vector<Group> groups = gather(sorted, gain_squares, phase_squares, freedom);
  std::vector<AdcCalibrationPoint> points;
  for (const Group& group : groups)
    points.push_back(group.mean);
  double gain_sd = 0.0, phase_sd = 0.0;
  if (freedom >= 1.0) {
    gain_sd = std::sqrt(gain_squares / freedom);
    phase_sd = std::sqrt(phase_squares / freedom);
  } else {
    const FrontEnd model = approximate(points);
    std::vector<double> f, gains, lags;
    for (const AdcCalibrationPoint& point : points) {
      f.push_back(point.frequency_hz);
      gains.push_back(std::log(point.gain) - model.log_gain_at(point.frequency_hz));
      lags.push_back(point.phase_lag_rad - model.lag_at(point.frequency_hz));
    }
    gain_sd = scatter_about_neighbours(f, gains);
    phase_sd = scatter_about_neighbours(f, lags);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].u_gain = points[i].gain * gain_sd / std::sqrt(groups[i].count);
    points[i].u_phase_lag_rad = phase_sd / std::sqrt(groups[i].count);
  }
  return points;
}

} // namespace

Expected<AdcResponse> adc_response_at(std::span<const AdcCalibrationPoint> all_points, double frequency_hz,
                                      std::optional<double> test_amplitude_vpp) {
  const auto points = of_one_amplitude(all_points, test_amplitude_vpp);
  if (!points) return tl::unexpected(points.error());
  const double lowest = points->front().frequency_hz;
  const double highest = points->back().frequency_hz;
  if (!(frequency_hz >= lowest * (1.0 - 1e-9) && frequency_hz <= highest * (1.0 + 1e-9)))
    return failure(ErrorCode::out_of_calibration, number(frequency_hz) + " Hz is outside the range in which the ADC was calibrated, " +
                                                      number(lowest) + " Hz to " + number(highest) + " Hz");
  if (points->size() == 1) {
    const AdcCalibrationPoint& only = points->front();
    return AdcResponse{only.gain, only.phase_lag_rad, only.u_gain, only.u_phase_lag_rad};
  }

  const FrontEnd model = approximate(*points);
  std::vector<double> f, gains, lags, u_gains, u_lags;
  for (const AdcCalibrationPoint& point : *points) {
    if (!f.empty() && same(point.frequency_hz, f.back()))
      return failure(ErrorCode::invalid_argument,
                     "the ADC calibration has " + number(point.frequency_hz) + " Hz twice, make one point of repeated measurements first");
    f.push_back(point.frequency_hz);
    gains.push_back(std::log(point.gain) - model.log_gain_at(point.frequency_hz));
    lags.push_back(point.phase_lag_rad - model.lag_at(point.frequency_hz));
    u_gains.push_back(point.u_gain / point.gain);
    u_lags.push_back(point.u_phase_lag_rad);
  }
  const double at = std::clamp(frequency_hz, lowest, highest);
  const auto above = std::upper_bound(f.begin(), f.end() - 1, at);
  const std::size_t i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - f.begin(), 1)) - 1;
  const Interpolated gain = interpolate(f, gains, u_gains, i, at);
  const Interpolated lag = interpolate(f, lags, u_lags, i, at);
  AdcResponse response;
  response.gain = std::exp(gain.value + model.log_gain_at(at));
  response.u_gain = response.gain * gain.u;
  response.phase_lag_rad = lag.value + model.lag_at(at);
  response.u_phase_lag_rad = lag.u;
  return response;
}

std::vector<AdcCalibrationPoint> adc_calibration_points(std::span<const AdcCalibrationPoint> measurements) {
  std::vector<AdcCalibrationPoint> sorted(measurements.begin(), measurements.end());
  std::stable_sort(sorted.begin(), sorted.end(), by_amplitude_and_frequency);
  std::vector<AdcCalibrationPoint> result;
  for (std::size_t begin = 0; begin < sorted.size();) {
    std::size_t end = begin;
    while (end < sorted.size() && same(sorted[end].test_amplitude_vpp, sorted[begin].test_amplitude_vpp))
      ++end;
    const auto points = points_of_one_amplitude(std::span(sorted).subspan(begin, end - begin));
    result.insert(result.end(), points.begin(), points.end());
    begin = end;
  }
  return result;
}

} // namespace dyncal::analysis
