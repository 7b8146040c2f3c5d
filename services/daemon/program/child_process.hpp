// A program that another one starts and ends: `dyncal demo` runs every service of a bench as a
// laboratory does, as a process of its own; tests do the same.
//
// What the child prints goes to files. It is in a process group of its own, so that Ctrl-C on the
// terminal reaches the parent alone, and is asked to end (SIGTERM) when the parent dies. When the
// object is destroyed the child is asked to end, and killed if it has not ended two seconds later.
//
// Belongs to one thread.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/base/error.hpp"

namespace dyncal::inline daemon {

// Files that take what a child prints; one path for both keeps the order of the lines.
struct ChildOutput {
  std::filesystem::path standard_output;
  std::filesystem::path standard_error;
};

struct ChildExit {
  int status = 0;     // of exit(), or 128 + the signal that ended it
  double cpu_s = 0.0; // user and system
};

class ChildProcess {
public:
  // Fails (bad_file) when the program cannot be started or a file cannot be written.
  [[nodiscard]] static Expected<ChildProcess> start(const std::filesystem::path& program,
                                                    const std::vector<std::string>& arguments,
                                                    ChildOutput output);
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  [[nodiscard]] bool running() { return !wait_for(std::chrono::nanoseconds(0)); }
  // Returns nothing if it still runs after that time.
  [[nodiscard]] std::optional<ChildExit> wait_for(std::chrono::nanoseconds limit);
  void signal(int number) const;
  // SIGTERM, then SIGKILL once the patience is at its end.
  void stop(std::chrono::nanoseconds patience = std::chrono::seconds(2));

  [[nodiscard]] pid_t id() const { return process_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  // The last line on standard error, for a message about why it ended.
  [[nodiscard]] std::string last_line() const;

private:
  ChildProcess(pid_t process, int descriptor, std::string name, ChildOutput output);

  void swap(ChildProcess& other) noexcept;

  pid_t process_ = 0;
  int descriptor_ = -1; // becomes readable when the process ends
  std::string name_;
  ChildOutput output_;
  std::optional<ChildExit> exit_;
};

// The folder of the running program: all programs of dyncal are installed side by side.
[[nodiscard]] std::filesystem::path program_folder();

} // namespace dyncal::inline daemon
