#include "drivers/smartup/stamp_check.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/base/statistics.hpp"
#include "drivers/sample_block.hpp"

namespace dyncal::drivers::smartup {

namespace {

constexpr double second_ns = 1e9;
constexpr double ticks_per_second[] = {108e6, 100e6};
constexpr double ticks_of_extension = 4294967296.0;
constexpr double ticks_of_half = 65536.0;
constexpr double crystal_error =
    1e-4; // by which a number of ticks may differ from its nominal time

constexpr double phase_gain = 0.1;
constexpr double period_gain = 0.004; // damping 0.8: it settles without ringing
constexpr double residual_memory = 1.0 / 64.0;

constexpr double tolerance_in_periods = 0.25;
constexpr double max_plain_tolerance_ns = 200e3;
constexpr double tolerance_in_usual_residuals = 10.0;
constexpr double period_drift = 2e-5;            // relative, while the model runs free
constexpr double max_tolerance_in_periods = 0.5; // more than that is no jitter
constexpr double max_period_ns = 86400e9;
constexpr double max_lost_periods = 1000.0;
constexpr double whole_periods_part =
    1e-3; // of a period; of wrong stamps one in 500 is so by chance

constexpr double persistence_ns = 10e9;
constexpr std::uint64_t persistence_samples = 8;

bool is_close(double value, double target, double tolerance) {
  return std::abs(std::abs(value) - target) <= tolerance;
}

} // namespace

const char* to_string(StampFlag flag) {
  switch (flag) {
  case stamp_second_slip:
    return "stamp: second slipped";
  case stamp_counter_extension:
    return "stamp: 2^32 ticks off";
  case stamp_torn_counter:
    return "stamp: 2^16 ticks off";
  case stamp_offset_below_second:
    return "stamp: offset below a second";
  case stamp_repeated:
    return "stamp: repeated";
  case stamp_no_uncertainty:
    return "stamp: no uncertainty";
  case stamp_no_fix:
    return "stamp: no fix";
  case stamp_backwards:
    return "stamp: backwards";
  }
  return "stamp";
}

double StampCheck::residual_ns(const Stamp& stamp) const {
  const auto samples =
      static_cast<double>(static_cast<std::int64_t>(stamp.sample - origin_.sample));
  return static_cast<double>(stamp.stamp_ns - origin_.stamp_ns) - phase_ns_ - samples * period_ns_;
}

double StampCheck::tolerance_ns(const Stamp& stamp) const {
  const double plain = std::min(tolerance_in_periods * period_ns_, max_plain_tolerance_ns);
  const double free_running_ns = static_cast<double>(stamp.sample - origin_.sample) * period_ns_;
  const double tolerance = std::max(plain, tolerance_in_usual_residuals * usual_residual_ns_) +
                           period_drift * free_running_ns;
  return std::min(tolerance, max_tolerance_in_periods * period_ns_);
}

// The period is the median of the founders' steps and the phase the median of their distances from
// it, so that a fault among them does not count.
void StampCheck::found(const Stamp& stamp) {
  founders_[founder_count_++] = stamp;
  if (founder_count_ < founder_count) {
    return;
  }
  std::vector<double> periods;
  for (std::size_t i = 1; i < founder_count; ++i) {
    const auto samples = static_cast<double>(founders_[i].sample - founders_[i - 1].sample);
    periods.push_back(static_cast<double>(founders_[i].stamp_ns - founders_[i - 1].stamp_ns) /
                      samples);
  }
  period_ns_ = analysis::upper_median(periods);
  founder_count_ = 0;
  if (!(period_ns_ > 0.0 && period_ns_ < max_period_ns)) {
    return;
  }
  origin_ = stamp;
  phase_ns_ = 0.0;
  std::vector<double> residuals;
  for (const Stamp& founder : founders_) {
    residuals.push_back(residual_ns(founder));
  }
  phase_ns_ = analysis::upper_median(residuals);
  for (double& residual : residuals) {
    residual = std::abs(residual - phase_ns_);
  }
  usual_residual_ns_ = analysis::upper_median(residuals);
  distrusted_in_a_row_ = 0;
  founded_ = true;
}

std::uint8_t StampCheck::signature(double residual, double tolerance, const Stamp& stamp) const {
  const double seconds = std::round(std::abs(residual) / second_ns);
  for (const double rate : ticks_per_second) {
    const double extension_ns = ticks_of_extension / rate * second_ns;
    if (is_close(residual, extension_ns, tolerance + crystal_error * extension_ns)) {
      return stamp_counter_extension;
    }
    if (is_close(residual, ticks_of_half / rate * second_ns,
                 std::min(tolerance, max_plain_tolerance_ns / 10))) {
      return stamp_torn_counter;
    }
  }
  if (seconds >= 1.0 && is_close(residual, seconds * second_ns, tolerance)) {
    return stamp_second_slip;
  }
  if (has_last_ && stamp.stamp_ns < last_stamp_ns_) {
    return stamp_backwards;
  }
  return stamp_offset_below_second;
}

bool StampCheck::is_of_lost_samples(double residual) const {
  const double periods = std::round(residual / period_ns_);
  const double margin =
      std::max(tolerance_in_usual_residuals * usual_residual_ns_, whole_periods_part * period_ns_);
  return periods >= 1.0 && periods <= max_lost_periods &&
         std::abs(residual - periods * period_ns_) <=
             std::min(margin, tolerance_in_periods * period_ns_);
}

bool StampCheck::follows_from_last(const Stamp& stamp, double tolerance) const {
  const double expected_ns = static_cast<double>(stamp.sample - last_sample_) * period_ns_;
  return std::abs(static_cast<double>(stamp.stamp_ns - last_stamp_ns_) - expected_ns) <= tolerance;
}

// Whether stamps have been off for so long that the model must be wrong. The model is then founded
// again from the stamps to come.
bool StampCheck::lasts(const Stamp& stamp) {
  ++distrusted_in_a_row_;
  const double since_ns = static_cast<double>(stamp.sample - origin_.sample) * period_ns_;
  return distrusted_in_a_row_ >= persistence_samples && since_ns >= persistence_ns;
}

void StampCheck::follow(const Stamp& stamp, double residual) {
  const auto samples = static_cast<double>(stamp.sample - origin_.sample);
  // The new origin lies where the model expected this sample, moved a little towards where it was.
  const double correction = phase_gain * residual;
  const double predicted_from_stamp = -residual + correction;
  const double whole = std::round(predicted_from_stamp);
  origin_.sample = stamp.sample;
  origin_.stamp_ns = stamp.stamp_ns + static_cast<std::int64_t>(whole);
  phase_ns_ = predicted_from_stamp - whole;
  period_ns_ += period_gain * residual / samples;
  usual_residual_ns_ += residual_memory * (std::abs(residual) - usual_residual_ns_);
  distrusted_in_a_row_ = 0;
}

std::uint8_t StampCheck::check_against_model(const Stamp& stamp) {
  const double residual = residual_ns(stamp);
  const double tolerance = tolerance_ns(stamp);
  if (std::abs(residual) <= tolerance) {
    follow(stamp, residual);
    last_was_jump_ = false;
    return 0;
  }
  if (last_was_jump_ && follows_from_last(stamp, tolerance)) {
    origin_ = stamp; // the unit had paused, or lost samples
    phase_ns_ = 0.0;
    distrusted_in_a_row_ = 0;
    last_was_jump_ = false;
    return 0;
  }
  const std::uint8_t flag = signature(residual, tolerance, stamp);
  last_was_jump_ =
      (flag == stamp_offset_below_second && residual > second_ns) || is_of_lost_samples(residual);
  if (lasts(stamp)) {
    founded_ = false;
  }
  return flag;
}

std::uint8_t StampCheck::check(const Stamp& stamp) {
  unsigned flags = 0;
  if (stamp.time_uncertainty_ns == 0) {
    flags |= stamp_no_uncertainty;
  }
  if (stamp.no_fix) {
    flags |= stamp_no_fix; // its time says nothing about the model
  } else if (has_last_ && stamp.stamp_ns == last_stamp_ns_) {
    flags |= stamp_repeated;
  } else if (founded_) {
    flags |= check_against_model(stamp);
  } else {
    if (has_last_ && !last_no_fix_ && stamp.stamp_ns < last_stamp_ns_) {
      flags |= stamp_backwards;
    }
    found(stamp);
  }
  last_sample_ = stamp.sample;
  last_no_fix_ = stamp.no_fix;
  last_stamp_ns_ = stamp.stamp_ns;
  has_last_ = true;
  return static_cast<std::uint8_t>(flags);
}

} // namespace dyncal::drivers::smartup
