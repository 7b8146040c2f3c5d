#include "analysis/method/neighbour_noise.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <vector>

#include "analysis/sine/line_projection.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::int64_t farthest = 10; // in lines of the grid, as lines keep from each other
constexpr std::int64_t step = 2;      // odd lines

std::vector<std::int64_t> unexcited_beside(std::int64_t line,
                                           const std::vector<std::int64_t>& excited) {
  std::vector<std::int64_t> beside;
  for (std::int64_t away = -farthest; away <= farthest; away += step) {
    if (line + away > 0 && std::ranges::find(excited, line + away) == excited.end()) {
      beside.push_back(line + away);
    }
  }
  return beside;
}

std::complex<double> relative(const LineOfChannel& channel, const Frequency& beside,
                              std::span<const double> rest) {
  return line_projection(beside, channel.origin_ns, channel.times_ns, rest) / channel.phasor;
}

} // namespace

double neighbour_noise_beyond(double stated, std::span<const Frequency> lines, std::size_t line,
                              double period_s, const LineOfChannel& reference,
                              const LineOfChannel& sensor) {
  std::vector<std::int64_t> excited;
  std::ranges::transform(lines, std::back_inserter(excited), [&](const Frequency& one) {
    return static_cast<std::int64_t>(std::llround(one.hz() * period_s));
  });
  const std::int64_t apart_ns =
      sensor.origin_ns + sensor.shift_ns - reference.origin_ns - reference.shift_ns;
  const auto rest_of_reference = without_trend(reference.rest);
  const auto rest_of_sensor = without_trend(sensor.rest);
  const auto beside = unexcited_beside(excited[line], excited);
  double squares = 0.0;
  for (const std::int64_t one : beside) {
    const Frequency frequency = Frequency::from_hz(static_cast<double>(one) / period_s);
    const double turned_rad =
        (frequency.angular() - lines[line].angular()) * 1e-9 * static_cast<double>(apart_ns);
    squares +=
        std::norm(relative(sensor, frequency, rest_of_sensor) -
                  relative(reference, frequency, rest_of_reference) * std::polar(1.0, turned_rad));
  }
  const double freedom = 2.0 * static_cast<double>(beside.size());
  return beside.empty() ? 0.0 : std::sqrt(std::max(0.0, squares / freedom - stated * stated));
}

} // namespace dyncal::analysis
