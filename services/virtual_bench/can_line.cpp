#include "services/virtual_bench/can_line.hpp"

#include <ctime>

#include <fmt/core.h>
#include <pthread.h>

#include "services/utc_clock.hpp"

namespace dyncal::services::virtual_bench {
namespace {

constexpr std::int64_t watched_ns = 60'000; // what a sleeping thread may need to wake up
constexpr std::int64_t late_ns = 100'000;
constexpr std::int64_t second_ns = 1'000'000'000;

void sleep_until(std::int64_t utc_ns) {
  const timespec until{utc_ns / second_ns, utc_ns % second_ns};
  clock_nanosleep(CLOCK_REALTIME, TIMER_ABSTIME, &until, nullptr);
}

} // namespace

CanLine::CanLine(drivers::can::FrameSender sender)
    : sender_(std::move(sender)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

void CanLine::put(const drivers::can::CanFrame& frame, std::int64_t end_utc_ns, bool exact) {
  {
    const std::scoped_lock lock(mutex_);
    waiting_.push_back({frame, end_utc_ns, exact});
  }
  more_.notify_one();
}

void CanLine::send(const Due& due) {
  const std::int64_t wake_up_ns = due.exact ? due.end_utc_ns - watched_ns : due.end_utc_ns;
  if (utc_now_ns() < wake_up_ns) {
    sleep_until(wake_up_ns);
  }
  if (due.exact) {
    std::int64_t now_ns = utc_now_ns();
    while (now_ns < due.end_utc_ns) {
      now_ns = utc_now_ns();
    }
    ++exact_;
    late_ += now_ns > due.end_utc_ns + late_ns ? 1 : 0;
  }
  if (const auto done = sender_.send(due.frame)) {
    ++sent_;
  } else if (refused_++ == 0) {
    fmt::print(stderr, "dyncal-virtual-bench: {}\n", done.error().message);
  }
}

void CanLine::run(const std::stop_token& stop) {
  const sched_param priority{.sched_priority = 10};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority)); // refused to ordinary users
  while (!stop.stop_requested()) {
    std::unique_lock lock(mutex_);
    if (!more_.wait(lock, stop, [this] { return !waiting_.empty(); })) {
      return;
    }
    const Due due = waiting_.front();
    waiting_.pop_front();
    lock.unlock();
    send(due);
  }
}

} // namespace dyncal::services::virtual_bench
