// `dyncal guard-output ADDRESS`: switches a generator's output off when standard input ends. Not
// for people: services/run/output_guard.hpp starts it, so it is in no list.
#include <unistd.h>

#include "services/programs/command/command.hpp"
#include "services/run/output_guard.hpp"

namespace dyncal::inline programs {
namespace {

struct GuardedOutput {
  std::string address;
};

void add_guard_output(CLI::App& command, GuardedOutput& guarded) {
  command.group("");
  command.add_option("ADDRESS", guarded.address, "of the generator, HOST:PORT")->required();
}

Expected<int> run_guard_output(const GuardedOutput& guarded) {
  return guard_output(guarded.address, STDIN_FILENO);
}

const Command guard_output_command{300, "guard-output",
                                   "switch a generator's output off when standard input ends",
                                   add_guard_output, run_guard_output};

} // namespace
} // namespace dyncal::inline programs
