#include "services/evaluation/method/shape_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "services/evaluation/method/step_results.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double visible_error = 0.5;    // u of the magnitude, for bent peaks
constexpr double visible_delay = 0.1;    // u of the phase, for held values
constexpr double refused_bending = 1e-2; // of the amplitude: the knee is not known, U cannot cover
constexpr double refused_shortening = 0.1;
constexpr double batched_part = 0.2; // of the intervals: no clock does this

std::string percent(double part) {
  return fmt::format("{:.2g} %", 100.0 * part);
}

void add_flag(ResultFlag kind, const std::string& channel, const std::string& how_much,
              StepResult& result) {
  result.flags.push_back(flag_of_channel(kind, channel, how_much));
}

void check_stamps(const analysis::ChannelFit& fit, double u_magnitude_rel, double u_phase_rad,
                  StepResult& result) {
  const analysis::StampScatter& scatter = fit.scatter;
  const double correction = scatter.correction_rel();
  if (scatter.batched_part > batched_part) {
    add_flag(ResultFlag::values_off_stamps, fit.channel,
             percent(scatter.batched_part) + " of the stamps follow the one before at once",
             result);
  } else if (fit.integrity && fit.integrity->repeated_beyond_chance_part > 0.0) {
    const analysis::SignalIntegrity& integrity = *fit.integrity;
    const double turn_rad = std::numbers::pi / std::max(1.0, integrity.shape.order_of_half_rate);
    if (integrity.repeated_beyond_chance_part * turn_rad > visible_delay * u_phase_rad) {
      add_flag(ResultFlag::values_off_stamps, fit.channel,
               percent(integrity.repeated_beyond_chance_part) + " of the values are held", result);
    }
  } else if (scatter.far_off > 0) {
    add_flag(ResultFlag::values_off_stamps, fit.channel,
             fmt::format("{} of {} values are beside the sine of the others", scatter.far_off,
                         scatter.samples),
             result);
  } else if (scatter.alternating.certain_rel > 0.0) {
    add_flag(
        ResultFlag::values_off_stamps, fit.channel,
        fmt::format("every second value is of a sine that differs by {}: of another sensor, or "
                    "another gain",
                    percent(2.0 * scatter.alternating.certain_rel)),
        result);
  }
  if (correction > u_magnitude_rel) {
    add_flag(ResultFlag::stamps_scatter, fit.channel,
             "the sine is shortened by " + percent(correction), result);
  }
  if (scatter.peak_jumps > 0) {
    add_flag(ResultFlag::over_range, fit.channel,
             fmt::format("{} samples jump at the peaks", scatter.peak_jumps), result);
  }
  if (correction > refused_shortening) {
    add_refusal(
        fmt::format("the stamps of {} scatter by so much that {} of the sine are lost; take the "
                    "stamps closer to the sensor",
                    fit.channel, percent(correction)),
        result);
  }
}

// Held values have harmonics, too, and are flagged.
bool holds_values(const analysis::ChannelFit& fit) {
  return fit.integrity && fit.integrity->repeated_beyond_chance_part > 0.0;
}

void check_peaks(const std::string& reference_name, const std::string& channel,
                 const analysis::BentPeaks& peaks, StepResult& result, bool may_refuse = true) {
  result.peaks = peaks;
  const double error = std::abs(peaks.amplitude_error_rel);
  if (!peaks.found || !result.valid ||
      error * result.magnitude < visible_error * result.u_magnitude) {
    return;
  }
  const bool is_sensor = peaks.amplitude_error_rel > 0.0;
  const std::string& bent = is_sensor ? channel : reference_name;
  const std::string& other = is_sensor ? reference_name : channel;
  const double upper = std::abs(peaks.upper_rel), lower = std::abs(peaks.lower_rel);
  const char* where = upper > 3.0 * lower   ? "the upper ones"
                      : lower > 3.0 * upper ? "the lower ones"
                                            : "both";
  const std::string lost =
      fmt::format("{}, about {} of the amplitude is lost", where, percent(error));
  if (peaks.of_either) {
    add_flag(ResultFlag::peaks_bent, bent, fmt::format("{}; or those of {}", lost, other), result);
    add_flag(ResultFlag::peaks_bent, other, fmt::format("{}; or those of {}", lost, bent), result);
  } else {
    add_flag(ResultFlag::peaks_bent, bent, lost, result);
  }
  if (may_refuse && error > refused_bending) {
    add_refusal(
        fmt::format("the peaks of {} are bent, so that about {} of the amplitude is lost; lower "
                    "the level, or choose a wider range",
                    peaks.of_either ? fmt::format("{} or of {}", bent, other) : bent,
                    percent(error)),
        result);
  }
}

// Which quantity a voltage stands for nobody says.
std::span<const int> derivatives_of(const std::string& unit, bool is_differentiated) {
  return unit == R"(\one)" && !is_differentiated ? std::span<const int>(analysis::same_quantity)
                                                 : std::span<const int>(analysis::other_quantity);
}

// The mean of every order that all shots show.
analysis::SineShape mean_shape(std::span<const analysis::SineShape> shots) {
  analysis::SineShape mean = shots.front();
  mean.harmonics.clear();
  const double n = static_cast<double>(shots.size());
  for (const analysis::ShapeHarmonic& first : shots.front().harmonics) {
    analysis::ShapeHarmonic sum{first.order, {}, 0.0};
    std::size_t count = 0;
    for (const analysis::SineShape& shot : shots) {
      for (const analysis::ShapeHarmonic& one : shot.harmonics) {
        if (one.order == first.order) {
          sum.relative += one.relative / n;
          sum.u = std::hypot(sum.u, one.u / n);
          ++count;
        }
      }
    }
    if (count == shots.size()) {
      mean.harmonics.push_back(sum);
    }
  }
  return mean;
}

} // namespace

void check_shape(const analysis::ChannelFit& reference, bool is_differentiated,
                 const analysis::ChannelFit& sensor, StepResult& result) {
  if (!result.valid) {
    return;
  }
  const double u_magnitude_rel = result.u_magnitude / result.magnitude;
  const double u_phase_rad = result.u_phase_rad;
  check_stamps(reference, u_magnitude_rel, u_phase_rad, result);
  check_stamps(sensor, u_magnitude_rel, u_phase_rad, result);
  if (reference.integrity && sensor.integrity) {
    check_peaks(reference.channel, sensor.channel,
                analysis::find_bent_peaks(sensor.integrity->shape, reference.integrity->shape,
                                          derivatives_of(result.unit, is_differentiated)),
                result, !holds_values(sensor) && !holds_values(reference));
  }
}

void check_shape_of_shots(const analysis::ChannelFit& reference, bool is_differentiated,
                          const std::string& channel, std::span<const analysis::SineShape> shots,
                          StepResult& result) {
  if (result.valid && reference.integrity && !shots.empty()) {
    check_peaks(reference.channel, channel,
                analysis::find_bent_peaks(mean_shape(shots), reference.integrity->shape,
                                          derivatives_of(result.unit, is_differentiated)),
                result);
  }
}

} // namespace dyncal::inline evaluation
