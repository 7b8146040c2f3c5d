#include "services/programs/guard/reference_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "analysis/base/frequency.hpp"
#include "analysis/base/phasor.hpp"
#include "services/evaluation/record/channel_level.hpp"
#include "services/run/level_settling.hpp"

namespace dyncal::inline programs {
namespace {

constexpr double agreement_rel = 0.05;  // of the halves of a window: steady
constexpr double same_level_rel = 0.25; // less than an exciter that is off would leave
constexpr double max_fall_rel = 0.03;   // in 1.5 s: one that rings for 45 s and less falls more
constexpr double min_over_quiet = 2.0;  // less is hum that swings

double seconds(ReferenceWatch::Instant instant) {
  return std::chrono::duration<double>(instant.time_since_epoch()).count();
}

// By how much the phase of the later sine is beyond that of the earlier one at this frequency.
double phase_beyond(const SineOfPart& earlier, const SineOfPart& later,
                    const analysis::Frequency& frequency) {
  const double turns = frequency.reduced_turns(later.at_ns - earlier.at_ns);
  return analysis::wrap_phase(later.phase_rad - earlier.phase_rad - 2.0 * std::numbers::pi * turns);
}

double seconds_between(const SineOfPart& earlier, const SineOfPart& later) {
  return static_cast<double>(later.at_ns - earlier.at_ns) * 1e-9;
}

std::string text_of(double frequency_hz) {
  return fmt::format("{:.9g}", frequency_hz);
}

} // namespace

ReferenceWatch::ReferenceWatch(bus::Participant& participant, std::string bench,
                               ChannelName reference, const std::vector<double>& planned_hz,
                               std::shared_ptr<bus::WakeUp> wake_up)
    : participant_(participant), bench_(std::move(bench)), reference_(std::move(reference)),
      wake_up_(std::move(wake_up)) {
  for (const double frequency_hz : planned_hz) {
    longest_window_s_ = std::max(longest_window_s_, level_window_s(frequency_hz));
    if (frequency_hz >= 1.0) { // it does not hum below
      planned_hz_.push_back(text_of(frequency_hz));
    }
  }
}

// No longer than what is asked for, since all of it is held in memory.
double ReferenceWatch::kept_s(double frequency_hz) const {
  const double window_s = frequency_hz > 0.0 ? level_window_s(frequency_hz) : 0.0;
  return std::min(std::max(window_s, longest_window_s_) + level_slack_s,
                  LevelMeter::usually_kept_s);
}

void ReferenceWatch::look(Phase phase, double frequency_hz, Instant heard, Instant now) {
  if (phase == Phase::unwatched) {
    meter_.reset();
    phase_ = phase;
    still_driven_.clear();
    return;
  }
  if (!meter_) {
    auto meter = LevelMeter::create(participant_, bench_, reference_, wake_up_);
    if (!meter) {
      return; // it is tried again
    }
    meter_.emplace(std::move(*meter));
    quiet_m_s2_.clear();
  }
  meter_->take(seconds(now), kept_s(frequency_hz));
  if (phase == Phase::quiet && phase_ == Phase::off) {
    phase = Phase::off; // of the run before, which may still go on
  }
  if (phase != phase_ || (phase != Phase::off && frequency_hz != frequency_hz_)) {
    enter(phase, frequency_hz, now);
  }
  if (now >= next_look_) {
    next_look_ = now + interval;
    measure(heard, now);
  }
}

void ReferenceWatch::enter(Phase phase, double frequency_hz, Instant now) {
  if (phase == Phase::driven) {
    listen_for_hum();
    driven_m_s2_.reset();
    sine_.reset();
    rate_rad_s_ = 0.0;
    has_stopped_ = false;
    still_driven_.clear();
  }
  unconfirmed_.reset();
  after_m_s2_.clear();
  frequency_hz_ = phase == Phase::off && frequency_hz_ > 0.0 ? frequency_hz_ : frequency_hz;
  phase_ = phase;
  since_ = now;
  next_look_ = now + interval;
  has_listened_ = false;
}

// What was driven last may go on.
void ReferenceWatch::listen_for_hum() {
  if (has_listened_ || (phase_ != Phase::quiet && phase_ != Phase::off)) {
    return;
  }
  auto quiet = meter_->quiet_levels_after(seconds(since_), planned_hz_);
  if (!quiet) {
    return;
  }
  has_listened_ = true;
  if (phase_ == Phase::off) {
    quiet->erase(text_of(frequency_hz_));
  }
  for (const auto& [frequency, level_m_s2] : *quiet) {
    quiet_m_s2_.insert_or_assign(frequency, level_m_s2);
  }
}

void ReferenceWatch::measure(Instant heard, Instant now) {
  listen_for_hum();
  const auto frequency = analysis::Frequency::parse(text_of(frequency_hz_));
  if (!frequency || phase_ == Phase::quiet) {
    return;
  }
  const auto reading = meter_->level_after(seconds(since_), *frequency, agreement_rel);
  if (phase_ == Phase::off) {
    if (driven_m_s2_) {
      judge(reading ? *reading : LevelReading{}, *frequency);
    }
    return;
  }
  if (unconfirmed_ && heard >= unconfirmed_->at) {
    take_driven(unconfirmed_->reading, *frequency);
    unconfirmed_.reset();
  }
  if (reading && reading->level_m_s2 && !unconfirmed_) {
    unconfirmed_ = Look{now, *reading};
  }
}

void ReferenceWatch::take_driven(const LevelReading& reading,
                                 const analysis::Frequency& frequency) {
  driven_m_s2_ = reading.level_m_s2;
  if (sine_ && reading.sine.at_ns > sine_->at_ns) {
    rate_rad_s_ =
        phase_beyond(*sine_, reading.sine, frequency) / seconds_between(*sine_, reading.sine);
  }
  sine_ = reading.sine;
}

// With the sine that was driven; otherwise it has stopped.
bool ReferenceWatch::goes_on(const LevelReading& reading, const analysis::Frequency& frequency) {
  const double beyond = phase_beyond(*sine_, reading.sine, frequency) -
                        rate_rad_s_ * seconds_between(*sine_, reading.sine);
  const bool is_same = std::abs(std::polar(*reading.level_m_s2, beyond) - *driven_m_s2_) <=
                       same_level_rel * *driven_m_s2_;
  has_stopped_ = has_stopped_ || !is_same;
  if (!has_stopped_) {
    sine_ = reading.sine;
  }
  return !has_stopped_;
}

void ReferenceWatch::judge(const LevelReading& reading, const analysis::Frequency& frequency) {
  const auto quiet = quiet_m_s2_.find(text_of(frequency_hz_));
  const auto level_m_s2 = reading.level_m_s2;
  const bool is_same = level_m_s2 &&
                       std::abs(*level_m_s2 / *driven_m_s2_ - 1.0) <= same_level_rel &&
                       (quiet == quiet_m_s2_.end() ? goes_on(reading, frequency)
                                                   : *level_m_s2 > min_over_quiet * quiet->second);
  if (!is_same) {
    after_m_s2_.clear();
    still_driven_.clear();
    return;
  }
  after_m_s2_.push_back(*level_m_s2);
  if (after_m_s2_.size() > looks) {
    after_m_s2_.erase(after_m_s2_.begin());
  }
  if (after_m_s2_.size() == looks &&
      after_m_s2_.back() >= (1.0 - max_fall_rel) * after_m_s2_.front()) {
    still_driven_ = fmt::format("{} still shows the {:.3g} m/s^2 at {:.6g} Hz of the last step",
                                reference_.text(), *driven_m_s2_, frequency_hz_);
  } else if (after_m_s2_.size() == looks) {
    still_driven_.clear();
  }
}

} // namespace dyncal::inline programs
