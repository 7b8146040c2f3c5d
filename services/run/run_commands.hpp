// What others have asked the conductor of a run to do, by Command messages to the target
// "conductor": pause, continue, end the run, excite a step once more.
//
// Commands of other runs and to other targets are left out. Who commands repeats it until it is
// answered, so each may come more than once, even late: a command is obeyed once by its id, and
// answered as often as it comes. Those without an id are of programs of the first contract: REPEAT
// of one program for one step is one command while it comes within `repetition_limit` of the last
// time. Who commanded is told by DDS discovery; what the message says of it is a comment, for
// anybody writes anything there. The ids of the last `remembered` commands are known. Belongs to
// one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "idl/dyncal.h"
#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"

namespace dyncal::inline run {

class RunCommands {
public:
  static constexpr std::chrono::seconds repetition_limit{2};
  static constexpr std::size_t remembered = 64;

  struct Sender {
    std::string participant; // its id, as in discovery.hpp
    std::string sentence;    // for people: "dyncal-web:4711 on lab-2: 'ada@desk'"
  };
  struct Answer {
    std::uint64_t command = 0;
    std::string refusal; // empty: it is obeyed
  };

  // `steps`: of the plan, that may be excited again; none: no step may. Fails (network) as readers
  // do. `participant` and `clock` outlive the object.
  [[nodiscard]] static Expected<RunCommands> open(bus::Participant& participant, bus::Clock& clock,
                                                  const std::string& bench, std::string run,
                                                  std::set<std::uint32_t> steps,
                                                  const std::shared_ptr<bus::WakeUp>& wake_up);

  // `excites`: steps may still be excited.
  void take(bool excites = true);
  // To the commands that came, one after the other; nothing when all are given.
  [[nodiscard]] std::optional<Answer> take_answer();
  [[nodiscard]] const std::optional<Sender>& paused_by() const { return paused_by_; }
  [[nodiscard]] const std::optional<Sender>& aborted_by() const { return aborted_by_; }
  // The steps to be excited once more that were asked for since the last call.
  [[nodiscard]] std::set<std::uint32_t> take_repeats();

private:
  RunCommands(bus::Participant& participant, bus::Clock& clock, std::string run,
              std::set<std::uint32_t> steps, bus::Reader<wire::Command> reader)
      : participant_(&participant), clock_(&clock), run_(std::move(run)), steps_(std::move(steps)),
        reader_(std::move(reader)) {}
  void answer(const wire::Command& command, const bus::WriterId& writer, bool excites);
  // Returns why it does not.
  [[nodiscard]] std::string obey(const wire::Command& command, const bus::WriterId& writer,
                                 bool excites);
  [[nodiscard]] Sender sender_of(const wire::Command& command, const bus::WriterId& writer) const;
  void ask_for(std::uint32_t step, const std::string& participant);

  bus::Participant* participant_;
  bus::Clock* clock_;
  std::string run_;
  std::set<std::uint32_t> steps_;
  bus::Reader<wire::Command> reader_;
  std::deque<Answer> known_;   // of the last commands with an id
  std::deque<Answer> answers_; // that are still to be given
  std::optional<Sender> paused_by_;
  std::optional<Sender> aborted_by_;
  std::set<std::uint32_t> repeats_;
  std::map<std::pair<std::string, std::uint32_t>, bus::Clock::Instant>
      asked_; // last, by participant
};

} // namespace dyncal::inline run
