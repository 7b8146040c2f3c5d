// What the guard of an exciter has to do, from what it hears of runs and what the generator
// answers: a state machine without sockets, DDS and clock.
//
//   state    begins when                          the output is on             is left for idle
//   idle     nothing was driven                   (it is not asked)            -
//   driven   an Excitation has no end             it is noted with what        -
//   silent   that was not heard for 2 s           the run's: off               120 s after off
//   ended    the Excitation has its end           the run's, for 2 s: off      120 s after the end
//   begins   a Measurement is PLANNED or RUNNING  planned, and no word for     120 s after its last
//                                                 2.5 s: off                   word
//
// The generator is asked every second in all states but idle; in begins, once no word has come for
// 2.5 s: until then the conductor may be connecting to an instrument of one connection. Where a
// silence begins the output is switched off unasked. A guard that starts with the record of a run
// goes on as if it heard it now, and switches off only what is on with settings of that run.
//
// "The run's" is what has the frequency and the voltage with which the generator was seen while the
// run was heard (or as announced, where it was not seen); in a silence, and while the run is
// conducted (its Measurement is not over), also what the bench file plans: a conductor that is not
// heard may drive on, or begin with a path that has just failed. Anything else is a person's: it is
// said and left. An output that must be off is tried every second until it answers that it is, with
// no limit; until then it may be on, as where a silent run's generator does not answer: after one
// question without an answer, or two in begins, where the first may meet a conductor that connects.
//
// A generator that does not answer while it is driven takes one connection, the conductor's: it is
// asked again when nothing was heard for 2 s. One thread.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "drivers/generator/generator_output.hpp"
#include "services/base/error.hpp"
#include "services/bus/clock.hpp"

namespace dyncal::inline programs {

using drivers::generator::OutputReading;
using drivers::generator::OutputSettings;

// What is known of a run that has driven the generator; kept over restarts.
struct DrivenRun {
  std::string run; // empty: none
  bool has_ended = false;
  std::vector<OutputSettings> settings; // newest last, at most ExciterWatch::max_settings
  bool is_conducted = false;            // its Measurement was not over, and it may go on as planned

  friend bool operator==(const DrivenRun&, const DrivenRun&) = default;
};

struct ExciterAnnouncement {
  std::string run;
  bool is_driven = false;
  OutputSettings settings; // without a voltage where a closed loop finds it
  // False: the step was broken off, and the conductor does not know whether the output is off.
  bool is_in_hand = true;
};

enum class RunPhase { planned, running, over };

class ExciterWatch {
public:
  using Instant = bus::Clock::Instant;
  enum class State { idle, begins, driven, silent, ended };
  enum class Action { none, ask, switch_off };

  static constexpr std::chrono::seconds unattended_limit{2}; // of a driven exciter
  static constexpr std::chrono::seconds interval{1};         // between two questions or attempts
  // A conductor repeats its Measurement every 2 s.
  static constexpr std::chrono::milliseconds word_limit{2500};
  static constexpr std::chrono::seconds watched_after{120}; // a silence or a run
  static constexpr int failures_of_begin = 2;               // unanswered questions, in begins
  static constexpr std::size_t max_settings = 8;

  // `planned`: of the bench file.
  ExciterWatch(std::vector<OutputSettings> planned, DrivenRun recorded, Instant now);

  void heard(const ExciterAnnouncement& announcement, Instant now);
  // The Measurement of a run.
  void heard_run(const std::string& run, RunPhase phase, Instant now);
  void answered(const Expected<OutputReading>& answer, Instant now);
  void switched_off(const Expected<void>& outcome, Instant now);
  // What is due now; the caller does it and reports the outcome.
  [[nodiscard]] Action due(Instant now);

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] const DrivenRun& run() const { return run_; }
  [[nodiscard]] Instant heard_at() const { return heard_; }
  // The run drives nothing, and its output is off, as far as it says and the generator answers.
  [[nodiscard]] bool is_known_off() const;
  // Why nobody knows that the output is off; empty: nothing speaks for it.
  [[nodiscard]] const std::string& may_be_on() const { return may_be_on_; }
  // An output that is on and is a person's.
  [[nodiscard]] const std::optional<OutputSettings>& left_on() const { return left_on_; }
  // Since the run was last heard.
  [[nodiscard]] bool has_switched_off() const { return has_switched_off_; }

private:
  void step_to(State state, Instant now);
  void note(const OutputSettings& settings);
  void found_on(const OutputReading& reading, Instant now);
  [[nodiscard]] bool is_of_run(const OutputReading& reading) const;
  [[nodiscard]] bool may_ask(Instant now) const;

  std::vector<OutputSettings> planned_;
  DrivenRun run_;
  State state_ = State::idle;
  Instant heard_{};
  bool is_from_record_ = false; // not heard since the start
  bool was_seen_on_ = false;    // since then, with what the record names
  bool must_be_off_ = false;    // and is not known to be
  bool has_switched_off_ = false;
  bool answers_in_run_ = true; // the generator, another connection than the conductor's
  int failures_ = 0;           // of questions, one after the other
  std::string last_failure_;
  std::string may_be_on_;
  std::optional<OutputSettings> left_on_;
  std::optional<Instant> on_since_;  // ended: with the run's settings
  std::optional<Instant> idle_from_; // nothing: not before an answer
  Instant next_question_{};
  Instant next_attempt_{};
};

} // namespace dyncal::inline programs
