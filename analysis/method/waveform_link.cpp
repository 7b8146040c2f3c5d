#include "analysis/method/waveform_link.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <string>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double visible = 4.0;         // u of a component
constexpr double grid_per_period = 8.0; // of the highest line
constexpr double worth_a_look = 0.8;    // of the best sum on the grid
constexpr double distinct_chi_squared = 25.0;
constexpr double no_converter_rad = 0.2; // more than any converter's response lacks

struct Difference { // of a line between two records
  double angular = 0.0;
  double phase_rad = 0.0;
  double weight = 0.0; // 1 / u^2; 0: the line is lost in noise
};

struct Offset {
  double tau_s = 0.0;
  double chi_squared = 0.0;
};

// The weighted mean about a start, whose phases are right but for less than half a turn.
Offset refined(const std::vector<Difference>& differences, double tau_s) {
  Offset offset{tau_s, 0.0};
  for (int pass = 0; pass < 3; ++pass) {
    double sum = 0.0;
    double weights = 0.0;
    offset.chi_squared = 0.0;
    for (const Difference& one : differences) {
      const double deviation = wrap_phase(one.phase_rad - one.angular * offset.tau_s);
      sum += one.weight * one.angular * deviation;
      weights += one.weight * one.angular * one.angular;
      offset.chi_squared += one.weight * deviation * deviation;
    }
    offset.tau_s += sum / weights;
    offset.chi_squared -= sum * sum / weights;
  }
  return offset;
}

// Every tau of the period for which the phases agree about as well as for the best.
std::vector<double> possible_offsets(const std::vector<Difference>& differences, double period_s) {
  double highest = 0.0;
  for (const Difference& one : differences) {
    highest = std::max(highest, one.angular);
  }
  const auto points =
      static_cast<std::size_t>(std::ceil(grid_per_period * period_s * highest / two_pi));
  const double step_s = period_s / static_cast<double>(points);
  std::vector<double> sums(points, 0.0);
  for (const Difference& one : differences) {
    std::complex<double> turning = std::polar(one.weight, one.phase_rad);
    const std::complex<double> step = std::polar(1.0, -one.angular * step_s);
    for (double& sum : sums) {
      sum += turning.real();
      turning *= step;
    }
  }
  const double best = *std::ranges::max_element(sums);
  std::vector<double> offsets;
  for (std::size_t i = 0; i < points; ++i) {
    const double before = sums[(i + points - 1) % points];
    const double behind = sums[(i + 1) % points];
    if (sums[i] >= worth_a_look * best && sums[i] >= before && sums[i] > behind) {
      offsets.push_back(static_cast<double>(i) * step_s);
    }
  }
  return offsets;
}

// The lines of one period again after this time at the latest: a part of it where they have a
// common divisor.
double common_period_s(std::span<const Frequency> lines, double period_s) {
  std::int64_t divisor = 0;
  for (const Frequency& line : lines) {
    divisor = std::gcd(divisor, std::llround(line.hz() * period_s));
  }
  return period_s / static_cast<double>(divisor);
}

Expected<std::vector<Difference>> differences_of(std::span<const Frequency> lines,
                                                 const SeparatedLines& first,
                                                 const SeparatedLines& second,
                                                 std::span<const double> lag_rad) {
  std::vector<Difference> differences;
  std::size_t usable = 0;
  for (std::size_t line = 0; line < lines.size(); ++line) {
    const LinePhasor& a = first.at(line, 0);
    const LinePhasor& b = second.at(line, 0);
    const double noise_a = a.u_component / std::abs(a.phasor);
    const double noise_b = b.u_component / std::abs(b.phasor);
    const bool shows = visible * noise_a < 1.0 && visible * noise_b < 1.0;
    differences.push_back({lines[line].angular(),
                           std::arg(b.phasor * std::conj(a.phasor)) + lag_rad[line],
                           shows ? 1.0 / (noise_a * noise_a + noise_b * noise_b) : 0.0});
    usable += shows ? 1 : 0;
  }
  if (usable < 2) {
    return fail(ErrorCode::no_excitation,
                "fewer than two lines of the multi-sine show in both sync signals");
  }
  return differences;
}

} // namespace

Expected<WaveformLink> link_waveforms(std::span<const Frequency> lines, double period_s,
                                      const SeparatedLines& first, const SeparatedLines& second,
                                      std::span<const double> lag_rad) {
  DYNCAL_TRY(const auto differences, differences_of(lines, first, second, lag_rad));
  const double common_s = common_period_s(lines, period_s);
  std::vector<Offset> offsets;
  for (const double tau_s : possible_offsets(differences, common_s)) {
    offsets.push_back(refined(differences, tau_s));
  }
  std::ranges::sort(offsets, {}, &Offset::chi_squared);
  const Offset& best = offsets.front();
  double weights = 0.0;
  double usable = 0.0;
  for (const Difference& one : differences) {
    weights += one.weight * one.angular * one.angular;
    usable += one.weight > 0.0 ? 1.0 : 0.0;
  }
  WaveformLink link;
  link.chi_squared = best.chi_squared / (usable - 1.0);
  // What is more than chance may be the same way round in all lines: then more of them help
  // nothing.
  const bool by_chance = link.chi_squared < chi_squared_limit(usable - 1.0, once_in_a_thousand);
  const double excess =
      std::max(1.0, by_chance ? link.chi_squared : std::max(best.chi_squared, link.chi_squared));
  if (offsets.size() > 1 && offsets[1].chi_squared - best.chi_squared <
                                distinct_chi_squared * std::max(1.0, link.chi_squared)) {
    return fail(ErrorCode::not_converged,
                "the sync signals of the two sources do not tell at which instant of the waveform "
                "each began: do both record the sync of this multi-sine?");
  }
  link.offset_s = best.tau_s - common_s * std::round(best.tau_s / common_s);
  link.u_offset_s = std::sqrt(excess / weights);
  for (const Difference& one : differences) {
    link.lines.push_back({wrap_phase(one.phase_rad - one.angular * best.tau_s),
                          one.weight > 0.0 ? 1.0 / std::sqrt(one.weight) : 0.0});
    const LinkedLine& line = link.lines.back();
    if (line.u_rad > 0.0 &&
        std::abs(line.deviation_rad) > std::max(no_converter_rad, visible * line.u_rad)) {
      return fail(ErrorCode::not_converged,
                  "the sync signals of the two sources do not show one waveform: at " +
                      std::to_string(one.angular / two_pi) + " Hz their phases are " +
                      std::to_string(std::abs(line.deviation_rad)) +
                      " rad from what the other lines tell; is sync the same signal at both, and "
                      "its converter's response right?");
    }
  }
  return link;
}

} // namespace dyncal::analysis
