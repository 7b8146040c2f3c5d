// Starts a program and keeps what it says on standard error, for tests. Ends it at the latest with
// itself.
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace dyncal::tests {

struct Exit {
  int status = 0;     // of exit(), or 128 + the signal
  double cpu_s = 0.0; // user and system
};

class ChildProcess {
public:
  explicit ChildProcess(std::vector<std::string> command) {
    std::string name = (std::filesystem::temp_directory_path() / "dyncal-child-XXXXXX").string();
    const int output = mkstemp(name.data());
    output_path_ = name;
    std::vector<char*> arguments;
    for (auto& word : command) {
      arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    process_ = fork();
    if (process_ == 0) {
      dup2(output, STDERR_FILENO);
      execv(arguments[0], arguments.data());
      _exit(127);
    }
    close(output);
  }
  ~ChildProcess() {
    if (!exit_) {
      kill(process_, SIGKILL);
      (void)wait_for(std::chrono::seconds(10));
    }
    std::filesystem::remove(output_path_);
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void signal(int number) const { kill(process_, number); }

  // Nothing when it still runs after that time.
  std::optional<Exit> wait_for(std::chrono::nanoseconds limit) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!exit_) {
      int status = 0;
      rusage usage{};
      if (wait4(process_, &status, WNOHANG, &usage) == process_) {
        exit_ = Exit{.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
                     .cpu_s = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                              static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) *
                                  1e-6};
        break;
      }
      if (std::chrono::steady_clock::now() > deadline) {
        return std::nullopt;
      }
      std::this_thread::sleep_for(
          std::chrono::milliseconds(5)); // between two looks at a process that cannot wake us
    }
    return exit_;
  }

  // What it has said so far.
  [[nodiscard]] std::string said() const {
    std::ifstream file(output_path_);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

private:
  pid_t process_ = -1;
  std::string output_path_;
  std::optional<Exit> exit_;
};

} // namespace dyncal::tests
