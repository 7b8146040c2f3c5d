#include "services/run/run_controller.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/core.h>
#include <unistd.h>

#include "services/base/version.hpp"
#include "services/bus/host_network.hpp"
#include "services/contract/run_identity.hpp"
#include "services/evaluation/outcome_agreement.hpp"
#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "services/run/arming_wait.hpp"
#include "services/run/results_wait.hpp"
#include "services/run/resume_wait.hpp"
#include "services/run/run_plan.hpp"
#include "services/run/run_watch.hpp"
#include "services/run/step_sequence.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;

constexpr auto acknowledgment_limit = 2s;
constexpr auto description_limit = 3s; // for what sources say of themselves
// A rate as it is set and one as a clock makes it are closer together.
constexpr double rate_tolerance_rel = 0.01;

// What `dyncal check` held the frequencies against is not what the instrument says.
std::optional<std::string> other_rate(const BenchFile& bench, const RunSource& source) {
  const SourceSettings* settings = bench.source(source.source);
  const double stated_hz = settings != nullptr ? settings->nominal_rate_hz.value_or(0.0) : 0.0;
  const double rate_hz = source.description.nominal_rate_hz;
  if (!(stated_hz > 0.0) || !(rate_hz > 0.0) ||
      std::abs(rate_hz / stated_hz - 1.0) <= rate_tolerance_rel) {
    return std::nullopt;
  }
  return fmt::format("source '{}' takes {:.6g} samples a second, but its nominal_rate_hz in the "
                     "bench file is {:.6g}: 'dyncal check' held the frequencies against that",
                     source.source, rate_hz, stated_hz);
}

} // namespace

RunController::RunController(RunEnvironment environment, const BenchFile& bench, std::string run,
                             ShowProgress show_progress)
    : environment_(std::move(environment)), clock_(environment_.clock), bench_(bench),
      run_(std::move(run)), show_progress_(std::move(show_progress)),
      wake_up_(std::make_shared<bus::WakeUp>()) {}

RunController::~RunController() = default;
RunController::RunController(RunController&&) noexcept = default;

bool RunController::has_heard_analysis() const {
  return watch_ && watch_->analysis();
}

Expected<RunOutcome>
RunController::conduct(const std::vector<analysis::AdcCalibrationPoint>& adc_calibration,
                       const std::stop_token& stop) {
  DYNCAL_TRY(open(adc_calibration));
  watch_->set_state(wire::MEASUREMENT_PLANNED);
  // Only a run that is armed has the bench to itself: until then the generator may be another's.
  const auto ready = ArmingWait(*watch_, bench_.bench)
                         .wait(stop)
                         .and_then([&] { return check_before_first_step(stop); })
                         .and_then([&] { return open_sequence(); });
  if (!ready) {
    watch_->set_state(wire::MEASUREMENT_ABORTED);
    return fail(ready.error());
  }
  watch_->set_state(wire::MEASUREMENT_RUNNING);
  return excite_and_collect(stop);
}

Expected<RunOutcome>
RunController::resume(const std::vector<analysis::AdcCalibrationPoint>& adc_calibration,
                      const std::stop_token& stop) {
  if (bench_.generator.driver == GeneratorDriver::none) {
    return fail(ErrorCode::bad_argument,
                "a run of recorded files cannot be resumed: begin it anew");
  }
  DYNCAL_TRY(open(adc_calibration));
  if (keeping_.begun) {
    DYNCAL_TRY(check_same_recipe(*keeping_.begun, name(), outcome_.recipe_sha256));
    outcome_.sources = keeping_.begun->sources;
  }
  watch_->set_state(wire::MEASUREMENT_RUNNING);
  ResumeWait waiting(*watch_, name(), bench_.bench, keeping_.begun);
  if (const auto known = waiting.wait(stop); !known) {
    return fail(known.error()); // and not aborted: what the analysis holds of it is left as it is
  }
  if (has_ended_at_analysis()) {
    return collect_of_ended_run(stop);
  }
  DYNCAL_TRY(check_before_first_step(stop).and_then([&] { return open_sequence(); }));
  sequence_->resume();
  return excite_and_collect(stop);
}

Expected<RunOutcome> RunController::excite_and_collect(const std::stop_token& stop) {
  outcome_.began_utc_ns = clock_.utc_now_ns();
  const Expected<void> excited = sequence_ ? sequence_->excite_all(stop) : Expected<void>{};
  outcome_.interrupted = stop.stop_requested();
  if (!excited) {
    outcome_.problem = excited.error().message;
  }
  const std::string message = outcome_.interrupted ? interrupted_by_user : outcome_.problem;
  const auto state = final_state(excited.has_value());
  if (sequence_ || state == wire::MEASUREMENT_ABORTED) {
    watch_->set_state(state, message); // files go on RUNNING until the analysis has seen their end
  }
  const Expected<void> collected = ResultsWait(*watch_, sequence_ != nullptr).wait(stop);
  settle_means(collected.has_value());
  if (!collected && outcome_.problem.empty()) {
    outcome_.problem = collected.error().message;
  }
  if (sequence_ && sequence_->output_may_be_on()) {
    outcome_.output_may_be_on = !sequence_->switch_off().value_or(false);
    outcome_.output_is_guarded = is_instrument(bench_.generator.driver);
  }
  outcome_.interrupted = outcome_.interrupted || stop.stop_requested();
  outcome_.ended_utc_ns = clock_.utc_now_ns();
  watch_->set_state(final_state(excited.has_value()), watch_->measurement().message());
  watch_->wait_for_acknowledgments(acknowledgment_limit);
  sort_outcome(outcome_);
  return std::move(outcome_);
}

// Its conductor died while it collected, or was away for longer than the analysis waits.
Expected<RunOutcome> RunController::collect_of_ended_run(const std::stop_token& stop) {
  outcome_.began_utc_ns = clock_.utc_now_ns();
  const Expected<void> collected = ResultsWait(*watch_, sequence_ != nullptr).wait(stop);
  if (watch_->other_recipe()) {
    return fail(other_bench_file(name()));
  }
  if (!keeping_.begun) {
    // What describes itself now may have been mounted since.
    outcome_.sources.clear();
    watch_->notice(
        fmt::format("run '{}' has no folder here: with which instruments it was measured "
                    "is not known, and the result names none; look into its folder on "
                    "the host of its conductor",
                    name()));
  }
  settle_means(collected.has_value());
  outcome_.problem = collected ? lack_of_ended_run() : collected.error().message;
  outcome_.interrupted = stop.stop_requested();
  outcome_.ended_utc_ns = clock_.utc_now_ns();
  watch_->set_state(final_state(outcome_.problem.empty()), outcome_.problem);
  watch_->wait_for_acknowledgments(acknowledgment_limit);
  sort_outcome(outcome_);
  return std::move(outcome_);
}

std::string RunController::name() const {
  return RunIdentity::parse(run_).name;
}

bool RunController::has_ended_at_analysis() const {
  return watch_->analysis()->arm() == wire::ARM_FINISHED;
}

std::string RunController::lack_of_ended_run() const {
  const auto& steps = outcome_.recipe->steps;
  const auto lacking = std::count_if(steps.begin(), steps.end(), [&](const RecipeStep& step) {
    return std::none_of(outcome_.results.begin(), outcome_.results.end(),
                        [&](const StepResult& result) { return result.step == step.step; });
  });
  return lacking == 0
             ? ""
             : fmt::format("run '{}' had ended at the analysis service {} before {} of "
                           "its {} steps; begin a new run for those",
                           name(), watch_->analysis()->service().c_str(), lacking, steps.size());
}

// Where some have not come, a mean may be of other results than those that are here. Another
// version of the analysis may take means otherwise.
void RunController::settle_means(bool all_results_came) {
  if (!all_results_came) {
    take_means_of_results(outcome_);
    return;
  }
  if (outcome_.analysis_software != software_version()) {
    return;
  }
  for (const std::string& difference : replace_foreign_means(outcome_)) {
    watch_->notice(fmt::format("a mean came that is not that of its points, and is left out ({}): "
                               "does another program publish as the analysis of this run?",
                               difference));
  }
}

wire::MeasurementState RunController::final_state(bool excited) const {
  return outcome_.interrupted || !excited ? wire::MEASUREMENT_ABORTED : wire::MEASUREMENT_DONE;
}

Expected<void>
RunController::open(const std::vector<analysis::AdcCalibrationPoint>& adc_calibration) {
  DYNCAL_TRY(const auto recipe, plan_recipe(bench_, run_, adc_calibration));
  DYNCAL_TRY(check_for_run(recipe));
  wire::Measurement measurement = to_message(recipe);
  measurement.planned_utc_ns(clock_.utc_now_ns());
  add_adc_file(adc_file_of(bench_), measurement);
  measurement.conductor(fmt::format("{}:{}", bus::host_name(), getpid()));
  outcome_ = outcome_of(recipe);
  const bool is_guarded = is_instrument(bench_.generator.driver);
  DYNCAL_TRY(watch_, RunWatch::open(environment_.participant, clock_, std::move(measurement),
                                    is_guarded ? bench_.generator.address : "", wake_up_, outcome_,
                                    show_progress_));
  if (keeping_.keep) {
    watch_->on_new_results(keeping_.keep);
  }
  return {};
}

Expected<void> RunController::open_sequence() {
  if (bench_.generator.driver == GeneratorDriver::none) {
    return {};
  }
  DYNCAL_TRY(sequence_, StepSequence::open(environment_, bench_, *watch_, wake_up_));
  return {};
}

// Sources describe themselves when they are found, which may be after the analysis has armed.
Expected<void> RunController::check_before_first_step(const std::stop_token& stop) {
  const Instant began = clock_.now();
  while (keeping_.check && watch_->described() < outcome_.recipe->sources().size() &&
         clock_.now() - began < description_limit && !stop.stop_requested()) {
    watch_->follow("waiting for the descriptions of the sources");
  }
  DYNCAL_TRY(check_same_instruments(*watch_, name()));
  for (const RunSource& source : outcome_.sources) {
    if (const auto other = other_rate(bench_, source)) {
      watch_->notice(*other);
    }
  }
  return keeping_.check ? keeping_.check(outcome_) : Expected<void>{};
}

} // namespace dyncal::inline run
