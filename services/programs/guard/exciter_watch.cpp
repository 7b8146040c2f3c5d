#include "services/programs/guard/exciter_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dyncal::inline programs {
namespace {

constexpr double rounding_rel = 1e-3; // of a generator to its resolution

bool is_same(double a, double b) {
  return std::abs(a - b) <= rounding_rel * std::max(std::abs(a), std::abs(b));
}

// What one of them does not say differs in nothing.
bool is_same(const std::optional<double>& a, const std::optional<double>& b) {
  return !a || !b || is_same(*a, *b);
}

bool is_same(const OutputSettings& a, const OutputSettings& b) {
  return is_same(a.frequency_hz, b.frequency_hz) && is_same(a.voltage_vpp, b.voltage_vpp);
}

bool is_among(const OutputSettings& settings, const std::vector<OutputSettings>& all) {
  return std::any_of(all.begin(), all.end(),
                     [&](const OutputSettings& one) { return is_same(one, settings); });
}

} // namespace

ExciterWatch::ExciterWatch(std::vector<OutputSettings> planned, DrivenRun recorded, Instant now)
    : planned_(std::move(planned)), run_(std::move(recorded)), heard_(now),
      is_from_record_(!run_.run.empty()), next_question_(now) {
  if (is_from_record_ && run_.has_ended) {
    step_to(run_.is_conducted ? State::begins : State::ended, now);
  } else if (is_from_record_) {
    step_to(State::driven, now);
  }
}

void ExciterWatch::step_to(State state, Instant now) {
  state_ = state;
  on_since_.reset();
  idle_from_.reset();
  left_on_.reset();
  failures_ = 0;
  switch (state) {
  case State::idle:
    run_ = {};
    is_from_record_ = false;
    break;
  case State::silent:
    must_be_off_ = !is_from_record_ || was_seen_on_;
    next_attempt_ = now;
    next_question_ = std::min(next_question_, now);
    break;
  case State::begins:
  case State::ended:
    idle_from_ = now + watched_after;
    break;
  case State::driven:
    break;
  }
}

void ExciterWatch::note(const OutputSettings& settings) {
  auto& known = run_.settings;
  // What was announced without a voltage, or seen before.
  known.erase(std::remove_if(known.begin(), known.end(),
                             [&](const OutputSettings& one) { return is_same(one, settings); }),
              known.end());
  if (known.size() == max_settings) {
    known.erase(known.begin());
  }
  known.push_back(settings);
}

void ExciterWatch::heard(const ExciterAnnouncement& announcement, Instant now) {
  const bool is_of_driver = announcement.run == run_.run;
  if (!announcement.is_driven && !is_of_driver) {
    return; // the last word of a run before
  }
  if (!announcement.is_in_hand && is_of_driver && state_ != State::begins) {
    return; // that it has lost hold of the generator is no sign that somebody attends
  }
  answers_in_run_ = answers_in_run_ || !is_of_driver;
  if (!is_of_driver || state_ == State::begins) {
    run_ = {announcement.run, false, {}, is_of_driver && run_.is_conducted};
  }
  const bool is_news = state_ != (announcement.is_driven ? State::driven : State::ended) ||
                       !is_among(announcement.settings, run_.settings);
  heard_ = now;
  is_from_record_ = false;
  must_be_off_ = false; // whoever drives it has hold of it
  has_switched_off_ = false;
  may_be_on_.clear();
  run_.has_ended = !announcement.is_driven;
  if (is_news) {
    step_to(announcement.is_driven ? State::driven : State::ended, now);
    if (announcement.is_driven && !is_among(announcement.settings, run_.settings)) {
      note(announcement.settings);
    }
    next_question_ = now;
  }
  on_since_.reset();
}

void ExciterWatch::heard_run(const std::string& run, RunPhase phase, Instant now) {
  if (run == run_.run) {
    heard_ = state_ == State::begins ? now : heard_;
    run_.is_conducted = phase != RunPhase::over;
    if (run_.is_conducted && idle_from_) {
      idle_from_ = now + watched_after;
    }
    return;
  }
  // What is driven, may be on or is about to be driven comes first.
  const bool is_free = state_ == State::idle ||
                       ((state_ == State::ended || state_ == State::begins) && !must_be_off_ &&
                        (phase == RunPhase::running || !run_.is_conducted));
  if (phase == RunPhase::over || !is_free) {
    return;
  }
  run_.run = run; // what was driven before is still known
  run_.has_ended = true;
  heard_ = now;
  run_.is_conducted = true;
  is_from_record_ = false;
  answers_in_run_ = true;
  has_switched_off_ = false;
  step_to(State::begins, now);
}

bool ExciterWatch::is_of_run(const OutputReading& reading) const {
  if (!reading.settings) {
    return state_ == State::silent; // it does not say with what it is on
  }
  return is_among(*reading.settings, run_.settings) ||
         ((run_.is_conducted || (state_ == State::silent && !is_from_record_)) &&
          is_among(*reading.settings, planned_));
}

void ExciterWatch::found_on(const OutputReading& reading, Instant now) {
  if (!is_of_run(reading)) {
    on_since_.reset();
    left_on_ = reading.settings.value_or(OutputSettings{});
    idle_from_ = idle_from_.value_or(now + watched_after);
    return;
  }
  left_on_.reset();
  on_since_ = on_since_.value_or(now);
  if (state_ == State::silent || state_ == State::begins ||
      (now - *on_since_ >= unattended_limit && now - heard_ >= unattended_limit)) {
    must_be_off_ = true;
    next_attempt_ = now;
  }
}

void ExciterWatch::answered(const Expected<OutputReading>& answer, Instant now) {
  if (state_ == State::idle || must_be_off_) {
    return; // the attempt to switch it off asks itself
  }
  if (!answer) {
    ++failures_;
    last_failure_ = answer.error().message;
    answers_in_run_ = answers_in_run_ && state_ != State::driven;
    const bool may_have_begun =
        state_ == State::begins && run_.is_conducted && failures_ >= failures_of_begin;
    if (state_ == State::silent || may_have_begun) {
      may_be_on_ = last_failure_;
    }
    return;
  }
  failures_ = 0;
  may_be_on_.clear();
  if (state_ == State::driven) {
    if (is_from_record_) {
      was_seen_on_ = answer->is_on.value_or(false) && is_of_run(*answer);
    } else if (answer->settings && answer->settings->frequency_hz > 0.0) {
      note(*answer->settings);
    }
    return;
  }
  if (answer->is_on.value_or(false)) {
    found_on(*answer, now);
    return;
  }
  on_since_.reset();
  left_on_.reset();
  idle_from_ = idle_from_.value_or(now + watched_after);
}

void ExciterWatch::switched_off(const Expected<void>& outcome, Instant now) {
  if (!outcome) {
    may_be_on_ = outcome.error().message;
    next_attempt_ = now + interval;
    return;
  }
  must_be_off_ = false;
  has_switched_off_ = true;
  may_be_on_.clear();
  on_since_.reset();
  left_on_.reset();
  failures_ = 0;
  idle_from_ = now + watched_after;
  next_question_ = now + interval;
}

bool ExciterWatch::is_known_off() const {
  if (must_be_off_ || !may_be_on_.empty() || state_ == State::driven) {
    return false;
  }
  return state_ != State::silent || idle_from_; // the generator has answered since
}

bool ExciterWatch::may_ask(Instant now) const {
  const bool may_connect =
      state_ == State::begins && run_.is_conducted && now - heard_ <= word_limit;
  return state_ != State::idle && now >= next_question_ && !may_connect &&
         (answers_in_run_ || now - heard_ > unattended_limit);
}

ExciterWatch::Action ExciterWatch::due(Instant now) {
  if (state_ == State::driven && now - heard_ > unattended_limit) {
    const bool was_asked_in_vain = is_from_record_ && failures_ > 0;
    step_to(State::silent, now);
    if (was_asked_in_vain) {
      may_be_on_ = last_failure_;
    }
  }
  if (must_be_off_) {
    return now >= next_attempt_ ? Action::switch_off : Action::none;
  }
  if (idle_from_ && now >= *idle_from_) {
    step_to(State::idle, now);
    may_be_on_.clear();
  }
  if (!may_ask(now)) {
    return Action::none;
  }
  next_question_ = now + interval;
  return Action::ask;
}

} // namespace dyncal::inline programs
