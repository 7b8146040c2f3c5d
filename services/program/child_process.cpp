#include "services/program/child_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <thread>

#include <fmt/format.h>

namespace dyncal::services {
namespace {

constexpr std::chrono::seconds patience{2};
constexpr std::chrono::milliseconds poll_interval{10};

// Runs in the child between fork and exec: only calls that are safe there.
[[noreturn]] void become(char** arguments, int log, pid_t parent) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  setpgid(0, 0); // Ctrl-C on the terminal is the parent's business
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() == parent) {
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
    execv(arguments[0], arguments);
  }
  _exit(127);
}

} // namespace

Expected<ChildProcess> ChildProcess::start(const std::filesystem::path& program,
                                           const std::vector<std::string>& arguments,
                                           const std::filesystem::path& log) {
  if (access(program.c_str(), X_OK) != 0) {
    return fail(
        ErrorCode::bad_file,
        fmt::format("{}: this program is missing or may not be run; build or install all of dyncal",
                    program.string()));
  }
  const int log_file = open(log.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644);
  if (log_file < 0) {
    return fail(ErrorCode::bad_file, fmt::format("{}: cannot write this log file: {}", log.string(),
                                                 std::strerror(errno)));
  }
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
    become(pointers.data(), log_file, parent);
  }
  close(log_file);
  if (child < 0) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: cannot be started: {}", program.string(), std::strerror(errno)));
  }
  return ChildProcess(child, program.filename().string(), log);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : process_(std::exchange(other.process_, 0)), name_(std::move(other.name_)),
      log_(std::move(other.log_)) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  if (this != &other) {
    stop();
    process_ = std::exchange(other.process_, 0);
    name_ = std::move(other.name_);
    log_ = std::move(other.log_);
  }
  return *this;
}

ChildProcess::~ChildProcess() {
  stop();
}

bool ChildProcess::running() {
  if (process_ != 0 && waitpid(process_, nullptr, WNOHANG) != 0) {
    process_ = 0;
  }
  return process_ != 0;
}

void ChildProcess::stop() {
  if (!running()) {
    return;
  }
  kill(process_, SIGTERM);
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (running() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(poll_interval); // no portable wait with a deadline
  }
  if (running()) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = 0;
  }
}

std::string ChildProcess::last_line() const {
  std::ifstream stream(log_);
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

} // namespace dyncal::services
