// A program of the build as a test runs it: with arguments, a deadline, its outputs in files, and
// signals. It is ended when the object is destroyed. A result that it wrote is held against the
// schema of results. One thread.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/daemon/program/child_process.hpp"

namespace dyncal::tests {

class ProgramRun {
public:
  // Starts `program` of the build's folder of programs, or one given by an absolute path; its
  // outputs go to files in `folder`. Throws what kept it from starting.
  ProgramRun(const std::string& program, const std::vector<std::string>& arguments,
             const std::filesystem::path& folder);
  ~ProgramRun(); // a demo gets five seconds to end its services
  ProgramRun(const ProgramRun&) = delete;
  ProgramRun& operator=(const ProgramRun&) = delete;

  void send(int signal);
  // To a process that the program has started; false when it has none of that name.
  bool send_to_child(const std::string& program, int signal);
  // Exit status, or nothing when the deadline passed first. A program ended by signal N counts as
  // 128 + N. Throws what is wrong with a result file that the program wrote.
  std::optional<int> wait(std::chrono::nanoseconds limit);
  // True as soon as standard error contains the text.
  bool wait_for_error_text(const std::string& text, std::chrono::seconds limit);
  // The same of standard output.
  bool wait_for_output_text(const std::string& text, std::chrono::seconds limit);

  [[nodiscard]] std::string output() const;
  [[nodiscard]] std::string errors() const;
  [[nodiscard]] double cpu_s();         // user and system; 0 while it runs
  [[nodiscard]] double seconds() const; // since it was started, until it was seen to end

private:
  static bool wait_for_text(const std::filesystem::path& file, const std::string& text,
                            std::chrono::seconds limit);
  void check_result() const;

  std::optional<std::filesystem::path> result_; // that it is to write
  std::string schema_;                          // of it
  std::filesystem::path output_;
  std::filesystem::path errors_;
  std::chrono::steady_clock::time_point began_;
  std::optional<std::chrono::steady_clock::time_point> ended_;
  daemon::ChildProcess process_;
};

struct EndedRun {
  int status = -1; // -1: not within patience
  std::string output;
  std::string errors;
};

// The same to its end.
[[nodiscard]] EndedRun run_to_end(const std::string& program,
                                  const std::vector<std::string>& arguments,
                                  const std::filesystem::path& folder);

// A fresh folder of this test below the build tree.
[[nodiscard]] std::filesystem::path fresh_folder(const std::string& name);

} // namespace dyncal::tests
