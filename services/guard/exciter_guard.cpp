#include "services/guard/exciter_guard.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "services/bus/names.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::services {
namespace {

constexpr std::chrono::milliseconds look_interval{100};
constexpr std::size_t max_runs = 100;                       // of a bench, which has one at a time
constexpr std::chrono::milliseconds status_write_limit{50}; // it is repeated

wire::ServiceStatus status_of(const ProgramIdentity& own, const GuardedExciter& exciter) {
  wire::ServiceStatus status;
  status.bench(exciter.bench);
  status.service(fmt::format("guard@{}:{}", own.host, own.process_id).substr(0, bus::max_name));
  status.arm(wire::ARM_WAITING);
  status.health(wire::HEALTH_OK);
  status.software(own.software);
  status.dds(own.dds);
  status.host(own.host);
  status.process_id(own.process_id);
  status.contract_version(wire::CONTRACT_VERSION);
  status.guarded_generator(exciter.generator);
  return status;
}

bool is_driven(const wire::Excitation& excitation) {
  return excitation.window_end_utc_ns() == 0;
}

} // namespace

Expected<std::unique_ptr<ExciterGuard>>
ExciterGuard::create(bus::Participant& participant, const ProgramIdentity& own,
                     const GuardedExciter& exciter, std::chrono::milliseconds unattended_limit,
                     SwitchOff switch_off, bus::Clock& clock) {
  auto wake_up = std::make_shared<bus::WakeUp>();
  auto excitation = participant.reader(bus::topics::excitation, exciter.bench, wake_up);
  auto status = participant.writer(bus::topics::service_status, exciter.bench);
  if (const auto error = first_error(excitation, status)) {
    return fail(*error);
  }
  return std::unique_ptr<ExciterGuard>(
      new ExciterGuard(status_of(own, exciter), unattended_limit, std::move(switch_off), clock,
                       std::move(wake_up), {std::move(*excitation), std::move(*status)}));
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
  if (clock_.now() >= next_status_) {
    publish();
  }
}

GuardFigures ExciterGuard::figures() const {
  return {.bench = bench_,
          .switched_off = times_switched_off_,
          .may_be_on = status_.health() == wire::HEALTH_FAILED};
}

void ExciterGuard::set_health(wire::HealthState health, const std::string& message) {
  if (status_.health() != health || status_.message() != message) {
    status_.health(health);
    status_.message(message);
    publish();
  }
}

void ExciterGuard::publish() {
  status_.published_utc_ns(clock_.utc_now_ns());
  endpoints_.status.write(status_, status_write_limit);
  next_status_ = clock_.now() + status_interval;
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
  endpoints_.excitation.take([&](const wire::Excitation& excitation) {
    if (excitation.bench().to_string() != bench_) {
      return;
    }
    const std::string name = excitation.run().to_string();
    if (!runs_.contains(name)) {
      spdlog::info("bench {}: watching over run {}", bench_, name);
    }
    heard(name).driven = is_driven(excitation);
    set_health(wire::HEALTH_OK, ""); // whoever drives it has hold of it
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
    set_health(wire::HEALTH_OK,
               fmt::format("nothing was heard of run {} while its exciter was driven; the output "
                           "of the generator was switched off",
                           name));
    return;
  }
  set_health(wire::HEALTH_FAILED,
             fmt::format("nothing is heard of run {}, and THE OUTPUT OF THE GENERATOR MAY BE ON: "
                         "switch it off by hand if you can; trying again until it is off ({})",
                         name, off.error().message));
  run.next_try = clock_.now() + retry_interval;
  if (clock_.now() >= run.next_report) {
    run.next_report = clock_.now() + report_interval;
    spdlog::error("bench {}: {}", bench_, status_.message());
  }
}

} // namespace dyncal::services
