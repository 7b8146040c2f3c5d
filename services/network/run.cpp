#include "services/network/run.hpp"

#include <algorithm>

#include "services/base/per_enumerator.hpp"
#include "services/base/printable_text.hpp"
#include "services/contract/evaluation_method_message.hpp"

namespace dyncal::network {
namespace {

RunState state_of(wire::MeasurementState state) {
  return per_enumerator(state,
                        {RunState::planned, RunState::running, RunState::done, RunState::aborted},
                        RunState::unknown);
}

StepState state_of(wire::ExcitationState state) {
  return per_enumerator(
      state, {StepState::settling, StepState::steady, StepState::done, StepState::aborted},
      StepState::open);
}

AnalysisState state_of(wire::ArmState state) {
  return per_enumerator(state, {AnalysisState::waiting, AnalysisState::armed,
                                AnalysisState::refused, AnalysisState::finished});
}

Health health_of(wire::HealthState state) {
  return per_enumerator(state, {Health::ok, Health::failed, Health::waiting});
}

// How far the steps are is not in the plan: those of the one before keep it.
std::vector<Step> steps_of(const wire::Measurement& measurement, const std::vector<Step>& before,
                           const Limits& limits) {
  std::vector<Step> steps;
  for (const wire::PlannedStep& planned : measurement.steps()) {
    if (steps.size() == limits.steps) {
      break;
    }
    Step step{.step = planned.step(),
              .frequency_text_hz = one_line(planned.frequency_text_hz()),
              .level_m_s2 = planned.level_m_s2(),
              .repetition = planned.repetition(),
              .settling_s = planned.settling_s(),
              .duration_s = planned.duration_s()};
    if (steps.size() < before.size() && before[steps.size()].step == step.step) {
      step.state = before[steps.size()].state;
      step.attempt = before[steps.size()].attempt;
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

double seconds(bus::Clock::Instant::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

bool is_driven(StepState state) {
  return state == StepState::settling || state == StepState::steady;
}

} // namespace

const char* to_string(RunState state) {
  return per_enumerator(state, {"unknown", "planned", "running", "done", "aborted"});
}

const char* to_string(StepState state) {
  return per_enumerator(state, {"open", "settling", "steady", "done", "aborted"});
}

const char* to_string(AnalysisState state) {
  return per_enumerator(state, {"waiting", "armed", "refused", "finished"});
}

const char* to_string(Health health) {
  return per_enumerator(health, {"ok", "failed", "waiting"});
}

RunState Run::state() const {
  if (announced && *announced != RunState::unknown) {
    return *announced;
  }
  if (!analysis) {
    return RunState::unknown;
  }
  switch (analysis->state) {
  case AnalysisState::waiting:
    return RunState::planned;
  case AnalysisState::armed:
    return RunState::running;
  case AnalysisState::refused:
    return RunState::aborted;
  case AnalysisState::finished:
    break;
  }
  return RunState::done;
}

bool Run::is_over() const {
  return state() == RunState::done || state() == RunState::aborted;
}

bool Run::is_paused() const {
  const bool analysis_waits = analysis && analysis->health == Health::waiting;
  return state() == RunState::running && (analysis_waits || !message.empty());
}

bool Run::is_left_alone(Instant at) const {
  return !is_over() && conductor_heard && at - *conductor_heard > conductor_limit;
}

std::int64_t Run::time_utc_ns() const {
  return planned_utc_ns != 0 || !analysis ? planned_utc_ns : analysis->published_utc_ns;
}

std::optional<double> Run::time_left_s(Instant at) const {
  const bool is_conducted = state() == RunState::planned || state() == RunState::running;
  if (!plan || !is_conducted || is_left_alone(at)) {
    return std::nullopt;
  }
  double left_s = 0.0;
  for (const Step& step : plan->steps) {
    const double whole_s = step.settling_s + step.duration_s;
    if (is_driven(step.state)) {
      left_s += now ? std::clamp(whole_s - seconds(at - now->began), 0.0, whole_s) : whole_s;
    } else if (step.state == StepState::open || step.state == StepState::aborted) {
      left_s += whole_s;
    }
  }
  return left_s;
}

std::size_t Run::steps_done() const {
  const auto is_done = [](const Step& step) { return step.state == StepState::done; };
  return plan ? static_cast<std::size_t>(std::ranges::count_if(plan->steps, is_done)) : 0;
}

std::size_t Run::invalid_results() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(results, [](const auto& result) { return !result.second.valid; }));
}

std::size_t Run::flagged_results() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      results, [](const auto& result) { return !result.second.flags.empty(); }));
}

void Run::take(const wire::Measurement& measurement, const Limits& limits, Instant at) {
  announced = state_of(measurement.state());
  message = one_line(measurement.message());
  planned_utc_ns = measurement.planned_utc_ns();
  answer = {measurement.answered_command(), one_line(measurement.answer())};
  const std::vector<Step> before = plan ? std::move(plan->steps) : std::vector<Step>{};
  plan = Plan{.method =
                  from_wire(measurement.method()).value_or(EvaluationMethod::sample_timestamping),
              .reference = one_line(measurement.reference()),
              .sync_acs = one_line(measurement.sync_acs()),
              .sync_dau = one_line(measurement.sync_dau()),
              .sync_dso = one_line(measurement.sync_dso()),
              .dut = {},
              .recipe_sha256 = one_line(measurement.recipe_sha256()),
              .conductor = one_line(measurement.conductor()),
              .steps = steps_of(measurement, before, limits)};
  for (const std::string& channel : measurement.dut()) {
    if (plan->dut.size() < limits.channels) {
      plan->dut.push_back(one_line(channel));
    }
  }
  conductor_heard = at;
}

void Run::take(const wire::Excitation& excitation, Instant at) {
  const std::uint32_t attempt = std::max(excitation.attempt(), 1U);
  const bool is_new = !now || now->step.step != excitation.step() || now->step.attempt != attempt;
  if (is_new) {
    now.emplace();
    now->began = at;
  }
  now->heard = at;
  now->begin_utc_ns = excitation.window_begin_utc_ns();
  now->end_utc_ns = excitation.window_end_utc_ns();
  now->step.step = excitation.step();
  now->step.frequency_text_hz = one_line(excitation.frequency_text_hz());
  now->step.level_m_s2 = excitation.level_m_s2();
  now->step.repetition = excitation.repetition();
  now->step.state = state_of(excitation.state());
  now->step.attempt = attempt;
  if (now->step.state == StepState::steady && !now->steady) {
    now->steady = at;
  }
  conductor_heard = at;
  if (!plan) {
    return;
  }
  bool is_before = true; // who came late has not heard of those before it
  for (Step& step : plan->steps) {
    if (step.step == excitation.step()) {
      step.state = now->step.state;
      step.attempt = attempt;
      now->step.settling_s = step.settling_s;
      now->step.duration_s = step.duration_s;
      is_before = false;
    } else if (is_before && attempt == 1 && step.state == StepState::open) {
      step.state = StepState::done;
      step.attempt = 1;
    } else if (is_driven(step.state)) {
      step.state = StepState::done;
    }
  }
}

void Run::take(const wire::ServiceStatus& status, Instant at) {
  const std::string service = status.service().to_string();
  const bool leads = status.arm() != wire::ARM_WAITING;
  if (analysis && analysis->service != service && !leads && at - analysis->heard < silence_limit) {
    return; // another analysis, which waits for the one that leads the run
  }
  analysis = AnalysisReport{.service = service,
                            .state = state_of(status.arm()),
                            .health = health_of(status.health()),
                            .message = one_line(status.message()),
                            .results = status.results_published(),
                            .published_utc_ns = status.published_utc_ns(),
                            .heard = at};
}

} // namespace dyncal::network
