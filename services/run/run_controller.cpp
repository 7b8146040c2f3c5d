#include "services/run/run_controller.hpp"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>
#include <unistd.h>

#include "services/bus/host_network.hpp"
#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/run/run_plan.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;

constexpr auto alive_interval = 2s; // between two messages about the run, which keep it alive
constexpr auto look_interval = 200ms;
constexpr auto acknowledgment_limit = 2s;

} // namespace

RunController::RunController(RunEnvironment environment, const BenchFile& bench, std::string run,
                             ShowProgress show_progress)
    : environment_(std::move(environment)), clock_(environment_.clock), bench_(bench),
      run_(std::move(run)), show_progress_(std::move(show_progress)),
      wake_up_(std::make_shared<bus::WakeUp>()) {}

Expected<RunOutcome>
RunController::conduct(const std::vector<analysis::AdcCalibrationPoint>& adc_calibration,
                       const std::stop_token& stop) {
  const auto recipe = plan_recipe(bench_, run_, adc_calibration);
  if (!recipe) {
    return fail(recipe.error());
  }
  measurement_ = to_message(*recipe);
  measurement_.planned_utc_ns(clock_.utc_now_ns());
  measurement_.conductor(fmt::format("{}:{}", bus::host_name(), getpid()));
  outcome_ = outcome_of(*recipe);
  if (const auto opened = open_messages(); !opened) {
    return fail(opened.error());
  }
  set_state(wire::MEASUREMENT_PLANNED);
  // Only a run that is armed has the bench to itself: until then the generator may be another's.
  if (const auto ready = wait_until_armed(stop).and_then([&] { return open_excitation(); });
      !ready) {
    set_state(wire::MEASUREMENT_ABORTED);
    return fail(ready.error());
  }
  set_state(wire::MEASUREMENT_RUNNING);
  outcome_.began_utc_ns = clock_.utc_now_ns();
  const Expected<void> excited = excite(stop);
  outcome_.interrupted = stop.stop_requested();
  if (!excited) {
    outcome_.problem = excited.error().message;
  }
  measurement_.message(outcome_.interrupted ? "interrupted by the user" : outcome_.problem);
  const auto state = final_state(excited.has_value());
  if (excitation_ || state == wire::MEASUREMENT_ABORTED) {
    set_state(state); // recorded files go on RUNNING until the analysis has seen their end
  }
  const Expected<void> collected = wait_for_results(stop);
  if (!collected && outcome_.problem.empty()) {
    outcome_.problem = collected.error().message;
  }
  if (excitation_ && excitation_->output_may_be_on()) {
    outcome_.output_may_be_on = !excitation_->switch_off();
  }
  outcome_.interrupted = outcome_.interrupted || stop.stop_requested();
  outcome_.ended_utc_ns = clock_.utc_now_ns();
  set_state(final_state(excited.has_value()));
  messages_->wait_for_acknowledgments(acknowledgment_limit);
  sort_outcome();
  return std::move(outcome_);
}

wire::MeasurementState RunController::final_state(bool excited) const {
  return outcome_.interrupted || !excited ? wire::MEASUREMENT_ABORTED : wire::MEASUREMENT_DONE;
}

void RunController::sort_outcome() {
  const auto key = [](const StepResult& result) {
    return std::tie(result.step, result.repetition, result.channel);
  };
  std::stable_sort(outcome_.results.begin(), outcome_.results.end(),
                   [&](const auto& a, const auto& b) { return key(a) < key(b); });
  std::sort(
      outcome_.transfer_functions.begin(), outcome_.transfer_functions.end(),
      [](const TransferFunction& a, const TransferFunction& b) { return a.channel < b.channel; });
}

Expected<void> RunController::open_messages() {
  auto messages = RunMessages::open(environment_.participant, clock_, bench_.bench, run_, wake_up_);
  if (!messages) {
    return fail(messages.error());
  }
  messages_.emplace(std::move(*messages));
  return {};
}

Expected<void> RunController::open_excitation() {
  if (bench_.generator.driver == GeneratorDriver::none) {
    return {};
  }
  auto excitation = StepExcitation::open(
      environment_, bench_, measurement_, wake_up_,
      {.announce = [this](const wire::PlannedStep& step,
                          wire::ExcitationState state) { messages_->announce(step, state); },
       .show = [this](const std::string& phase) { show(phase); },
       .ask = [this](const std::string& request) { show("asking", request); },
       .keep_alive = [this] { return watch_analysis(); }});
  if (!excitation) {
    return fail(excitation.error());
  }
  excitation_ = std::move(*excitation);
  return {};
}

Expected<void> RunController::wait_until_armed(const std::stop_token& stop) {
  const Instant began = clock_.now();
  while (!stop.stop_requested()) {
    const auto& analysis = messages_->analysis();
    follow(analysis && !analysis->message().empty() ? analysis->message()
                                                    : "waiting for the analysis");
    if (const auto answer = answer_of_analysis(began)) {
      return *answer;
    }
  }
  return fail(ErrorCode::interrupted, "interrupted before the first step; nothing was excited");
}

std::optional<Expected<void>> RunController::answer_of_analysis(Instant began) const {
  const auto& analysis = messages_->analysis();
  const auto waited = clock_.now() - began;
  if (analysis && analysis->arm() == wire::ARM_ARMED) {
    return Expected<void>{};
  }
  if (analysis && analysis->arm() == wire::ARM_REFUSED) {
    return fail(ErrorCode::no_source, analysis->message());
  }
  if (!analysis && waited > answer_limit) {
    return fail(ErrorCode::no_analysis,
                fmt::format("no analysis service answers for bench '{}'; is dyncal-analysis "
                            "running in the same DDS domain?",
                            bench_.bench));
  }
  if (waited > armed_limit) {
    return fail(ErrorCode::no_analysis,
                fmt::format("the analysis service {} has not armed for bench '{}'",
                            analysis->service().c_str(), bench_.bench));
  }
  return std::nullopt;
}

Expected<void> RunController::excite(const std::stop_token& stop) {
  if (!excitation_) {
    return {};
  }
  first_step_began_ = clock_.now();
  Expected<void> excited = excitation_->begin();
  for (const wire::PlannedStep& step : measurement_.steps()) {
    if (!excited || stop.stop_requested()) {
      break;
    }
    ++step_;
    excited = excitation_->excite(step, stop);
  }
  excitation_->end();
  return excited;
}

Expected<void> RunController::watch_analysis() {
  repeat_measurement();
  messages_->repeat_announcement();
  messages_->take(outcome_);
  if (messages_->analysis()->health() == wire::HEALTH_FAILED) {
    return fail(ErrorCode::no_source, messages_->analysis()->message());
  }
  return analysis_is_alive();
}

Expected<void> RunController::analysis_is_alive() const {
  if (clock_.now() - messages_->analysis_heard() > analysis_limit) {
    return fail(ErrorCode::no_analysis, fmt::format("the analysis service {} has gone silent",
                                                    messages_->analysis()->service().c_str()));
  }
  return {};
}

// Topics have no order among each other: FINISHED may come before results that were written before
// it.
bool RunController::everything_has_come() const {
  const auto& analysis = messages_->analysis();
  const auto& results = outcome_.results;
  return analysis && analysis->arm() == wire::ARM_FINISHED &&
         results.size() >= analysis->results_published() &&
         std::none_of(results.begin(), results.end(),
                      [](const StepResult& one) { return one.provisional; }) &&
         outcome_.transfer_functions.size() >= analysis->transfer_functions_published() &&
         outcome_.clock_reports.size() >= analysis->clock_reports_published();
}

Expected<void> RunController::wait_for_results(const std::stop_token& stop) {
  const bool already_stopped = stop.stop_requested();
  const auto plays_files = [&] {
    return !excitation_ && measurement_.state() == wire::MEASUREMENT_RUNNING;
  };
  Instant deadline = clock_.now() + results_limit;
  std::size_t results_before = outcome_.results.size();
  while (!everything_has_come()) {
    follow("evaluating");
    if (!already_stopped && stop.stop_requested() &&
        measurement_.state() != wire::MEASUREMENT_ABORTED) {
      set_state(wire::MEASUREMENT_ABORTED);
    }
    const bool failed = messages_->analysis()->health() == wire::HEALTH_FAILED;
    if (outcome_.results.size() != results_before || (plays_files() && !failed)) {
      results_before = outcome_.results.size();
      deadline = clock_.now() + results_limit;
    }
    if (auto alive = analysis_is_alive(); !alive) {
      return alive;
    }
    if (plays_files() && failed) {
      outcome_.problem = messages_->analysis()->message();
      set_state(wire::MEASUREMENT_ABORTED);
    }
    if (clock_.now() > deadline) {
      return fail(ErrorCode::no_result, "the last results have not come from the analysis service");
    }
  }
  return {};
}

void RunController::follow(const std::string& phase) {
  show(phase);
  clock_.wait(*wake_up_, clock_.now() + look_interval);
  messages_->take(outcome_);
  repeat_measurement();
}

void RunController::set_state(wire::MeasurementState state) {
  measurement_.state(state);
  messages_->publish(measurement_);
  measurement_published_ = clock_.now();
}

void RunController::repeat_measurement() {
  if (clock_.now() - measurement_published_ > alive_interval) {
    set_state(measurement_.state());
  }
}

void RunController::show(const std::string& phase, const std::string& request) {
  RunProgress progress;
  progress.request = request;
  progress.step = step_;
  progress.steps = measurement_.steps().size();
  progress.phase = phase;
  progress.results = outcome_.results.size();
  if (step_ > 0 && step_ <= progress.steps) {
    progress.frequency_hz = measurement_.steps()[step_ - 1].frequency_text_hz();
  }
  if (step_ > 1) {
    const double per_step_s =
        std::chrono::duration<double>(clock_.now() - first_step_began_).count() /
        static_cast<double>(step_ - 1);
    progress.seconds_left = per_step_s * static_cast<double>(progress.steps - step_ + 1);
  }
  show_progress_(progress);
}

} // namespace dyncal::services
