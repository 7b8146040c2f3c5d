#include "services/run/run_commands.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "services/base/printable_text.hpp"
#include "services/bus/participant_name.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline run {
namespace {

constexpr const char* conductor = "conductor";

} // namespace

Expected<RunCommands> RunCommands::open(bus::Participant& participant, bus::Clock& clock,
                                        const std::string& bench, std::string run,
                                        std::set<std::uint32_t> steps,
                                        const std::shared_ptr<bus::WakeUp>& wake_up) {
  DYNCAL_TRY(auto reader, participant.reader(bus::topics::command, bench, wake_up));
  return RunCommands(participant, clock, std::move(run), std::move(steps), std::move(reader));
}

void RunCommands::take(bool excites) {
  reader_.take_with_writer([&](const wire::Command& command, const bus::WriterId& writer) {
    if (command.target() == conductor && command.run() == run_) {
      answer(command, writer, excites);
    }
  });
}

void RunCommands::answer(const wire::Command& command, const bus::WriterId& writer, bool excites) {
  if (command.id() == 0) {
    static_cast<void>(obey(command, writer, excites)); // who gives no id knows no answer
    return;
  }
  const auto known = std::ranges::find(known_, command.id(), &Answer::command);
  if (known == known_.end()) {
    known_.push_back({command.id(), obey(command, writer, excites)});
    answers_.push_back(known_.back());
  } else {
    answers_.push_back(*known);
  }
  if (known_.size() > remembered) {
    known_.pop_front();
  }
  if (answers_.size() > remembered) {
    answers_.pop_front();
  }
}

std::optional<RunCommands::Answer> RunCommands::take_answer() {
  if (answers_.empty()) {
    return std::nullopt;
  }
  Answer first = std::move(answers_.front());
  answers_.pop_front();
  return first;
}

RunCommands::Sender RunCommands::sender_of(const wire::Command& command,
                                           const bus::WriterId& writer) const {
  const std::string participant = writer.participant();
  const std::string comment =
      command.sender().empty() ? "" : fmt::format(": '{}'", one_line(command.sender()));
  return {participant, bus::name_of(participant_->discovered(), participant) + comment};
}

std::string RunCommands::obey(const wire::Command& command, const bus::WriterId& writer,
                              bool excites) {
  if (!excites && command.kind() != wire::COMMAND_ABORT) {
    return "the run excites no step any more";
  }
  switch (command.kind()) {
  case wire::COMMAND_PAUSE:
    paused_by_ = sender_of(command, writer);
    return "";
  case wire::COMMAND_CONTINUE:
    paused_by_.reset();
    return "";
  case wire::COMMAND_ABORT:
    aborted_by_ = sender_of(command, writer);
    return "";
  case wire::COMMAND_REPEAT:
    if (steps_.empty()) {
      return "no step of this run is excited again: the rows of the reference's table would not "
             "tell the second excitation from the first";
    }
    if (!steps_.contains(command.step())) {
      return fmt::format("the run's plan has no step {}", command.step());
    }
    if (command.id() == 0) {
      ask_for(command.step(), writer.participant());
    } else {
      repeats_.insert(command.step());
    }
    return "";
  default:
    return "its conductor does not know this command: it is of a later contract";
  }
}

void RunCommands::ask_for(std::uint32_t step, const std::string& participant) {
  const auto now = clock_->now();
  std::erase_if(asked_, [&](const auto& asked) { return now - asked.second > repetition_limit; });
  if (asked_.insert_or_assign({participant, step}, now).second) {
    repeats_.insert(step);
  }
}

std::set<std::uint32_t> RunCommands::take_repeats() {
  return std::exchange(repeats_, {});
}

} // namespace dyncal::inline run
