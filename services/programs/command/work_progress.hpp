// How far a long computation is, with the time left where the work is counted: one line on a
// terminal, which appears after two seconds and is gone at the end. Elsewhere nothing is shown and
// nothing is done.
//
// The work counts what it has done, from any thread; a thread of the progress looks at that four
// times a second. The object belongs to the thread that made it.
//
// A signal that ends the program (Ctrl-C, SIGTERM), where nothing else waits for it
// (stop_on_signals()), takes the line away first. That is of the object that was made last.
#pragma once

#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "services/base/work_count.hpp"

namespace dyncal::inline programs {

// "119 s", "2 min"
[[nodiscard]] std::string duration_text(double seconds);

// "evaluating: 12 of 51 steps, 38 s left"; without a total "evaluating: 14 s".
[[nodiscard]] std::string progress_text(const WorkCount::State& state, double passed_s);

class WorkProgress {
public:
  static constexpr std::chrono::milliseconds usual_patience{2000};

  // `what` is done: "evaluating", until the work itself says what.
  explicit WorkProgress(const std::string& what, std::FILE* stream = stderr,
                        std::chrono::milliseconds patience = usual_patience);
  ~WorkProgress();
  WorkProgress(const WorkProgress&) = delete;
  WorkProgress& operator=(const WorkProgress&) = delete;

  // What the work counts; until there is a total the line tells the time.
  [[nodiscard]] const SharedWorkCount& count() const { return count_; }
  // Takes the line away, before something else is printed.
  void clear();

private:
  void run(const std::stop_token& stop);
  void draw();
  void watch_signals();
  void leave_signals();

  std::FILE* stream_;
  std::chrono::milliseconds patience_;
  SharedWorkCount count_;
  std::mutex mutex_; // of what is on the terminal
  bool shown_ = false;
  std::map<int, struct sigaction> before_; // what was done on signals, where it is another now
  std::jthread thread_;                    // the last member: it ends before what it uses
};

// What `work(count)` returns; the line is gone by then.
template <class Work>
[[nodiscard]] auto with_progress(const std::string& what, Work&& work) {
  const WorkProgress progress(what);
  return work(progress.count());
}

} // namespace dyncal::inline programs
