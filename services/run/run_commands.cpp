#include "services/run/run_commands.hpp"

#include <utility>

#include "services/contract/topics.hpp"

namespace dyncal::services {
namespace {

constexpr const char* conductor = "conductor";

} // namespace

Expected<RunCommands> RunCommands::open(bus::Participant& participant, const std::string& bench,
                                        std::string run,
                                        const std::shared_ptr<bus::WakeUp>& wake_up) {
  auto reader = participant.reader(bus::topics::command, bench, wake_up);
  if (!reader) {
    return fail(reader.error());
  }
  return RunCommands(std::move(run), std::move(*reader));
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
    repeats_.insert(command.step());
    break;
  default: // of a later contract
    break;
  }
}

std::set<std::uint32_t> RunCommands::take_repeats() {
  return std::exchange(repeats_, {});
}

} // namespace dyncal::services
