#include "services/run/run_controller.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>
#include <unistd.h>

#include "services/base/version.hpp"
#include "services/bus/host_network.hpp"
#include "services/contract/run_identity.hpp"
#include "services/evaluation/outcome_agreement.hpp"
#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/result/adc_file_message.hpp"
#include "services/run/run_plan.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;
using Kind = RunOutlook::Kind;

constexpr auto acknowledgment_limit = 2s;
constexpr auto description_limit = 3s; // for what sources say of themselves
// In which the analysis refuses another recipe, where neither folder nor results tell which it is:
// it hears of this one every 2 s.
constexpr auto recipe_limit = 2500ms;
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

Expected<RunOutcome>
RunController::conduct(const std::vector<analysis::AdcCalibrationPoint>& adc_calibration,
                       const std::stop_token& stop) {
  if (const auto opened = open(adc_calibration); !opened) {
    return fail(opened.error());
  }
  watch_->set_state(wire::MEASUREMENT_PLANNED);
  // Only a run that is armed has the bench to itself: until then the generator may be another's.
  const auto ready =
      wait_until_armed(stop).and_then([&] { return check_before_first_step(stop); }).and_then([&] {
        return open_sequence();
      });
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
  if (const auto opened = open(adc_calibration); !opened) {
    return fail(opened.error());
  }
  if (keeping_.begun) {
    if (auto same = check_same_recipe(*keeping_.begun, name(), outcome_.recipe_sha256); !same) {
      return fail(same.error());
    }
    outcome_.sources = keeping_.begun->sources;
  }
  watch_->set_state(wire::MEASUREMENT_RUNNING);
  if (const auto known = wait_until_known(stop); !known) {
    return fail(known.error()); // and not aborted: what the analysis holds of it is left as it is
  }
  if (has_ended_at_analysis()) {
    return collect_of_ended_run(stop);
  }
  const auto ready = check_before_first_step(stop).and_then([&] { return open_sequence(); });
  if (!ready) {
    return fail(ready.error());
  }
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
  const Expected<void> collected = wait_for_results(stop);
  if (collected) {
    leave_out_foreign_means(); // all points are there
  } else if (outcome_.problem.empty()) {
    outcome_.problem = collected.error().message;
  }
  if (sequence_ && sequence_->output_may_be_on()) {
    outcome_.output_may_be_on = !sequence_->switch_off().value_or(false);
    outcome_.output_is_guarded = bench_.generator.driver == GeneratorDriver::scpi;
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
  const Expected<void> collected = wait_for_results(stop);
  if (watch_->has_other_recipe()) {
    return fail(other_bench_file(name()));
  }
  if (collected) {
    leave_out_foreign_means();
  }
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

Expected<void> RunController::check_same_instruments() const {
  const std::string other = watch_->other_instrument();
  return other.empty() ? Expected<void>{}
                       : fail(ErrorCode::no_source,
                              fmt::format("run '{}' is not resumed: {}", name(), other));
}

// An analysis that takes a run over cannot know whether anything was measured; its folder does.
Error RunController::refusal_of_run() const {
  const Error refusal = watch_->outlook().reason;
  const bool has_results =
      !outcome_.results.empty() || !keeping_.begun || keeping_.begun->has_results;
  return has_results ? refusal
                     : Error{refusal.code, fmt::format("run '{}' ended before its first result: "
                                                       "nothing was measured; begin a new run",
                                                       name())};
}

// Another version of the analysis may take means otherwise.
void RunController::leave_out_foreign_means() {
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
  const auto recipe = plan_recipe(bench_, run_, adc_calibration);
  if (!recipe) {
    return fail(recipe.error());
  }
  wire::Measurement measurement = to_message(*recipe);
  measurement.planned_utc_ns(clock_.utc_now_ns());
  add_adc_file(adc_file_of(bench_), measurement);
  measurement.conductor(fmt::format("{}:{}", bus::host_name(), getpid()));
  outcome_ = outcome_of(*recipe);
  const bool is_guarded = bench_.generator.driver == GeneratorDriver::scpi;
  auto watch = RunWatch::open(environment_.participant, clock_, std::move(measurement),
                              is_guarded ? bench_.generator.address : "", wake_up_, outcome_,
                              show_progress_);
  if (!watch) {
    return fail(watch.error());
  }
  watch_ = std::move(*watch);
  if (keeping_.keep) {
    watch_->on_new_results(keeping_.keep);
  }
  return {};
}

Expected<void> RunController::open_sequence() {
  if (bench_.generator.driver == GeneratorDriver::none) {
    return {};
  }
  auto sequence = StepSequence::open(environment_, bench_, *watch_, wake_up_);
  if (!sequence) {
    return fail(sequence.error());
  }
  sequence_ = std::move(*sequence);
  return {};
}

// An analysis that falls silent is waited for as in the run; it or another may arm then.
Expected<void> RunController::wait_until_armed(const std::stop_token& stop) {
  Instant attended = clock_.now();
  while (!stop.stop_requested()) {
    const auto& analysis = watch_->analysis();
    const auto unheard = clock_.now() - watch_->analysis_heard();
    const bool is_silent = analysis && unheard > attention_limit;
    watch_->follow(is_silent                                  ? silence_of_analysis()
                   : analysis && !analysis->message().empty() ? analysis->message()
                                                              : "waiting for the analysis");
    if (is_silent && unheard <= analysis_limit) {
      attended = clock_.now();
    } else if (const auto answer = answer_of_analysis(attended)) {
      return *answer;
    }
  }
  return fail(ErrorCode::interrupted, "interrupted before the first step; nothing was excited");
}

std::string RunController::silence_of_analysis() const {
  return fmt::format(
      "the analysis service {} has gone silent; waiting for it or another up to {} s",
      watch_->analysis()->service().c_str(), analysis_limit.count());
}

// Sources describe themselves when they are found, which may be after the analysis has armed.
Expected<void> RunController::check_before_first_step(const std::stop_token& stop) {
  const Instant began = clock_.now();
  while (keeping_.check && watch_->described() < outcome_.recipe->sources().size() &&
         clock_.now() - began < description_limit && !stop.stop_requested()) {
    watch_->follow("waiting for the descriptions of the sources");
  }
  if (const auto same = check_same_instruments(); !same) {
    return same;
  }
  for (const RunSource& source : outcome_.sources) {
    if (const auto other = other_rate(bench_, source)) {
      watch_->notice(*other);
    }
  }
  return keeping_.check ? keeping_.check(outcome_) : Expected<void>{};
}

// Until the analysis attends to the run and all of its results so far have come.
Expected<void> RunController::wait_until_known(const std::stop_token& stop) {
  Instant attended = clock_.now();
  const Instant began = attended;
  std::size_t signs_before = watch_->signs_of_work();
  while (!stop.stop_requested()) {
    const auto& analysis = watch_->analysis();
    watch_->follow(analysis && !analysis->message().empty() ? analysis->message()
                                                            : "waiting for the analysis");
    if (watch_->signs_of_work() != std::exchange(signs_before, watch_->signs_of_work())) {
      attended = clock_.now();
    }
    const bool may_be_another =
        !keeping_.begun && outcome_.results.empty() && clock_.now() - began < recipe_limit;
    if (const auto answer = answer_about_run(attended, may_be_another)) {
      return *answer;
    }
  }
  return fail(ErrorCode::interrupted,
              "interrupted before the run was resumed; nothing was excited");
}

std::optional<Expected<void>> RunController::answer_about_run(Instant attended,
                                                              bool may_be_another) const {
  const auto& analysis = watch_->analysis();
  if (watch_->has_other_recipe()) {
    return fail(other_bench_file(name()));
  }
  if (analysis && analysis->arm() == wire::ARM_REFUSED) {
    return fail(refusal_of_run());
  }
  if (analysis && has_ended_at_analysis()) {
    watch_->notice(fmt::format("run '{}' has ended at the analysis service {}; its results are "
                               "collected",
                               name(), analysis->service().c_str()));
    return Expected<void>{};
  }
  if (auto same = check_same_instruments(); analysis && !same) {
    return same;
  }
  // Without the guard, which has heard nothing since the other conductor died: it hears this one
  // when a step is announced.
  const RunOutlook outlook =
      run_outlook(analysis, clock_.now() - watch_->analysis_heard(), watch_->commands());
  if (analysis && outlook.kind == Kind::over && watch_->commands().aborted_by()) {
    return fail(outlook.reason.code,
                fmt::format("run '{}' is not resumed: {}", name(), outlook.reason.message));
  }
  if (analysis && outlook.kind == Kind::well && !may_be_another &&
      outcome_.results.size() >= analysis->results_published()) {
    watch_->notice(fmt::format("run '{}' is resumed, with {} results so far", name(),
                               outcome_.results.size()));
    return Expected<void>{};
  }
  if (clock_.now() - attended <= (analysis ? analysis_limit : armed_limit)) {
    return std::nullopt;
  }
  return analysis && outlook.kind == Kind::waits
             ? fail(outlook.reason)
             : fail(ErrorCode::no_analysis,
                    fmt::format("no analysis service holds run '{}' of bench '{}'; begin a new run",
                                name(), bench_.bench));
}

std::optional<Expected<void>> RunController::answer_of_analysis(Instant since) const {
  const auto& analysis = watch_->analysis();
  const auto waited = clock_.now() - since;
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

// Topics have no order among each other: FINISHED may come before results that were written before
// it; but not before those that come once more (run_publisher.cpp).
bool RunController::everything_has_come() const {
  const auto& analysis = watch_->analysis();
  const auto& results = outcome_.results;
  return analysis && analysis->arm() == wire::ARM_FINISHED &&
         results.size() >= analysis->results_published() &&
         std::none_of(results.begin(), results.end(),
                      [](const StepResult& one) { return one.provisional; }) &&
         outcome_.transfer_functions.size() >= analysis->transfer_functions_published() &&
         outcome_.clock_reports.size() >= analysis->clock_reports_published();
}

bool RunController::plays_files() const {
  return !sequence_ && watch_->measurement().state() == wire::MEASUREMENT_RUNNING;
}

void RunController::abort(const std::string& reason) {
  outcome_.problem = reason;
  watch_->set_state(wire::MEASUREMENT_ABORTED, reason);
}

Expected<void> RunController::wait_for_results(const std::stop_token& stop) {
  const bool already_stopped = stop.stop_requested();
  Instant changed = clock_.now();
  Instant at_work = changed;
  std::size_t signs_before = watch_->signs_of_work();
  bool collected_again = false;
  while (!everything_has_come()) {
    const bool has_finished = watch_->analysis()->arm() == wire::ARM_FINISHED;
    const bool attended =
        has_finished || clock_.now() - watch_->analysis_heard() <= attention_limit;
    watch_->follow(attended ? "evaluating" : silence_of_analysis());
    if (!already_stopped && stop.stop_requested() &&
        watch_->measurement().state() != wire::MEASUREMENT_ABORTED) {
      watch_->set_state(wire::MEASUREMENT_ABORTED, interrupted_by_user);
    }
    const RunOutlook outlook = watch_->outlook();
    if (watch_->analysis()->arm() == wire::ARM_REFUSED && !plays_files()) {
      return fail(
          outlook.reason); // an analysis that took the run over, and could not go on with it
    }
    const bool is_at_work = watch_->signs_of_work() != signs_before;
    const bool is_waited_for = (!attended || outlook.kind == Kind::waits) && !stop.stop_requested();
    const bool may_still_come = is_waited_for || (plays_files() && outlook.kind != Kind::over);
    if (is_at_work || may_still_come) {
      signs_before = watch_->signs_of_work();
      changed = clock_.now();
    }
    if (is_at_work || (attended && !has_finished)) {
      at_work = clock_.now();
    }
    if (clock_.now() - at_work > missed_limit && !std::exchange(collected_again, true)) {
      watch_->collect_again();
    }
    if (clock_.now() - watch_->analysis_heard() > analysis_limit) {
      return fail(ErrorCode::no_analysis, fmt::format("the analysis service {} has gone silent",
                                                      watch_->analysis()->service().c_str()));
    }
    if (plays_files() && outlook.kind == Kind::over &&
        watch_->analysis()->arm() != wire::ARM_FINISHED) {
      abort(outlook.reason.message);
    }
    if (clock_.now() - changed > results_limit) {
      return fail(ErrorCode::no_result, "the last results have not come from the analysis service");
    }
  }
  return {};
}

} // namespace dyncal::services
