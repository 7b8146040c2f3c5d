#include "services/run/run_commands.hpp"

#include <utility>

#include "services/contract/topics.hpp"

namespace dyncal::services {
namespace {

constexpr const char* conductor = "conductor";

} // namespace

Expected<RunCommands> RunCommands::open(bus::Participant& participant, bus::Clock& clock,
                                        const std::string& bench, std::string run,
                                        const std::shared_ptr<bus::WakeUp>& wake_up) {
  auto reader = participant.reader(bus::topics::command, bench, wake_up);
  if (!reader) {
    return fail(reader.error());
  }
  return RunCommands(clock, std::move(run), std::move(*reader));
}

void RunCommands::take() {
  reader_.take([&](const wire::Command& command) {
    if (command.target() == conductor && command.run() == run_) {
      obey(command);
    }
  });
}

void RunCommands::obey(const wire::Command& command) {
  const std::string sender = command.sender().empty() ? "?" : command.sender();
  switch (command.kind()) {
  case wire::COMMAND_PAUSE:
    paused_by_ = sender;
    break;
  case wire::COMMAND_CONTINUE:
    paused_by_.reset();
    break;
  case wire::COMMAND_ABORT:
    aborted_by_ = sender;
    break;
  case wire::COMMAND_REPEAT:
    ask_for(command.step(), sender);
    break;
  default: // of a later contract
    break;
  }
}

void RunCommands::ask_for(std::uint32_t step, const std::string& sender) {
  const auto now = clock_->now();
  std::erase_if(asked_, [&](const auto& asked) { return now - asked.second > repetition_limit; });
  if (asked_.insert_or_assign({sender, step}, now).second) {
    repeats_.insert(step);
  }
}

std::set<std::uint32_t> RunCommands::take_repeats() {
  return std::exchange(repeats_, {});
}

} // namespace dyncal::services
