#include "services/run/driven_generator.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "services/base/device_error.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;

constexpr auto confirmation_slice = 200ms;
constexpr double slice_s = 0.4; // bench time between two looks at the network

} // namespace

Error of_step(const wire::PlannedStep& step, ErrorCode code, const std::string& what) {
  return {code, fmt::format("step {}, {} Hz: {}", step.step(), step.frequency_text_hz(), what)};
}

Expected<std::unique_ptr<DrivenGenerator>>
DrivenGenerator::connect(const RunEnvironment& environment, const GeneratorSettings& settings,
                         WaitHooks hooks, std::function<void(double now_s)> took_time) {
  DYNCAL_TRY(auto connection, environment.connect_generator(settings, hooks.ask));
  std::unique_ptr<DrivenGenerator> driven(
      new DrivenGenerator(settings, std::move(connection), std::move(hooks), std::move(took_time)));
  using drivers::generator::Awaited;
  driven->instrument().call_while_waiting([self = driven.get()](Awaited awaited) {
    if (awaited == Awaited::bench_time) {
      self->hooks_.hold();
    } else {
      self->hooks_.look();
    }
    return !self->stop_.stop_requested();
  });
  return driven;
}

DrivenGenerator::~DrivenGenerator() {
  // Otherwise the guard tries from now on, for longer than anybody would wait here.
  const bool off = !output_may_be_on_ || (!connection_.guard && switch_off().value_or(false));
  if (off && connection_.guard) {
    connection_.guard->dismiss();
  }
}

void DrivenGenerator::begin(const wire::PlannedStep& step, const std::stop_token& stop) {
  step_ = step;
  stop_ = stop;
  is_away_ = false;
  fault_may_pass_ = false;
}

Error DrivenGenerator::reported(const drivers::Error& error) {
  using drivers::ErrorCode;
  if (!is_instrument_) {
    return device_error(error);
  }
  is_away_ = is_away_ || error.code == ErrorCode::timeout ||
             error.code == ErrorCode::disconnected || error.code == ErrorCode::malformed;
  return is_away_ ? device_error(error) : fault_of_step(error.message);
}

Error DrivenGenerator::fault_of_step(const std::string& what) {
  fault_may_pass_ = true;
  return of_step(step_, ErrorCode::device, what);
}

Expected<double> DrivenGenerator::now_s() {
  const auto now = instrument().clock_now_s();
  return now ? Expected<double>(*now) : fail(reported(now.error()));
}

Expected<bool> DrivenGenerator::hold_until(double bench_time_s) {
  auto now = instrument().clock_now_s();
  while (now && *now < bench_time_s && !stop_.stop_requested()) {
    now = instrument().wait_until_s(std::min(bench_time_s, *now + slice_s), stop_);
    DYNCAL_TRY(hooks_.keep_alive());
    if (now) {
      took_time_(*now);
    }
  }
  if (!now) {
    return fail(reported(now.error()));
  }
  return !stop_.stop_requested();
}

Expected<bool> DrivenGenerator::wait_for_effect() {
  while (!stop_.stop_requested()) {
    const auto in_effect = instrument().wait_for_effect(confirmation_slice);
    if (!in_effect) {
      return fail(reported(in_effect.error()));
    }
    if (*in_effect) {
      return true;
    }
    DYNCAL_TRY(hooks_.keep_alive());
  }
  return false;
}

Expected<bool> DrivenGenerator::switch_off() {
  const auto off =
      instrument().set_output(false).and_then([&] { return instrument().wait_for_effect(0ms); });
  if (!off) {
    is_away_ = is_instrument_;
    return fail(reported(off.error()));
  }
  output_may_be_on_ = output_may_be_on_ && !*off;
  return *off;
}

Expected<void> DrivenGenerator::wait_until_off() {
  return wait_for_effect().map(
      [&](bool in_effect) { output_may_be_on_ = output_may_be_on_ && !in_effect; });
}

} // namespace dyncal::inline run
