#include "services/programs/command/work_progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <string_view>

#include <fmt/core.h>

namespace dyncal::inline programs {
namespace {

constexpr std::chrono::milliseconds pace{250};
constexpr std::string_view clear_line = "\r\x1b[K";

// What a signal handler, in whatever thread, may look at: the terminal with a line, -1: none.
std::atomic<int> terminal_of_line = -1;
std::atomic<bool> program_ends = false; // nothing is drawn any more
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

// The signal then does what it would have done (SA_RESETHAND).
void take_line_away(int signal) {
  program_ends = true;
  const int terminal = terminal_of_line;
  if (terminal >= 0) {
    static_cast<void>(!write(terminal, clear_line.data(), clear_line.size()));
  }
  static_cast<void>(raise(signal));
}

} // namespace

std::string duration_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  return whole < 120 ? fmt::format("{} s", whole) : fmt::format("{} min", (whole + 59) / 60);
}

std::string progress_text(const WorkCount::State& state, double passed_s) {
  if (state.total == 0) {
    return fmt::format("{}: {}", state.what, duration_text(passed_s));
  }
  const std::size_t done = std::min(state.done, state.total);
  const std::string text =
      state.unit == "%" ? fmt::format("{}: {} %", state.what, done)
                        : fmt::format("{}: {} of {} {}", state.what, done, state.total, state.unit);
  if (done == 0) {
    return fmt::format("{}, {}", text, duration_text(passed_s));
  }
  const double each_s = passed_s / static_cast<double>(done);
  return fmt::format("{}, {} left", text,
                     duration_text(each_s * static_cast<double>(state.total - done)));
}

WorkProgress::WorkProgress(const std::string& what, std::FILE* stream,
                           std::chrono::milliseconds patience)
    : stream_(stream), patience_(patience), count_(std::make_shared<WorkCount>(what)) {
  if (isatty(fileno(stream_)) != 0) {
    watch_signals();
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
}

WorkProgress::~WorkProgress() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  clear();
  leave_signals();
}

void WorkProgress::watch_signals() {
  terminal_of_line = fileno(stream_);
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction before {};
    struct sigaction now {};
    now.sa_handler = take_line_away;
    now.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
    sigemptyset(&now.sa_mask);
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_DFL &&
        sigaction(signal, &now, nullptr) == 0) {
      before_[signal] = before;
    }
  }
}

void WorkProgress::leave_signals() {
  for (const auto& [signal, before] : before_) {
    sigaction(signal, &before, nullptr);
  }
  terminal_of_line = -1;
}

void WorkProgress::clear() {
  const std::scoped_lock lock(mutex_);
  if (shown_) {
    fmt::print(stream_, "{}", clear_line);
    std::fflush(stream_);
    shown_ = false;
  }
}

// The cursor goes back, so that what another prints is over it, not after it.
void WorkProgress::draw() {
  const WorkCount::State state = count_->state();
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - state.began;
  const std::scoped_lock lock(mutex_);
  if (program_ends) {
    return;
  }
  fmt::print(stream_, "{}{}\r", clear_line, progress_text(state, passed.count()));
  std::fflush(stream_);
  shown_ = true;
}

void WorkProgress::run(const std::stop_token& stop) {
  std::mutex unused;
  std::condition_variable_any ended;
  std::unique_lock lock(unused);
  const auto never = [] { return false; };
  ended.wait_for(lock, stop, patience_, never);
  while (!stop.stop_requested()) {
    draw();
    ended.wait_for(lock, stop, pace, never);
  }
}

} // namespace dyncal::inline programs
