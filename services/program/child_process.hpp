// A program of ours that another one starts and ends: `dyncal demo` runs every service of a bench
// as it runs in a laboratory, as a process of its own.
//
// What the child prints goes to a log file. It is asked to end (SIGTERM) when the object goes,
// killed after two seconds, and ends by itself when the parent dies. Belongs to one thread.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/error.hpp"

namespace dyncal::services {

class ChildProcess {
public:
  // Fails (bad_file) when the program cannot be started.
  [[nodiscard]] static Expected<ChildProcess> start(const std::filesystem::path& program,
                                                    const std::vector<std::string>& arguments,
                                                    const std::filesystem::path& log);
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  [[nodiscard]] bool running();
  void stop();
  [[nodiscard]] const std::string& name() const { return name_; }
  // The last line that it printed, for a message about why it ended.
  [[nodiscard]] std::string last_line() const;

private:
  ChildProcess(pid_t process, std::string name, std::filesystem::path log)
      : process_(process), name_(std::move(name)), log_(std::move(log)) {}

  pid_t process_ = 0; // 0: has ended and was waited for
  std::string name_;
  std::filesystem::path log_;
};

// The folder of the program that runs: all programs of dyncal are installed side by side.
[[nodiscard]] std::filesystem::path program_folder();

} // namespace dyncal::services
