#include "analysis/step/peak_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace dyncal::analysis {
namespace {

using Complex = std::complex<double>;

constexpr int max_harmonic = 10;
constexpr double resolved = 1.5; // distance of lines in 1 / T
// Of folded lines from the signal: an exciter whose level wanders has sidebands, which the
// reference with its higher rate shows at other orders or at none.
constexpr double sidebands_hz = 10.0;
constexpr double min_periods = 4.0;
constexpr std::size_t min_orders = 2;
constexpr std::array widths_rad{0.1, 0.2, 0.35, 0.6, 0.9};
constexpr std::array close_widths_rad{0.1, 0.14, 0.2, 0.24, 0.29, 0.35, 0.42, 0.5, 0.6, 0.75, 0.9};
constexpr double response_unknown = 0.15; // of H(kf) / H(f), at low frequencies
constexpr double second_of_sensor = 3e-3; // of its own: a good sensor's square term
constexpr double third_of_sensor = 1e-3;  // cubic term
constexpr double higher_of_sensor = 1e-4;
constexpr double certain = 4.0; // u: 6e-5 a trial, and about five independent ones a step
constexpr double explained = 0.4;
constexpr double passed_place = 0.5; // of half the rate: what sensors let pass
constexpr double anywhere = std::numeric_limits<double>::infinity(); // also what is folded
constexpr double confirmed = 0.25; // of a harmonic of the reference, at least, by the sensor
// Of a reference by itself, where the sensor shows none: so many orders in the phases and parts
// that an end stop gives them, but for a tenth, are no exciter's.
constexpr std::size_t unmistakable_orders = 4;
constexpr double unmistakable_explained = 0.9;
constexpr double tolerated = 0.1;  // of each order
constexpr double stands_out = 5.0; // u

// E_k of a peak as wide as `d` to either side.
double lost_at(int k, double d) {
  if (k == 1) {
    return (d - std::sin(d) * std::cos(d)) / std::numbers::pi;
  }
  const double below = k - 1, above = k + 1;
  return (std::sin(below * d) / below + std::sin(above * d) / above -
          2.0 * std::cos(d) * std::sin(k * d) / k) /
         std::numbers::pi;
}

// -i (-i)^k, of the upper peak; the lower one has the conjugate.
Complex turn_of(int k) {
  constexpr std::array<Complex, 4> turns{Complex(0.0, -1.0), Complex(-1.0, 0.0), Complex(0.0, 1.0),
                                         Complex(1.0, 0.0)};
  return turns[static_cast<std::size_t>(k % 4)];
}

struct Excess {
  int order;
  Complex value;
  double u;
};

double own_part(int order) {
  return order == 2 ? second_of_sensor : order == 3 ? third_of_sensor : higher_of_sensor;
}

// What the sensor has beyond the reference, at the orders that both show.
std::vector<Excess> excess_of(const SineShape& sensor, const SineShape& reference) {
  std::vector<Excess> excess;
  for (const ShapeHarmonic& one : sensor.harmonics) {
    const auto same =
        std::find_if(reference.harmonics.begin(), reference.harmonics.end(),
                     [&](const ShapeHarmonic& other) { return other.order == one.order; });
    if (same == reference.harmonics.end()) {
      continue;
    }
    const double place = one.order / std::max(1.0, sensor.order_of_half_rate);
    const double response = (response_unknown + place * place) * std::abs(same->relative);
    const double steps = std::hypot(sensor.steps_rel, reference.steps_rel);
    const double u = std::hypot(std::hypot(one.u, same->u), std::hypot(response, steps));
    excess.push_back(
        {one.order, one.relative - same->relative, std::hypot(u, own_part(one.order))});
  }
  return excess;
}

double chi_squared_of(const std::vector<Excess>& excess) {
  double sum = 0.0;
  for (const Excess& one : excess) {
    sum += std::norm(one.value / one.u);
  }
  return sum;
}

struct Match {
  BentPeaks peaks;
  double gain = 0.0; // of chi-squared
};

enum class Ends { both, upper, lower, each }; // alike; one alone; both, each by its own amount

// Weighted least squares with the losses at the peaks as unknowns.
Match match_of(const std::vector<Excess>& excess, double width_rad, Ends ends) {
  // Rows t_+ and t_- of the design, real and imaginary parts apart.
  double pp = 0.0, pm = 0.0, mm = 0.0, py = 0.0, my = 0.0;
  for (const Excess& one : excess) {
    const double size = lost_at(one.order, width_rad) / lost_at(1, width_rad) / one.u;
    const Complex up = size * turn_of(one.order), down = std::conj(up);
    const Complex y = one.value / one.u;
    pp += std::norm(up);
    mm += std::norm(down);
    pm += (up * std::conj(down)).real();
    py += (up * std::conj(y)).real();
    my += (down * std::conj(y)).real();
  }
  Match match;
  BentPeaks& peaks = match.peaks;
  if (ends == Ends::each) {
    const double determinant = pp * mm - pm * pm;
    if (!(determinant > 1e-3 * pp * mm)) {
      return match;
    }
    peaks.upper_rel = (py * mm - my * pm) / determinant;
    peaks.lower_rel = (my * pp - py * pm) / determinant;
    if (peaks.upper_rel * peaks.lower_rel < 0.0) { // one bent out, one bent in: no end stop
      return match;
    }
    peaks.u = std::sqrt((pp + mm - 2.0 * pm) / determinant);
    match.gain = peaks.upper_rel * py + peaks.lower_rel * my;
  } else {
    const double upper = ends == Ends::lower ? 0.0 : ends == Ends::upper ? 1.0 : 0.5;
    const double lower = ends == Ends::both ? 0.5 : 1.0 - upper;
    const double square = upper * upper * pp + lower * lower * mm + 2.0 * upper * lower * pm;
    const double product = upper * py + lower * my;
    if (!(square > 0.0)) {
      return match;
    }
    peaks.upper_rel = upper * product / square;
    peaks.lower_rel = lower * product / square;
    peaks.u = 1.0 / std::sqrt(square);
    match.gain = product * product / square;
  }
  peaks.amplitude_error_rel = peaks.upper_rel + peaks.lower_rel;
  return match;
}

Match best_match(const std::vector<Excess>& excess, std::span<const double> widths) {
  Match best;
  for (const double width_rad : widths) {
    for (const Ends ends : {Ends::both, Ends::upper, Ends::lower, Ends::each}) {
      const Match match = match_of(excess, width_rad, ends);
      const double handicap = ends == Ends::each ? 4.0 : 0.0; // of one more unknown
      if (match.gain > best.gain + handicap) {
        best = match;
      }
    }
  }
  return best;
}

BentPeaks judged(const std::vector<Excess>& excess, std::span<const double> widths = widths_rad,
                 double least_explained = explained) {
  const double all = chi_squared_of(excess);
  Match best = best_match(excess, widths);
  const double noise = 2.0 * static_cast<double>(excess.size());
  BentPeaks& peaks = best.peaks;
  peaks.found = std::abs(peaks.amplitude_error_rel) > certain * peaks.u &&
                best.gain > least_explained * (all - noise) && best.gain > certain * certain;
  return peaks;
}

// Peaks that nothing but an end stop bends so.
BentPeaks flat_top(const SineShape& shape) {
  std::vector<Excess> excess;
  std::size_t strong = 0;
  for (const ShapeHarmonic& one : shape.harmonics) {
    const double size = std::abs(one.relative);
    const double u = std::hypot(one.u, shape.steps_rel, higher_of_sensor);
    strong += size > stands_out * u ? 1 : 0;
    excess.push_back({one.order, -one.relative, std::hypot(u, tolerated * size)});
  }
  return strong >= unmistakable_orders ? judged(excess, close_widths_rad, unmistakable_explained)
                                       : BentPeaks{};
}

// Whether the sensor, up to this part of half its rate, shows nothing of the reference's harmonics.
bool lacks_harmonics_of(const SineShape& sensor, const SineShape& reference, double place) {
  double shown = 0.0, square = 0.0, u2 = 0.0;
  for (const ShapeHarmonic& one : sensor.harmonics) {
    for (const ShapeHarmonic& other : reference.harmonics) {
      if (other.order == one.order && one.order <= place * sensor.order_of_half_rate) {
        shown += (one.relative * std::conj(other.relative)).real();
        square += std::norm(other.relative);
        u2 += std::norm(other.relative) * one.u * one.u;
      }
    }
  }
  return square > 0.0 && shown + certain * std::sqrt(u2) < confirmed * square;
}

// Beyond noise, in the orders that both show.
bool sensor_has_more(const SineShape& sensor, const SineShape& reference) {
  double more = 0.0;
  for (const ShapeHarmonic& one : sensor.harmonics) {
    for (const ShapeHarmonic& other : reference.harmonics) {
      if (other.order == one.order) {
        more += std::norm(one.relative) - std::norm(other.relative) -
                2.0 * (one.u * one.u - other.u * other.u);
      }
    }
  }
  return more > 0.0;
}

std::vector<Excess> own_shape(const SineShape& shape) {
  std::vector<Excess> excess;
  for (const ShapeHarmonic& one : shape.harmonics) {
    const double u = std::hypot(one.u, shape.steps_rel);
    excess.push_back({one.order, -one.relative, std::hypot(u, own_part(one.order))});
  }
  return excess;
}

// By itself, where orders that the sensor does not show tell it.
BentPeaks bent_reference(const SineShape& sensor, const SineShape& reference) {
  const bool lacks = lacks_harmonics_of(sensor, reference, passed_place);
  if (!lacks && !lacks_harmonics_of(sensor, reference, anywhere)) {
    return {};
  }
  const BentPeaks peaks = lacks ? judged(own_shape(reference)) : flat_top(reference);
  return peaks.amplitude_error_rel < 0.0 ? peaks : BentPeaks{};
}

SineShape derivative_of(SineShape shape, int order) {
  if (order == 0) {
    return shape;
  }
  for (ShapeHarmonic& one : shape.harmonics) {
    const double larger = std::pow(one.order, order);
    one.relative *= std::polar(larger, 0.5 * std::numbers::pi * order * (1 - one.order));
    one.u = std::hypot(one.u, shape.steps_rel) * larger;
  }
  shape.steps_rel = 0.0;
  return shape;
}

// Both as the sensor would show them, and both as the reference would.
BentPeaks bent_where_derived(const SineShape& sensor, const SineShape& reference, int order) {
  const SineShape reference_there = derivative_of(reference, order);
  const SineShape sensor_here = derivative_of(sensor, -order);
  BentPeaks peaks = judged(excess_of(sensor, reference_there));
  if (peaks.found && peaks.amplitude_error_rel > 0.0) {
    peaks.of_either = !sensor_has_more(sensor, reference_there);
    return peaks;
  }
  BentPeaks of_reference = judged(excess_of(sensor_here, reference));
  if (of_reference.found && of_reference.amplitude_error_rel < 0.0) {
    of_reference.of_either = sensor_has_more(sensor_here, reference);
    return of_reference;
  }
  of_reference = bent_reference(sensor_here, reference);
  peaks.found = false;
  return of_reference.found ? of_reference : peaks;
}

} // namespace

std::vector<int> resolved_harmonics(double frequency_hz, double duration_s, double rate_hz) {
  const auto folded = [rate_hz](double hz) {
    return std::abs(hz - rate_hz * std::round(hz / rate_hz));
  };
  const double signal = folded(frequency_hz);
  std::vector<double> taken{0.0, signal};
  std::vector<int> orders;
  for (int k = 2; k <= max_harmonic; ++k) {
    const double line = folded(k * frequency_hz);
    const bool beside_signal =
        k * frequency_hz > 0.5 * rate_hz && std::abs(line - signal) < sidebands_hz;
    const bool apart = !beside_signal && std::all_of(taken.begin(), taken.end(), [&](double other) {
      return std::abs(line - other) * duration_s > resolved;
    });
    if (apart && (0.5 * rate_hz - line) * duration_s > 0.5 * resolved) {
      taken.push_back(line);
      orders.push_back(k);
    }
  }
  return orders;
}

SineShape sine_shape(const Frequency& frequency, const PlainChannel& channel,
                     std::span<const std::int64_t> stamps_ns, std::span<const int> orders,
                     double step, double noise_sd) {
  const double duration_s = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  const double amplitude = channel.fit.amplitude();
  SineShape shape;
  shape.periods = frequency.hz() * duration_s;
  shape.order_of_half_rate =
      0.5 * static_cast<double>(stamps_ns.size() - 1) / std::max(shape.periods, 1e-12);
  if (step > 0.0) {
    const double hidden = std::numbers::pi * noise_sd / step;
    shape.steps_rel = std::pow(step / amplitude, 1.5) / (std::numbers::pi * std::numbers::pi) *
                      std::exp(-2.0 * hidden * hidden);
  }
  const Complex back =
      std::conj(Complex(channel.fit.sine, channel.fit.cosine)) / std::max(amplitude, 1e-300);
  for (const HarmonicLine& one : channel.harmonics) {
    if (std::find(orders.begin(), orders.end(), one.order) == orders.end()) {
      continue;
    }
    const SineFit& fit = one.line.fit;
    shape.harmonics.push_back(
        {one.order, Complex(fit.sine, fit.cosine) * std::pow(back, one.order) / amplitude,
         std::sqrt(std::max(fit.covariance[0], fit.covariance[3])) / amplitude});
  }
  return shape;
}

BentPeaks find_bent_peaks(const SineShape& sensor, const SineShape& reference,
                          std::span<const int> derivatives) {
  if (excess_of(sensor, reference).size() < min_orders || sensor.periods < min_periods) {
    return {};
  }
  std::optional<BentPeaks> least;
  for (const int order : derivatives) {
    const BentPeaks peaks = bent_where_derived(sensor, reference, order);
    if (!peaks.found) {
      return peaks;
    }
    if (!least || std::abs(peaks.amplitude_error_rel) < std::abs(least->amplitude_error_rel)) {
      least = peaks;
    }
  }
  return least.value_or(BentPeaks{});
}

} // namespace dyncal::analysis
