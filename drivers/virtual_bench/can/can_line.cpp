#include "drivers/virtual_bench/can/can_line.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>

#include <fmt/core.h>
#include <pthread.h>

#include "drivers/utc_clock.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

// What a sleeping thread may need to wake up: a few 10 us, on a guest's kernel more, in simulated
// time nothing.
constexpr std::int64_t min_watch_ns = 5'000;
constexpr std::int64_t first_watch_ns = 60'000;
constexpr std::int64_t max_watch_ns = 500'000;
constexpr std::int64_t attend_before_ns = 20'000'000;
constexpr std::int64_t late_ns = 100'000;
constexpr std::int64_t second_ns = 1'000'000'000;

void sleep_until(std::int64_t utc_ns) {
  const timespec until{utc_ns / second_ns, utc_ns % second_ns};
  clock_nanosleep(CLOCK_REALTIME, TIMER_ABSTIME, &until, nullptr);
}

} // namespace

void request_realtime_priority(int priority) {
  const sched_param wanted{.sched_priority = priority};
  static_cast<void>(
      pthread_setschedparam(pthread_self(), SCHED_RR, &wanted)); // refused to ordinary users
}

CanLine::CanLine(can::FrameSender sender)
    : sender_(std::move(sender)), watch_ns_(first_watch_ns),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

void CanLine::put(const can::CanFrame& frame, std::int64_t end_utc_ns, bool exact) {
  {
    const std::scoped_lock lock(mutex_);
    waiting_.push_back({frame, end_utc_ns, exact});
  }
  frame_added_.notify_one();
}

// The watch is as long as waking up took of late, and becomes shorter when it takes less.
void CanLine::sleep_until_watch(std::int64_t end_utc_ns) {
  const std::int64_t wake_up_ns = end_utc_ns - watch_ns_;
  if (utc_now_ns() >= wake_up_ns) {
    return;
  }
  sleep_until(wake_up_ns);
  const std::int64_t needed_ns = (utc_now_ns() - wake_up_ns) * 3 / 2;
  watch_ns_ =
      std::clamp(std::max(needed_ns, watch_ns_ - watch_ns_ / 64), min_watch_ns, max_watch_ns);
}

void CanLine::send(const TimedFrame& timed) {
  if (timed.exact) {
    sleep_until_watch(timed.end_utc_ns);
    std::int64_t now_ns = utc_now_ns();
    while (now_ns < timed.end_utc_ns) {
      now_ns = utc_now_ns();
    }
    ++exact_;
    late_ += now_ns > timed.end_utc_ns + late_ns ? 1 : 0;
  } else if (utc_now_ns() < timed.end_utc_ns) {
    sleep_until(timed.end_utc_ns);
  }
  if (const auto done = sender_.send(timed.frame)) {
    ++sent_;
  } else if (refused_++ == 0) {
    fmt::print(stderr, "dyncal-virtual-bench: {}\n", done.error().message);
  }
}

void CanLine::run(const std::stop_token& stop) {
  request_realtime_priority(10);
  while (!stop.stop_requested()) {
    std::unique_lock lock(mutex_);
    if (!frame_added_.wait(lock, stop, [this] { return !waiting_.empty(); })) {
      return;
    }
    const TimedFrame timed = waiting_.front();
    waiting_.pop_front();
    // A sleep that hears of a stop, as long as there is time for one.
    const std::chrono::nanoseconds attend(timed.end_utc_ns - attend_before_ns);
    frame_added_.wait_until(lock, stop, std::chrono::system_clock::time_point(attend),
                            [] { return false; });
    if (stop.stop_requested()) {
      return;
    }
    lock.unlock();
    send(timed);
  }
}

} // namespace dyncal::drivers::virtual_bench
