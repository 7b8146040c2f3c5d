#include "services/daemon/program/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>

#include <fmt/core.h>

namespace dyncal::inline daemon {
namespace {

using Clock = std::chrono::steady_clock;

// Runs in the child between fork and exec: only calls that are safe there.
[[noreturn]] void become(char** arguments, int output, int errors, pid_t parent) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() == parent) {
    dup2(output, STDOUT_FILENO);
    dup2(errors, STDERR_FILENO);
    execv(arguments[0], arguments);
  }
  _exit(127);
}

Expected<int> open_log(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_APPEND | O_CLOEXEC, 0644);
  if (file < 0) {
    return fail(ErrorCode::bad_file, fmt::format("{}: cannot write this log file: {}",
                                                 path.string(), std::strerror(errno)));
  }
  return file;
}

pid_t spawn(const std::filesystem::path& program, const std::vector<std::string>& arguments,
            int output, int errors) {
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    become(pointers.data(), output, errors, parent);
  }
  return child;
}

// By its number: the header of glibc 2.36 declares the function for C only.
int open_process(pid_t process) {
  return process < 0 ? -1 : static_cast<int>(syscall(SYS_pidfd_open, process, 0));
}

double cpu_s(const rusage& usage) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

} // namespace

Expected<ChildProcess> ChildProcess::start(const std::filesystem::path& program,
                                           const std::vector<std::string>& arguments,
                                           ChildOutput output) {
  if (access(program.c_str(), X_OK) != 0) {
    return fail(
        ErrorCode::bad_file,
        fmt::format("{}: this program is missing or may not be run; build or install all of dyncal",
                    program.string()));
  }
  DYNCAL_TRY(const auto out, open_log(output.standard_output));
  const auto err = open_log(output.standard_error);
  if (!err) {
    close(out);
    return fail(err.error());
  }
  const pid_t child = spawn(program, arguments, out, *err);
  const int descriptor = open_process(child);
  const std::string reason = std::strerror(errno);
  close(out);
  close(*err);
  if (descriptor < 0) {
    if (child > 0) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
    }
    return fail(ErrorCode::bad_file,
                fmt::format("{}: cannot be started: {}", program.string(), reason));
  }
  return ChildProcess(child, descriptor, program.filename().string(), std::move(output));
}

ChildProcess::ChildProcess(pid_t process, int descriptor, std::string name, ChildOutput output)
    : process_(process), descriptor_(descriptor), name_(std::move(name)),
      output_(std::move(output)) {}

void ChildProcess::swap(ChildProcess& other) noexcept {
  std::swap(process_, other.process_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(name_, other.name_);
  std::swap(output_, other.output_);
  std::swap(exit_, other.exit_);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept {
  swap(other);
}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  swap(other);
  return *this;
}

ChildProcess::~ChildProcess() {
  if (descriptor_ >= 0) {
    stop();
    close(descriptor_);
  }
}

std::optional<ChildExit> ChildProcess::wait_for(std::chrono::nanoseconds limit) {
  const auto deadline = Clock::now() + limit;
  while (!exit_) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    pollfd ended{.fd = descriptor_, .events = POLLIN, .revents = 0};
    const int ready = poll(&ended, 1, static_cast<int>(std::max<std::int64_t>(0, left.count())));
    if (ready > 0) {
      int status = 0;
      rusage usage{};
      wait4(process_, &status, 0, &usage);
      exit_ = ChildExit{.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
                        .cpu_s = cpu_s(usage)};
    } else if (Clock::now() >= deadline) {
      return std::nullopt;
    }
  }
  return exit_;
}

void ChildProcess::signal(int number) const {
  if (!exit_) {
    kill(process_, number);
  }
}

void ChildProcess::stop(std::chrono::nanoseconds patience) {
  signal(SIGTERM);
  if (!wait_for(patience)) {
    signal(SIGKILL);
    (void)wait_for(std::chrono::hours(1)); // a killed process ends as soon as the kernel lets it
  }
}

std::string ChildProcess::last_line() const {
  std::ifstream stream(output_.standard_error);
  std::string line;
  std::string last;
  while (std::getline(stream, line)) {
    if (!line.empty()) {
      last = line;
    }
  }
  return last;
}

std::filesystem::path program_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

} // namespace dyncal::inline daemon
