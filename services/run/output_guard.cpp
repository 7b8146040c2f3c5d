#include "services/run/output_guard.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <syslog.h>
#include <unistd.h>

#include "drivers/generator/generator_output.hpp"
#include "services/daemon/program/child_process.hpp"
#include "services/daemon/program/program.hpp"

namespace dyncal::inline run {
namespace {

constexpr char farewell = '.';
constexpr std::chrono::milliseconds pause{500}; // where a connection is refused at once
// What ends a terminal's programs, a process group or a systemd unit ends the run; its guard is for
// what comes after that.
constexpr std::array outlived_signals{SIGTERM, SIGINT, SIGHUP};
constexpr int quiet_attempts = 5; // the instrument may hold on to the dead program's connection

Error cannot_start(const std::string& why) {
  return {ErrorCode::device,
          fmt::format("the guard of the generator's output cannot be started: {}", why)};
}

// The terminal of the program that died may be gone, too.
void say(const std::string& sentence, int priority) {
  fmt::print(stderr, "dyncal: {}\n", sentence);
  syslog(LOG_USER | priority, "dyncal: %s", sentence.c_str());
}

int switch_off(const std::string& generator_address, std::chrono::milliseconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  for (int attempt = 1;; ++attempt) {
    const auto off = drivers::generator::switch_output_off(generator_address);
    if (off) {
      say(fmt::format("the run has ended without it; the output of the generator {} was switched "
                      "off now",
                      generator_address),
          LOG_WARNING);
      return 0;
    }
    if (std::chrono::steady_clock::now() > deadline) {
      const Error error{ErrorCode::device,
                        fmt::format("THE OUTPUT OF THE GENERATOR {} MAY BE ON after {:.3g} min of "
                                    "trying, which end now: switch it off by hand ({})",
                                    generator_address,
                                    std::chrono::duration<double, std::ratio<60>>(limit).count(),
                                    off.error().message)};
      syslog(LOG_USER | LOG_CRIT, "dyncal: %s", error.message.c_str());
      return report_error(error);
    }
    if (attempt == quiet_attempts) {
      say(fmt::format("the run has ended and the output of the generator {} MAY BE ON: switch it "
                      "off by hand if you can; trying for {:.3g} min ({})",
                      generator_address,
                      std::chrono::duration<double, std::ratio<60>>(limit).count(),
                      off.error().message),
          LOG_CRIT);
    }
    std::this_thread::sleep_for(pause);
  }
}

} // namespace

Expected<OutputGuard> OutputGuard::start(const std::string& generator_address) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    return fail(cannot_start(std::strerror(errno)));
  }
  const drivers::FileDescriptor reading(ends[0]);
  drivers::FileDescriptor writing(ends[1]);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, reading.number(), STDIN_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // Before the guard ignores them itself.
  sigset_t outlived;
  sigemptyset(&outlived);
  for (const int signal : outlived_signals) {
    sigaddset(&outlived, signal);
  }
  posix_spawnattr_setsigmask(&attributes, &outlived);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK);
  std::vector<std::string> arguments{(program_folder() / "dyncal").string(), "guard-output",
                                     generator_address};
  std::vector<char*> pointers;
  pointers.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) {
    pointers.push_back(argument.data());
  }
  pointers.push_back(nullptr);
  pid_t process = 0;
  const int problem =
      posix_spawn(&process, pointers.front(), &actions, &attributes, pointers.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (problem != 0) {
    return fail(cannot_start(fmt::format("{}: {}", arguments.front(), std::strerror(problem))));
  }
  return OutputGuard(std::move(writing), process);
}

void OutputGuard::dismiss() {
  // Fails only when the guard is gone already.
  static_cast<void>(write(pipe_.number(), &farewell, 1) < 0);
  waitpid(process_, nullptr, 0);
}

int guard_output(const std::string& generator_address, int input, std::chrono::milliseconds limit) {
  close_range(STDERR_FILENO + 1, ~0U, 0); // sockets of the guarded program, which must end with it
  std::signal(SIGPIPE, SIG_IGN);
  for (const int signal : outlived_signals) {
    std::signal(signal, SIG_IGN);
  }
  char byte = 0;
  ssize_t count = 0;
  do {
    count = read(input, &byte, 1);
  } while (count < 0 && errno == EINTR);
  if (count == 1 && byte == farewell) {
    return 0;
  }
  return switch_off(generator_address, limit);
}

} // namespace dyncal::inline run
