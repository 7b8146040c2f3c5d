#include "analysis/response/response_start.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/base/phasor.hpp"
#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double range_in_spacings = 1.25;
constexpr int steps_per_turn = 8; // of the highest frequency
constexpr int max_steps = 10'000; // to either side of 0
constexpr double peak_below_best = 0.1;
constexpr std::size_t max_peaks = 6;
constexpr std::size_t max_starts = 9;
constexpr std::size_t max_starts_of_a_delay = 3;

struct Start {
  ResponseParameters parameters;
  double cost = 0.0;
};

struct DelayGrid {
  double step_s = 0.0;
  int steps = 0; // to either side
};

DelayGrid delay_grid(std::span<const ResponsePoint> points) {
  std::vector<double> frequencies;
  for (const ResponsePoint& point : points) {
    frequencies.push_back(point.frequency_hz);
  }
  std::sort(frequencies.begin(), frequencies.end());
  double spacing = frequencies.front();
  for (std::size_t i = 1; i < frequencies.size(); ++i) {
    const double difference = frequencies[i] - frequencies[i - 1];
    if (difference > 1e-9 * frequencies[i]) {
      spacing = std::min(spacing, difference);
    }
  }
  const double highest = frequencies.back();
  const double steps = std::ceil(range_in_spacings * steps_per_turn * highest / spacing);
  return {1.0 / (steps_per_turn * highest),
          static_cast<int>(std::min(steps, static_cast<double>(max_steps)))};
}

std::vector<double> geometric(double from, double to, double factor) {
  std::vector<double> values;
  for (double value = from; value < to * factor; value *= factor) {
    values.push_back(value);
  }
  return values;
}

// Responses of gain 1 without delay.
std::vector<ResponseParameters> shapes(ResponseKind kind, std::span<const ResponsePoint> points) {
  const auto [low, high] =
      std::minmax_element(points.begin(), points.end(), [](const auto& a, const auto& b) {
        return a.frequency_hz < b.frequency_hz;
      });
  const double lowest = low->frequency_hz, highest = high->frequency_hz;
  std::vector<ResponseParameters> result;
  std::vector<double> corners{0.0};
  if (has_first_order(kind)) {
    corners = has_second_order(kind) ? std::vector{0.5 * highest, 2.0 * highest, 10.0 * highest}
                                     : geometric(0.5 * lowest, 30.0 * highest, 1.5);
  }
  for (const double corner : corners) {
    if (!has_second_order(kind)) {
      result.push_back({.corner_hz = corner});
      continue;
    }
    for (const double resonance : geometric(0.7 * lowest, 10.0 * highest, 1.5)) {
      for (const double damping : {0.02, 0.1, 0.3, 0.7, 1.5}) {
        result.push_back({.corner_hz = corner, .resonance_hz = resonance, .damping = damping});
      }
    }
  }
  return result;
}

// What the measured phases have beyond those of a shape, with the weighted squares that remain.
class Phases {
public:
  Phases(std::span<const ResponsePoint> points, const ResponseParameters& shape) {
    for (const ResponsePoint& point : points) {
      beyond_.push_back(point.h / response_at(shape, point.frequency_hz));
      beyond_.back() /= std::abs(beyond_.back());
      w_.push_back(2.0 * pi * point.frequency_hz);
      weights_.push_back(1.0 / (point.u_phase_rad * point.u_phase_rad));
    }
  }

  [[nodiscard]] double cost(double delay_s, bool inverted) const {
    double squares = 0.0;
    for (std::size_t i = 0; i < w_.size(); ++i) {
      squares += weights_[i] * std::pow(difference(i, delay_s, inverted), 2);
    }
    return squares;
  }

  // The nearest minimum of cost().
  [[nodiscard]] double refined(double delay_s, bool inverted) const {
    for (int round = 0; round < 3; ++round) {
      double numerator = 0.0, denominator = 0.0;
      for (std::size_t i = 0; i < w_.size(); ++i) {
        numerator += weights_[i] * w_[i] * difference(i, delay_s, inverted);
        denominator += weights_[i] * w_[i] * w_[i];
      }
      delay_s -= numerator / denominator;
    }
    return delay_s;
  }

  // Mean cosine over the grid; negative for an inverted polarity.
  [[nodiscard]] std::vector<double> agreement(const DelayGrid& grid) const {
    std::vector<double> sums(2 * static_cast<std::size_t>(grid.steps) + 1, 0.0);
    for (std::size_t i = 0; i < w_.size(); ++i) {
      // cos(n d + e) by its recurrence: each value from the two before.
      const double turn = w_[i] * grid.step_s;
      const double first = std::arg(beyond_[i]) - turn * grid.steps;
      const double factor = 2.0 * std::cos(turn), weight = 1.0 / static_cast<double>(w_.size());
      double before = weight * std::cos(first - turn), here = weight * std::cos(first);
      for (double& sum : sums) {
        sum += here;
        before = std::exchange(here, factor * here - before);
      }
    }
    return sums;
  }

private:
  [[nodiscard]] double difference(std::size_t i, double delay_s, bool inverted) const {
    return wrap_phase(std::arg(beyond_[i]) + w_[i] * delay_s - (inverted ? pi : 0.0));
  }

  std::vector<std::complex<double>> beyond_;
  std::vector<double> w_;
  std::vector<double> weights_;
};

// Places of the peaks of |agreement| that come near the highest, highest first.
std::vector<std::size_t> peaks_of(const std::vector<double>& agreement) {
  std::vector<std::size_t> peaks;
  double best = 0.0;
  for (std::size_t k = 0; k < agreement.size(); ++k) {
    const double here = std::abs(agreement[k]);
    const double before = k > 0 ? std::abs(agreement[k - 1]) : 0.0;
    const double after = k + 1 < agreement.size() ? std::abs(agreement[k + 1]) : 0.0;
    if (here >= before && here >= after) {
      peaks.push_back(k);
      best = std::max(best, here);
    }
  }
  std::erase_if(peaks,
                [&](std::size_t k) { return std::abs(agreement[k]) < best - peak_below_best; });
  std::stable_sort(peaks.begin(), peaks.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(agreement[a]) > std::abs(agreement[b]);
  });
  peaks.resize(std::min(peaks.size(), max_peaks));
  return peaks;
}

// Gain of the shape (by the median, so that a wrong point does not decide), and the weighted
// squares of the magnitudes about it.
Start with_gain(ResponseParameters shape, std::span<const ResponsePoint> points) {
  std::vector<double> log_ratios;
  for (const ResponsePoint& point : points) {
    log_ratios.push_back(std::log(std::abs(point.h / response_at(shape, point.frequency_hz))));
  }
  const double log_gain = median(log_ratios);
  double squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    squares += std::pow((log_ratios[i] - log_gain) / points[i].u_magnitude_rel, 2);
  }
  shape.gain = std::exp(log_gain);
  return {shape, squares};
}

void add_starts(ResponseKind kind, const ResponseParameters& shape,
                std::span<const ResponsePoint> points, const DelayGrid& grid,
                std::vector<Start>& starts) {
  const Phases phases(points, shape);
  const Start plain = with_gain(shape, points);
  const auto add = [&](double delay_s, bool inverted) {
    Start start = plain;
    start.parameters.delay_s = delay_s;
    start.parameters.gain *= inverted ? -1.0 : 1.0;
    start.cost += phases.cost(delay_s, inverted);
    starts.push_back(start);
  };
  if (!has_delay(kind)) {
    add(0.0, false);
    add(0.0, true);
    return;
  }
  const std::vector<double> agreement = phases.agreement(grid);
  for (const std::size_t peak : peaks_of(agreement)) {
    const double delay_s = (static_cast<double>(peak) - grid.steps) * grid.step_s;
    const bool inverted = agreement[peak] < 0.0;
    add(phases.refined(delay_s, inverted), inverted);
  }
}

} // namespace

std::vector<ResponseParameters> response_starts(ResponseKind kind,
                                                std::span<const ResponsePoint> points) {
  const DelayGrid grid = delay_grid(points);
  std::vector<Start> starts;
  for (const ResponseParameters& shape : shapes(kind, points)) {
    add_starts(kind, shape, points, grid, starts);
  }
  std::stable_sort(starts.begin(), starts.end(),
                   [](const Start& a, const Start& b) { return a.cost < b.cost; });
  const double alike_s = 4.0 * grid.step_s; // half a turn of the highest frequency
  std::vector<ResponseParameters> chosen;
  for (const Start& start : starts) {
    const auto alike =
        std::count_if(chosen.begin(), chosen.end(), [&](const ResponseParameters& other) {
          return std::abs(other.delay_s - start.parameters.delay_s) < alike_s &&
                 (other.gain < 0.0) == (start.parameters.gain < 0.0);
        });
    if (static_cast<std::size_t>(alike) < max_starts_of_a_delay) {
      chosen.push_back(start.parameters);
    }
    if (chosen.size() == max_starts) {
      break;
    }
  }
  return chosen;
}

} // namespace dyncal::analysis
