// Switches a generator's output off when the program that switched it on dies without having done
// so: killed (SIGKILL), crashed, out of memory.
//
// A process of its own ("dyncal guard-output HOST:PORT") waits for the end of a pipe whose other
// end only the guarded program holds. When the pipe ends without a farewell the guard connects to
// the generator and switches its output off, and goes on trying for ten minutes when the generator
// does not answer; then it ends, and its last word is that the output may be on, on standard error
// and in the system's log, since a terminal may be gone. With a farewell it ends and does nothing.
// It has a session of its own, so that what is
// sent to the terminal's programs does not reach it, and it outlives SIGTERM, SIGINT and SIGHUP:
// whatever ends the run and all of its processes must not end its guard before the output is known
// to be off. Fails (device) when the guard cannot be started. Belongs to one thread.
#pragma once

#include <chrono>
#include <string>

#include "drivers/link/file_descriptor.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline run {

class OutputGuard {
public:
  // Guards the output from now on, beyond the life of this object unless it is dismissed.
  [[nodiscard]] static Expected<OutputGuard> start(const std::string& generator_address);
  // The output has confirmed that it is off: the guard ends.
  void dismiss();
  // Closes the pipe: unless dismissed, the guard switches the output off now.
  ~OutputGuard() = default;
  OutputGuard(OutputGuard&&) noexcept = default;
  OutputGuard& operator=(OutputGuard&&) = delete;
  OutputGuard(const OutputGuard&) = delete;
  OutputGuard& operator=(const OutputGuard&) = delete;

private:
  OutputGuard(drivers::FileDescriptor pipe, int process)
      : pipe_(std::move(pipe)), process_(process) {}

  drivers::FileDescriptor pipe_;
  int process_;
};

// A link that is pulled and put back, an instrument that is switched off and on.
inline constexpr std::chrono::minutes output_guard_limit{10};

// What the guard does; the exit status of its program. `input` is the pipe. Closes all other files
// of the program but the standard ones. One attempt more may begin within `limit`.
[[nodiscard]] int guard_output(const std::string& generator_address, int input,
                               std::chrono::milliseconds limit = output_guard_limit);

} // namespace dyncal::inline run
