#include "services/programs/command/local_command.hpp"

#include <fstream>

#include <fmt/format.h>

#include "services/base/printable_text.hpp"
#include "services/base/temporary_folder.hpp"
#include "services/daemon/program/child_process.hpp"

namespace dyncal::inline programs {
namespace {

// Sets the environment and looks in PATH, which execv() does not.
constexpr const char* starter = "/usr/bin/env";
constexpr std::size_t max_output = 4096;

std::string beginning_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string text(max_output, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

std::vector<std::string> arguments_of(const LocalCommand& command) {
  std::vector<std::string> arguments;
  for (const auto& [name, value] : command.environment) {
    arguments.push_back(name + "=" + value);
  }
  arguments.insert(arguments.end(), command.words.begin(), command.words.end());
  return arguments;
}

tl::unexpected<Error> failed(const LocalCommand& command, const std::string& why,
                             const ChildProcess& child) {
  const std::string last = one_line(child.last_line());
  return fail(ErrorCode::bad_file, fmt::format("{}: {}{}", one_line(command.words.front()), why,
                                               last.empty() ? "" : " (" + last + ")"));
}

} // namespace

Expected<std::string> run_local_command(const LocalCommand& command, const std::stop_token& stop) {
  constexpr std::chrono::milliseconds slice{100};
  const TemporaryFolder folder;
  if (folder.path().empty()) {
    return fail(ErrorCode::bad_file, "no folder can be made for what commands print");
  }
  const ChildOutput output{folder.path() / "output", folder.path() / "errors"};
  DYNCAL_TRY(auto child, ChildProcess::start(starter, arguments_of(command), output));
  std::optional<ChildExit> ended;
  for (auto waited = std::chrono::nanoseconds(0);
       !ended && waited < command.limit && !stop.stop_requested(); waited += slice) {
    ended = child.wait_for(slice);
  }
  if (!ended) {
    child.stop();
    return failed(command,
                  fmt::format("had not ended after {:.3g} s, and was ended",
                              std::chrono::duration<double>(command.limit).count()),
                  child);
  }
  if (ended->status != 0) {
    return failed(command, fmt::format("ended with status {}", ended->status), child);
  }
  return beginning_of(output.standard_output);
}

} // namespace dyncal::inline programs
