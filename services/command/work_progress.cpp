#include "services/command/work_progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>

#include <fmt/core.h>

namespace dyncal::services {
namespace {

constexpr std::chrono::milliseconds pace{250};

std::string time_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  return whole < 120 ? fmt::format("{} s", whole) : fmt::format("{} min", (whole + 59) / 60);
}

} // namespace

std::string progress_text(const WorkCount::State& state, double passed_s) {
  if (state.total == 0) {
    return fmt::format("{}: {}", state.what, time_text(passed_s));
  }
  const std::size_t done = std::min(state.done, state.total);
  const std::string text =
      fmt::format("{}: {} of {} {}", state.what, done, state.total, state.unit);
  if (done == 0) {
    return fmt::format("{}, {}", text, time_text(passed_s));
  }
  const double each_s = passed_s / static_cast<double>(done);
  return fmt::format("{}, {} left", text,
                     time_text(each_s * static_cast<double>(state.total - done)));
}

WorkProgress::WorkProgress(const std::string& what, std::FILE* stream,
                           std::chrono::milliseconds patience)
    : stream_(stream), patience_(patience), count_(std::make_shared<WorkCount>(what)) {
  if (isatty(fileno(stream_)) != 0) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
}

WorkProgress::~WorkProgress() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  clear();
}

void WorkProgress::clear() {
  const std::scoped_lock lock(mutex_);
  if (shown_) {
    fmt::print(stream_, "\r\x1b[K");
    std::fflush(stream_);
    shown_ = false;
  }
}

// The cursor goes back, so that what another prints is over it, not after it.
void WorkProgress::draw() {
  const WorkCount::State state = count_->state();
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - state.began;
  const std::scoped_lock lock(mutex_);
  fmt::print(stream_, "\r\x1b[K{}\r", progress_text(state, passed.count()));
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

} // namespace dyncal::services
