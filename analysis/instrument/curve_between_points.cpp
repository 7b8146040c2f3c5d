#include "analysis/instrument/curve_between_points.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

constexpr double better = 0.8;          // times the misses of the straight line over frequency
constexpr double unknown_growth = 3.0;  // of a table of three points; 1 / f grows by 2 an octave
constexpr double below_both = 2.0;      // 1 / f lies as far again below the line over the logarithm
constexpr double most_growth = 4.0;     // of one that falls as 1 / f^2
constexpr double turns_back = 1.5;      // times what points that far apart still show of a wave
constexpr double crosses_at_once = 0.7; // of the largest rise: a wave of 7 points has 0.78
constexpr double peaks_at_once = 0.8;   // of 6 points at least 1, of 8 points 0.59
constexpr double least_span = 0.4;      // of a slope, in steps ahead: octaves have a half
constexpr double well_predicted_rad = 1.0; // then a slope is believed over more than half a turn
constexpr double most_step_rad = 0.75 * std::numbers::pi; // that nothing else predicts

// Divided, with its sign: half the curvature about the points first, first + 1, first + 2.
double bend(std::span<const double> x, std::span<const double> y, std::size_t first) {
  const double left = (y[first + 1] - y[first]) / (x[first + 1] - x[first]);
  const double right = (y[first + 2] - y[first + 1]) / (x[first + 2] - x[first + 1]);
  return (right - left) / (x[first + 2] - x[first]);
}

double second_difference(std::span<const double> x, std::span<const double> y, std::size_t first) {
  return std::abs(bend(x, y, first));
}

// How far the point first + 1 lies above the line through its neighbours.
double rise_above_neighbours(std::span<const double> x, std::span<const double> y,
                             std::size_t first) {
  return -bend(x, y, first) * (x[first + 1] - x[first]) * (x[first + 2] - x[first + 1]);
}

double misses(std::span<const double> x, std::span<const double> y) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 2 < x.size(); ++i) {
    sum += std::abs(rise_above_neighbours(x, y, i));
  }
  return sum;
}

// At an end, from the second difference beside it and the next one. A point of inflection beside
// the end shows no curvature, and that of the next is taken.
double at_end(double beside, double next) {
  if (next > most_growth * beside) {
    return next;
  }
  return beside * (next > 0.0 ? std::clamp(beside / next, 1.0, most_growth) : 1.0);
}

// How far points near an interval lie above the line through their neighbours: those that both
// sides of it tell, and `wider` more on either side.
std::vector<double> rises_near(std::span<const double> x, std::span<const double> y, std::size_t i,
                               std::size_t wider) {
  const std::size_t last = x.size() - 3;
  const std::size_t first = i > last ? last - std::min<std::size_t>(last, 2) : i < 2 ? 0 : i - 2;
  const std::size_t behind = std::min(last, i == 0 ? 2 : i + 1) + 1;
  std::vector<double> rises;
  for (std::size_t j = first - std::min(first, wider); j < std::min(last + 1, behind + wider);
       ++j) {
    rises.push_back(rise_above_neighbours(x, y, j));
  }
  return rises;
}

double largest_of(const std::vector<double>& rises) {
  double largest = 0.0;
  for (const double rise : rises) {
    largest = std::max(largest, std::abs(rise));
  }
  return largest;
}

bool lie_on_both_sides(const std::vector<double>& rises) {
  const auto [least, most] = std::minmax_element(rises.begin(), rises.end());
  return *least < 0.0 && *most > 0.0;
}

// Whether they go to the other side at once, or up and down again from point to point: a wave of
// fewer than seven points a period does, a curve that the table follows does not.
bool are_far_apart(const std::vector<double>& rises) {
  const double largest = largest_of(rises);
  for (std::size_t j = 0; j + 1 < rises.size(); ++j) {
    const double step = std::abs(rises[j + 1] - rises[j]);
    if (rises[j] * rises[j + 1] < 0.0 && step >= crosses_at_once * largest) {
      return true;
    }
    const bool is_peak = j > 0 && std::abs(rises[j]) >= std::abs(rises[j - 1]) &&
                         std::abs(rises[j]) >= std::abs(rises[j + 1]);
    if (is_peak &&
        std::abs(2.0 * rises[j] - rises[j - 1] - rises[j + 1]) >= peaks_at_once * largest) {
      return largest > 0.0;
    }
  }
  return false;
}

// Where points near the interval lie above and below the line through their neighbours, the curve
// turns back between its points, and the nearest second differences may miss the turn: the largest
// of those, one farther on either side too, in an interval as long as theirs. The same where these
// lie on one side, but with those next to them show that the points are far apart. Else 0.
double missed_at_a_turn(std::span<const double> x, std::span<const double> y, std::size_t i,
                        double weight) {
  std::vector<double> rises = rises_near(x, y, i, 0);
  if (!lie_on_both_sides(rises)) {
    rises = rises_near(x, y, i, 1);
    if (!are_far_apart(rises)) {
      return 0.0;
    }
  }
  return turns_back * largest_of(rises) * weight * (1.0 - weight);
}

double half_curvature(std::span<const double> x, std::span<const double> y, std::size_t i) {
  const std::size_t last = x.size() - 3; // of the second differences
  if (x.size() == 3) {
    return unknown_growth * second_difference(x, y, 0);
  }
  if (i == 0) {
    return at_end(second_difference(x, y, 0), second_difference(x, y, 1));
  }
  if (i > last) {
    return at_end(second_difference(x, y, last), second_difference(x, y, last - 1));
  }
  return std::max(second_difference(x, y, i - 1), second_difference(x, y, i));
}

// From the last of `unwrapped_rad` to the next point: by the slope before it, over a part that is
// not short beside the step; 0 where there is none.
double predicted_step(std::span<const double> frequencies_hz,
                      const std::vector<double>& unwrapped_rad) {
  const std::size_t last = unwrapped_rad.size() - 1;
  const double step_hz = frequencies_hz[last + 1] - frequencies_hz[last];
  for (std::size_t first = last; first-- > 0;) {
    const double span_hz = frequencies_hz[last] - frequencies_hz[first];
    if (span_hz >= least_span * step_hz) {
      return step_hz * (unwrapped_rad[last] - unwrapped_rad[first]) / span_hz;
    }
  }
  return 0.0;
}

} // namespace

CurveValue curve_between_points(std::span<const double> frequencies_hz,
                                std::span<const double> values, std::size_t i,
                                double frequency_hz) {
  std::vector<double> x(frequencies_hz.begin(), frequencies_hz.end());
  std::vector<double> logarithms = x;
  std::transform(x.begin(), x.end(), logarithms.begin(), [](double hz) { return std::log(hz); });
  double at = frequency_hz;
  const double log_weight = (std::log(at) - logarithms[i]) / (logarithms[i + 1] - logarithms[i]);
  if (misses(logarithms, values) < better * misses(x, values)) {
    x = std::move(logarithms);
    at = std::log(at);
  }
  CurveValue result;
  result.weight = (at - x[i]) / (x[i + 1] - x[i]);
  const double rise = values[i + 1] - values[i];
  result.value = values[i] + result.weight * rise;
  result.missed = x.size() > 2
                      ? std::max(half_curvature(x, values, i) * (at - x[i]) * (x[i + 1] - at),
                                 missed_at_a_turn(x, values, i, result.weight))
                      : below_both * std::abs((log_weight - result.weight) * rise);
  return result;
}

UnwrappedPhases unwrap_over_frequency(std::span<const double> frequencies_hz,
                                      std::span<const double> phases_rad) {
  UnwrappedPhases result;
  for (std::size_t i = 0; i < phases_rad.size(); ++i) {
    if (i == 0) {
      result.phases_rad.push_back(phases_rad[i]);
      continue;
    }
    const double before = result.phases_rad[i - 1];
    const double predicted = before + predicted_step(frequencies_hz, result.phases_rad);
    const double deviation = wrap_phase(phases_rad[i] - predicted);
    const double nearest = before + wrap_phase(phases_rad[i] - before);
    result.phases_rad.push_back(predicted + deviation);
    const bool disagree = std::abs(result.phases_rad[i] - nearest) > std::numbers::pi;
    result.ambiguous.push_back(std::abs(deviation) >
                               (disagree ? well_predicted_rad : most_step_rad));
  }
  return result;
}

double ambiguous_phase_rad(double weight) {
  return 2.0 * std::numbers::pi * std::clamp(std::min(weight, 1.0 - weight), 0.0, 0.5);
}

} // namespace dyncal::analysis
