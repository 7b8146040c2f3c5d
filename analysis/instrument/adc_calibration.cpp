#include "analysis/instrument/adc_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "analysis/base/phasor.hpp"
#include "analysis/base/statistics.hpp"
#include "analysis/instrument/curve_between_points.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

std::string number(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (!text.empty() && text.back() == '.') {
    text.pop_back();
  }
  return text;
}

bool same(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b));
}

bool by_amplitude_and_frequency(const AdcCalibrationPoint& a, const AdcCalibrationPoint& b) {
  if (!same(a.test_amplitude_vpp, b.test_amplitude_vpp)) {
    return a.test_amplitude_vpp < b.test_amplitude_vpp;
  }
  return a.frequency_hz < b.frequency_hz;
}

Expected<std::vector<AdcCalibrationPoint>>
of_one_amplitude(std::span<const AdcCalibrationPoint> points, std::optional<double> wanted_vpp) {
  if (points.empty()) {
    return fail(ErrorCode::invalid_argument, "the ADC calibration has no points");
  }
  double chosen = points.front().test_amplitude_vpp;
  for (const AdcCalibrationPoint& point : points) {
    if (!(point.frequency_hz > 0.0) || !(point.gain > 0.0) || !std::isfinite(point.phase_lag_rad)) {
      return fail(ErrorCode::invalid_argument,
                  "the ADC calibration has a point without frequency, gain or phase");
    }
    if (wanted_vpp) {
      if (std::abs(std::log(point.test_amplitude_vpp / *wanted_vpp)) <
          std::abs(std::log(chosen / *wanted_vpp))) {
        chosen = point.test_amplitude_vpp;
      }
    } else if (!same(point.test_amplitude_vpp, chosen)) {
      return fail(ErrorCode::invalid_argument,
                  "the ADC calibration has several test amplitudes (" + number(chosen) + " and " +
                      number(point.test_amplitude_vpp) + " Vpp): choose one");
    }
  }
  if (wanted_vpp && !(std::abs(std::log2(chosen / *wanted_vpp)) <= 1.0)) {
    return fail(ErrorCode::out_of_calibration,
                "the ADC was not calibrated near " + number(*wanted_vpp) +
                    " Vpp, the nearest test amplitude is " + number(chosen) + " Vpp");
  }
  std::vector<AdcCalibrationPoint> result;
  std::copy_if(
      points.begin(), points.end(), std::back_inserter(result),
      [&](const AdcCalibrationPoint& point) { return same(point.test_amplitude_vpp, chosen); });
  std::sort(result.begin(), result.end(), by_amplitude_and_frequency);
  return result;
}

struct FrontEnd { // g0 e^{-i w tau} / (1 + i f / fc); inverse_corner2 = 1 / fc^2
  double log_gain = 0.0;
  double delay_s = 0.0;
  double inverse_corner2 = 0.0;

  [[nodiscard]] double log_gain_at(double f) const {
    return log_gain - 0.5 * std::log1p(inverse_corner2 * f * f);
  }
  [[nodiscard]] double lag_at(double f) const {
    return 2.0 * pi * f * delay_s + std::atan(f * std::sqrt(inverse_corner2));
  }
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

// Between points i and i + 1; values and their u over frequencies f.
Interpolated interpolate(const std::vector<double>& f, const std::vector<double>& values,
                         const std::vector<double>& u, std::size_t i, double at) {
  const CurveValue curve = curve_between_points(f, values, i, at);
  const double weight = (at - f[i]) / (f[i + 1] - f[i]);
  return {curve.value, std::hypot((1.0 - weight) * u[i] + weight * u[i + 1],
                                  curve.missed / std::numbers::sqrt3)};
}

// Files have lags within a turn. Returns which intervals are ambiguous.
std::vector<bool> unwrap(std::vector<AdcCalibrationPoint>& points) {
  std::vector<double> f, lags;
  for (const AdcCalibrationPoint& point : points) {
    f.push_back(point.frequency_hz);
    lags.push_back(point.phase_lag_rad);
  }
  const UnwrappedPhases unwrapped = unwrap_over_frequency(f, lags);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].phase_lag_rad = unwrapped.phases_rad[i];
  }
  return unwrapped.ambiguous;
}

// Scatter differs by decades between 1 Hz and 100 kHz: each point takes it from this many points on
// either side.
constexpr std::size_t neighbours = 4;

std::span<const double> around(const std::vector<double>& values, std::size_t i) {
  const std::size_t begin = i > neighbours ? i - neighbours : 0;
  return std::span(values).subspan(begin, std::min(values.size(), i + neighbours + 1) - begin);
}

double median_around(const std::vector<double>& values, std::size_t i) {
  const std::span<const double> near = around(values, i);
  return median({near.begin(), near.end()});
}

// Distances of single points from the line through their neighbours, in standard deviations'
// measure; 0 at the ends.
std::vector<double> deviations_from_neighbours(const std::vector<double>& f,
                                               const std::vector<double>& values) {
  std::vector<double> deviations(f.size(), 0.0);
  for (std::size_t i = 1; i + 1 < f.size(); ++i) {
    const double weight = (f[i] - f[i - 1]) / (f[i + 1] - f[i - 1]);
    const double deviation = values[i] - (1.0 - weight) * values[i - 1] - weight * values[i + 1];
    deviations[i] =
        std::abs(deviation) / std::sqrt(1.0 + weight * weight + (1.0 - weight) * (1.0 - weight));
  }
  return deviations;
}

struct Group { // measurements of one frequency
  AdcCalibrationPoint mean;
  double count = 0.0;
  double gain_squares = 0.0; // of the relative deviations from the mean
  double phase_squares = 0.0;
};

// The lag of `point` within half a turn of another of the same frequency.
double lag_near(const AdcCalibrationPoint& other, const AdcCalibrationPoint& point) {
  return other.phase_lag_rad + wrap_phase(point.phase_lag_rad - other.phase_lag_rad);
}

std::vector<Group> gather(std::span<const AdcCalibrationPoint> sorted) {
  std::vector<Group> groups;
  for (std::size_t begin = 0; begin < sorted.size();) {
    Group group{.mean = sorted[begin]};
    std::size_t end = begin;
    double gain = 0.0, lag = 0.0;
    for (; end < sorted.size() && same(sorted[end].frequency_hz, group.mean.frequency_hz); ++end) {
      gain += sorted[end].gain;
      lag += lag_near(sorted[begin], sorted[end]);
      group.mean.u_gain = std::max(group.mean.u_gain, sorted[end].u_gain);
      group.mean.u_phase_lag_rad =
          std::max(group.mean.u_phase_lag_rad, sorted[end].u_phase_lag_rad);
      group.count += 1.0;
    }
    group.mean.gain = gain / group.count;
    group.mean.phase_lag_rad = lag / group.count;
    for (std::size_t i = begin; i < end; ++i) {
      group.gain_squares += std::pow(sorted[i].gain / group.mean.gain - 1.0, 2);
      group.phase_squares +=
          std::pow(lag_near(sorted[begin], sorted[i]) - group.mean.phase_lag_rad, 2);
    }
    groups.push_back(group);
    begin = end;
  }
  return groups;
}

std::vector<AdcCalibrationPoint>
points_of_one_amplitude(std::span<const AdcCalibrationPoint> sorted) {
  const std::vector<Group> groups = gather(sorted);
  std::vector<AdcCalibrationPoint> points;
  points.reserve(groups.size());
  std::vector<double> f, freedom, gain_squares, phase_squares, gains, lags;
  for (const Group& group : groups) {
    points.push_back(group.mean);
  }
  unwrap(points);
  const FrontEnd model = approximate(points);
  for (const Group& group : groups) {
    f.push_back(group.mean.frequency_hz);
    freedom.push_back(group.count - 1.0);
    gain_squares.push_back(group.gain_squares);
    phase_squares.push_back(group.phase_squares);
    gains.push_back(std::log(group.mean.gain) - model.log_gain_at(f.back()));
    lags.push_back(points[f.size() - 1].phase_lag_rad - model.lag_at(f.back()));
  }
  const auto sum = [](std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
  };
  const bool repeated = sum(freedom) >= 1.0;
  const std::vector<double> gain_deviations = deviations_from_neighbours(f, gains);
  const std::vector<double> lag_deviations = deviations_from_neighbours(f, lags);
  const auto scatter = [&](const std::vector<double>& squares,
                           const std::vector<double>& deviations, std::size_t i) {
    if (!repeated) {
      return f.size() < 3 ? 0.0 : mad_to_sd * median_around(deviations, i);
    }
    const double local = sum(around(freedom, i));
    return local >= 1.0 ? std::sqrt(sum(around(squares, i)) / local)
                        : std::sqrt(sum(squares) / sum(freedom));
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double root = std::sqrt(groups[i].count);
    points[i].u_gain = std::hypot(
        points[i].u_gain, points[i].gain * scatter(gain_squares, gain_deviations, i) / root);
    points[i].u_phase_lag_rad =
        std::hypot(points[i].u_phase_lag_rad, scatter(phase_squares, lag_deviations, i) / root);
  }
  return points;
}

} // namespace

Expected<AdcResponse> adc_response_at(std::span<const AdcCalibrationPoint> all_points,
                                      double frequency_hz,
                                      std::optional<double> test_amplitude_vpp) {
  DYNCAL_TRY(auto points, of_one_amplitude(all_points, test_amplitude_vpp));
  const double lowest = points.front().frequency_hz;
  const double highest = points.back().frequency_hz;
  if (!(frequency_hz >= lowest * (1.0 - 1e-9) && frequency_hz <= highest * (1.0 + 1e-9))) {
    return fail(ErrorCode::out_of_calibration,
                number(frequency_hz) +
                    " Hz is outside the range in which the ADC was calibrated, " + number(lowest) +
                    " Hz to " + number(highest) + " Hz");
  }
  if (points.size() == 1) {
    const AdcCalibrationPoint& only = points.front();
    return AdcResponse{only.gain, only.phase_lag_rad, only.u_gain, only.u_phase_lag_rad};
  }

  const auto twice =
      std::adjacent_find(points.begin(), points.end(), [](const auto& a, const auto& b) {
        return same(a.frequency_hz, b.frequency_hz);
      });
  if (twice != points.end()) {
    return fail(ErrorCode::invalid_argument,
                "the ADC calibration has " + number(twice->frequency_hz) +
                    " Hz twice: first make one point of repeated measurements");
  }
  const std::vector<bool> ambiguous = unwrap(points);
  const FrontEnd model = approximate(points);
  std::vector<double> f, gains, lags, u_gains, u_lags;
  for (const AdcCalibrationPoint& point : points) {
    f.push_back(point.frequency_hz);
    gains.push_back(std::log(point.gain) - model.log_gain_at(point.frequency_hz));
    lags.push_back(point.phase_lag_rad - model.lag_at(point.frequency_hz));
    u_gains.push_back(point.u_gain / point.gain);
    u_lags.push_back(point.u_phase_lag_rad);
  }
  const double at = std::clamp(frequency_hz, lowest, highest);
  const auto above = std::upper_bound(f.begin(), f.end() - 1, at);
  const std::size_t i =
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - f.begin(), 1)) - 1;
  const Interpolated gain = interpolate(f, gains, u_gains, i, at);
  const Interpolated lag = interpolate(f, lags, u_lags, i, at);
  AdcResponse response;
  response.gain = std::exp(gain.value + model.log_gain_at(at));
  response.u_gain = response.gain * gain.u;
  response.phase_lag_rad = lag.value + model.lag_at(at);
  const double weight = (at - f[i]) / (f[i + 1] - f[i]);
  response.u_phase_lag_rad =
      std::hypot(lag.u, ambiguous[i] ? ambiguous_phase_rad(weight) / std::numbers::sqrt3 : 0.0);
  return response;
}

std::vector<AdcCalibrationPoint>
adc_calibration_points(std::span<const AdcCalibrationPoint> measurements) {
  std::vector<AdcCalibrationPoint> sorted(measurements.begin(), measurements.end());
  std::stable_sort(sorted.begin(), sorted.end(), by_amplitude_and_frequency);
  std::vector<AdcCalibrationPoint> result;
  for (std::size_t begin = 0; begin < sorted.size();) {
    std::size_t end = begin;
    while (end < sorted.size() &&
           same(sorted[end].test_amplitude_vpp, sorted[begin].test_amplitude_vpp)) {
      ++end;
    }
    const auto points = points_of_one_amplitude(std::span(sorted).subspan(begin, end - begin));
    result.insert(result.end(), points.begin(), points.end());
    begin = end;
  }
  return result;
}

} // namespace dyncal::analysis
