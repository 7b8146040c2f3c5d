#include "services/evaluation/channel_faults.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "analysis/base/chi_squared_limit.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double same_acceleration = 0.97; // a level is held to some per cent
constexpr std::size_t believed_steps = 2;  // chance, or an exciter that wanders, bends single ones
constexpr double excluded_at = 4.0;        // u
constexpr double excluded_loss = 0.5;
constexpr double visible_loss = 0.5;            // u of the magnitude
constexpr double alternates_quantile = 3.7;     // once in 10^4
constexpr double may_alternate_quantile = 2.33; // once in 100
constexpr double least_excess = 2.0;            // of q / n
constexpr double smallest_difference = 1e-4;    // as of one step

// Below an eighth of the sensor's rate: above, filters and folding may hide what is lost.
bool shows_harmonics(const StepResult& result) {
  const auto& integrity = result.fits.back().integrity;
  return integrity && integrity->shape.order_of_half_rate >= 4.0;
}

// q and the mean square beyond the noise.
struct Alternation {
  double n = 0.0;
  double q = 0.0;
  double largest = 0.0; // term of q
  double square = 0.0;
};

bool is_beyond(double q, double n, double quantile) {
  return n > 0.0 && q > n * std::max(least_excess, analysis::chi_squared_limit(n, quantile));
}

} // namespace

void ChannelFaults::add(const StepResult& result) {
  if (result.fits.empty()) {
    return;
  }
  Shown& shown = shown_[result.channel][{result.step, result.repetition}];
  if (result.attempt < shown.attempt) {
    return;
  }
  shown = {.attempt = result.attempt,
           .acceleration = result.fits.front().fit.amplitude(),
           .reference = result.fits.front().channel,
           .alternating = result.fits.back().scatter.alternating};
  if (has_flag(result.flags, ResultFlag::peaks_bent) &&
      !(result.peaks && result.peaks->of_either)) {
    shown.bent = result.peaks;
  }
}

std::optional<ChannelFaults::EndStop> ChannelFaults::end_stop(const std::string& bent) const {
  EndStop found;
  for (const auto& [channel, steps] : shown_) {
    for (const auto& [step, shown] : steps) {
      const double loss = shown.bent ? shown.bent->amplitude_error_rel : 0.0;
      if (loss == 0.0 || bent != (loss > 0.0 ? channel : shown.reference)) {
        continue;
      }
      const bool first = found.steps == 0;
      found.loss_rel = first ? std::abs(loss) : std::min(found.loss_rel, std::abs(loss));
      found.acceleration =
          first ? shown.acceleration : std::min(found.acceleration, shown.acceleration);
      ++found.steps;
    }
  }
  return found.steps >= believed_steps ? std::optional(found) : std::nullopt;
}

bool ChannelFaults::is_excluded(const EndStop& stop, bool is_sensor, const StepResult& result) {
  if (!result.peaks || !(result.peaks->u > 0.0)) {
    return false;
  }
  const double own = result.peaks->amplitude_error_rel * (is_sensor ? 1.0 : -1.0);
  return own + excluded_at * result.peaks->u < excluded_loss * stop.loss_rel;
}

void ChannelFaults::settle_peaks(const std::string& bent, bool is_sensor,
                                 StepResult& result) const {
  const auto stop = end_stop(bent);
  if (!stop || result.fits.front().fit.amplitude() < same_acceleration * stop->acceleration ||
      stop->loss_rel * result.magnitude < visible_loss * result.u_magnitude) {
    return;
  }
  if (shows_harmonics(result) && is_excluded(*stop, is_sensor, result)) {
    return;
  }
  result.flags.push_back(flag_of_channel(
      ResultFlag::peaks_bent, bent,
      fmt::format("not shown by this step, but by {} steps of {:.3g} m/s^2 and more, where {:.2g} "
                  "% of the amplitude and more are lost",
                  stop->steps, stop->acceleration, 100.0 * stop->loss_rel)));
}

void ChannelFaults::settle_alternation(StepResult& result) const {
  const auto channel = shown_.find(result.channel);
  if (channel == shown_.end()) {
    return;
  }
  Alternation all;
  double weights = 0.0;
  for (const auto& [step, shown] : channel->second) {
    const auto& [certain, d, u] = shown.alternating;
    if (u > 0.0) {
      const double term = std::pow(d / u, 2), weight = std::pow(u, -4);
      all.n += 1.0;
      all.q += term;
      all.largest = std::max(all.largest, term);
      all.square += weight * (d * d - u * u);
      weights += weight;
    }
  }
  if (!is_beyond(all.q, all.n, may_alternate_quantile)) {
    return;
  }
  const double difference = std::sqrt(std::max(0.0, all.square / weights));
  result.budget.push_back({.kind = analysis::ContributionKind::structure,
                           .subject = "the sensor, where every second value differs",
                           .repeats = analysis::Repeats::common,
                           .u_magnitude_rel = difference});
  result.u_magnitude = std::hypot(result.u_magnitude, difference * result.magnitude);
  if (difference > smallest_difference &&
      is_beyond(all.q - all.largest, all.n - 1.0, alternates_quantile)) {
    result.flags.push_back(flag_of_channel(
        ResultFlag::values_off_stamps, result.channel,
        fmt::format("over all steps, every second value is of a sine that differs by {:.2g} %: of "
                    "another sensor, or another gain",
                    200.0 * difference)));
  }
}

StepResult ChannelFaults::settled(StepResult result) const {
  if (!result.valid || result.fits.empty()) {
    return result;
  }
  if (!has_flag(result.flags, ResultFlag::peaks_bent)) {
    settle_peaks(result.channel, true, result);
    settle_peaks(result.fits.front().channel, false, result);
  }
  if (!has_flag(result.flags, ResultFlag::values_off_stamps)) {
    settle_alternation(result);
  }
  return result;
}

} // namespace dyncal::inline evaluation
