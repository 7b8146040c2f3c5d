#include "services/guard/exciter_guard.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "services/contract/topics.hpp"

namespace dyncal::services {
namespace {

constexpr std::chrono::milliseconds look_interval{100};
constexpr std::size_t max_runs = 100; // of a bench, which has one at a time

bool is_driven(const wire::Excitation& excitation) {
  return excitation.window_end_utc_ns() == 0;
}

} // namespace

Expected<std::unique_ptr<ExciterGuard>>
ExciterGuard::create(bus::Participant& participant, std::string bench,
                     std::chrono::milliseconds unattended_limit, SwitchOff switch_off,
                     bus::Clock& clock) {
  auto wake_up = std::make_shared<bus::WakeUp>();
  auto excitation = participant.reader(bus::topics::excitation, bench, wake_up);
  if (!excitation) {
    return fail(excitation.error());
  }
  return std::unique_ptr<ExciterGuard>(
      new ExciterGuard(std::move(bench), unattended_limit, std::move(switch_off), clock,
                       std::move(wake_up), std::move(*excitation)));
}

void ExciterGuard::serve(const std::stop_token& stop, const std::function<void()>& turned) {
  while (!stop.stop_requested()) {
    if (turned) {
      turned();
    }
    clock_.wait(*wake_up_, clock_.now() + look_interval);
    work();
  }
}

void ExciterGuard::work() {
  take_messages();
  for (auto& [name, run] : runs_) {
    attend(name, run);
  }
}

ExciterGuard::Run& ExciterGuard::heard(const std::string& run) {
  if (runs_.size() >= max_runs && !runs_.contains(run)) {
    runs_.erase(std::min_element(runs_.begin(), runs_.end(), [](const auto& a, const auto& b) {
      return a.second.heard < b.second.heard;
    }));
  }
  Run& one = runs_[run];
  one.heard = clock_.now();
  one.served = false;
  return one;
}

void ExciterGuard::take_messages() {
  excitation_.take([&](const wire::Excitation& excitation) {
    if (excitation.bench().to_string() != bench_) {
      return;
    }
    const std::string name = excitation.run().to_string();
    if (!runs_.contains(name)) {
      spdlog::info("bench {}: watching over run {}", bench_, name);
    }
    heard(name).driven = is_driven(excitation);
  });
}

void ExciterGuard::attend(const std::string& name, Run& run) {
  const Instant now = clock_.now();
  if (!run.driven || run.served || now - run.heard <= unattended_limit_ || now < run.next_try) {
    return;
  }
  const auto off = switch_off_();
  if (off) {
    run.served = true;
    ++times_switched_off_;
    spdlog::warn("bench {}: nothing was heard of run {} for {:.1f} s while its exciter was driven; "
                 "the output of the generator was switched off",
                 bench_, name, std::chrono::duration<double>(now - run.heard).count());
    return;
  }
  run.next_try = clock_.now() + retry_interval;
  if (clock_.now() >= run.next_report) {
    run.next_report = clock_.now() + report_interval;
    spdlog::error("bench {}: nothing is heard of run {}, and THE OUTPUT OF THE GENERATOR MAY BE "
                  "ON: switch it off by hand if you can; trying again until it is off ({})",
                  bench_, name, off.error().message);
  }
}

} // namespace dyncal::services
