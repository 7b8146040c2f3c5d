#include "services/evaluation/run_evaluator.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "services/contract/excitation_quantity.hpp"
#include "services/evaluation/closures/closures.hpp"
#include "services/evaluation/method/completed_results.hpp"
#include "services/evaluation/method/monte_carlo_check.hpp"
#include "services/evaluation/record/described_source.hpp"
#include "services/evaluation/record/step_temperature.hpp"

namespace dyncal::inline evaluation {

namespace {

bool is_changed(const StepResult& result, const StepResult& settled) {
  return result.provisional || settled.budget.size() != result.budget.size() ||
         settled.flags.size() != result.flags.size();
}

bool is_ready(const std::future<EvaluationOutput>& end) {
  return end.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

} // namespace

RunEvaluator::RunEvaluator(Recipe recipe, const EvaluationLimits& limits)
    : recipe_(std::make_shared<const Recipe>(std::move(recipe))), method_(make_method(recipe_)),
      records_(*recipe_, method_->searches(), limits.samples_of_a_source, limits.behind,
               limits.schedule, given_up_.get_token()),
      level_watch_(*recipe_), rate_watch_(*recipe_), summary_(*recipe_),
      runs_ahead_(limits.ahead && method_->can_run_ahead()),
      clock_to_the_end_(limits.clock_to_the_end), clock_end_(limits.clock_end),
      never_waits_(limits.never_waits), count_(limits.count),
      evaluations_(limits.evaluations_at_once) {
  records_.copy_samples(evaluations_.in_background());
  records_.may_begin_late(limits.may_begin_late);
  begin_work(count_, "evaluating", "steps", recipe_->excitations());
  if (auto source = method_->clock_source()) {
    clock_.emplace(std::move(*source), recipe_->roles.temperature);
  }
}

RunEvaluator::~RunEvaluator() {
  give_up();
}

void RunEvaluator::give_up() {
  given_up_.request_stop();
  evaluations_.stop();
}

Expected<void> RunEvaluator::describe(const std::string& source,
                                      drivers::SourceDescription description) {
  SourceRecord* record = records_.find(source);
  if (record == nullptr || is_ending()) {
    return {};
  }
  auto before = record->described() ? std::optional(record->description()) : std::nullopt;
  record->describe(std::move(description));
  auto checked = check_source(*recipe_, records_, *record).and_then([&] {
    return method_->check_time_scales(records_);
  });
  if (!checked) {
    if (before) {
      record->describe(std::move(*before));
    }
    return checked;
  }
  ahead_.reset();
  if (!recipe_->dut().empty()) { // else all channels are under calibration
    keep_needed_channels(*recipe_, *record);
  }
  if (clock_ && clock_->source() == source) {
    clock_->describe(record->description());
  }
  return {};
}

void RunEvaluator::describe_signals(const std::string& source,
                                    std::vector<drivers::QuadratureSignals> signals) {
  SourceRecord* record = records_.find(source);
  if (record == nullptr || is_ending() || !record->described() ||
      record->description().quadrature_signals == signals) {
    return;
  }
  drivers::SourceDescription description = record->description();
  description.quadrature_signals = std::move(signals);
  record->describe(std::move(description));
  ahead_.reset();
}

void RunEvaluator::add(const std::string& source, const SourceBlock& block,
                       const std::optional<BlockTimes>& times) {
  SourceRecord* record = records_.find(source);
  if (record == nullptr || is_ending()) {
    return;
  }
  if (times) {
    records_.note_times(source, block, *times);
  }
  if (!record->add(block)) {
    return;
  }
  rate_watch_.add(source, block);
  if (clock_ && clock_->source() == source && !lost_at_clock_end_) {
    follow_clock(*record, block);
  }
  if (source_of_clock_alone()) {
    record->forget_before(std::numeric_limits<std::int64_t>::max());
  }
}

void RunEvaluator::follow_clock(const SourceRecord& record, const SourceBlock& block) {
  clock_->add(block);
  if (clock_end_ && clock_->last_block() == clock_end_) {
    lost_at_clock_end_ = record.lost();
  }
}

bool RunEvaluator::is_ready_for(const std::string& source, std::uint64_t session) {
  const SourceRecord* record = records_.find(source);
  return record == nullptr || is_ending() || !record->is_new_session(session) ||
         !records_.end_session(source, next_step_);
}

bool RunEvaluator::has_all_steps() const {
  const ExcitationProgress& excitation = records_.excitation();
  return next_step_ >= excitation.steps_expected() &&
         (excitation.ended() || (!excitation.is_conducted() && has_planned_steps()));
}

std::optional<std::string> RunEvaluator::source_of_clock_alone() const {
  const bool goes_on = clock_to_the_end_ && clock_ && !is_ending() && has_all_steps() &&
                       !lost_at_clock_end_ && !records_.of(clock_->source()).ended();
  return goes_on ? std::optional(clock_->source()) : std::nullopt;
}

bool RunEvaluator::needs_survey() const {
  return !recipe_->whole_record && !records_.excitation().is_conducted() &&
         !records_.agree_with_plan();
}

bool RunEvaluator::is_evaluated(const TriggeredRecord& record) const {
  const auto place = records_.excitation().order().find(record.step, record.attempt);
  return place && *place < next_step_;
}

void RunEvaluator::note_second_writer(const std::string& source) {
  if (SourceRecord* record = records_.find(source); record != nullptr && !is_ending()) {
    record->note_second_writer();
  }
}

void RunEvaluator::add(const std::string& source, TriggeredRecord record) {
  if (!is_ending() && !is_evaluated(record)) {
    method_->add(source, std::move(record));
  }
}

void RunEvaluator::add(const std::string& source, ReferenceStep step) {
  if (!is_ending() && source == recipe_->reference_table && !source.empty()) {
    ahead_.reset();
    method_->add(std::move(step));
  }
}

void RunEvaluator::announce(const StepAnnouncement& announcement,
                            std::optional<std::int64_t> heard_ns) {
  if (!is_ending()) {
    records_.announce(announcement, heard_ns);
  }
}

bool RunEvaluator::is_evaluating() const {
  return !evaluations_.is_idle() || (ending_.valid() && !is_ready(ending_));
}

void RunEvaluator::end_of_excitation(bool aborted) {
  records_.excitation().end(aborted);
}

void RunEvaluator::finish_now() {
  records_.excitation().cut_short();
}

std::optional<std::string> RunEvaluator::excess_of_level() {
  const auto step = records_.excitation().excited_step();
  return step && !is_ending() && recipe_->reference_table.empty()
             ? level_watch_.look(records_.of(recipe_->reference().source), records_.planned(*step))
             : std::nullopt;
}

void RunEvaluator::take_results(std::vector<StepResult> results, EvaluationOutput& output) {
  for (StepResult& result : results) {
    summary_.add(result);
    line_bounds_.add(result);
    channel_faults_.add(result);
    keep(result);
    output.results.push_back(std::move(result));
  }
}

// In place of that of an earlier attempt.
void RunEvaluator::keep(const StepResult& result) {
  std::erase_if(results_, [&](const StepResult& other) {
    return other.step == result.step && other.repetition == result.repetition &&
           other.channel == result.channel;
  });
  if (!result.lines.empty()) {
    results_.push_back(result);
  }
}

bool RunEvaluator::evaluate_next_steps(EvaluationOutput& output) {
  bool has_room = true;
  while (next_step_ < records_.excitation().steps_expected() && records_.is_searched(next_step_) &&
         method_->is_complete(next_step_, records_)) {
    has_room = !never_waits_ || evaluations_.has_room();
    if (!has_room) {
      break;
    }
    evaluations_.make_room();
    if (is_given_up()) {
      return true;
    }
    evaluations_.begin(completed(evaluation_of_next_step()));
    ++next_step_;
  }
  take_results(evaluations_.take_finished(), output);
  return has_room;
}

// With what the evaluation of a step by itself does not know.
Evaluation RunEvaluator::completed(Evaluation evaluation) const {
  return [evaluation = std::move(evaluation), recipe = recipe_, count = count_,
          attempt = records_.excitation().order().attempt(next_step_),
          degc = recipe_->roles.temperature
                     ? step_temperature_degc(records_, *recipe_->roles.temperature, next_step_)
                     : std::nullopt,
          given_up = given_up_.get_token()](const std::stop_token& stop) {
    if (given_up.stop_requested()) {
      return std::vector<StepResult>{};
    }
    std::vector<StepResult> results = evaluation(stop);
    complete(*recipe, attempt, degc, stop, results);
    add_done(count);
    return results;
  };
}

Evaluation RunEvaluator::evaluation_of_next_step() {
  auto ahead = std::exchange(ahead_, std::nullopt);
  if (ahead && ahead->inputs.step() == next_step_ && ahead->inputs.still_holds(records_)) {
    ++steps_ready_;
    return [results = std::move(ahead->results)](const std::stop_token&) { return results; };
  }
  return method_->evaluation(next_step_, records_);
}

void RunEvaluator::evaluate_ahead() {
  if (!runs_ahead_ || evaluations_.in_background() ||
      next_step_ >= records_.excitation().steps_expected() || records_.is_searched(next_step_) ||
      !records_.is_expected(next_step_) || !method_->is_complete(next_step_, records_)) {
    return;
  }
  if (!ahead_ || !ahead_->inputs.still_holds(records_)) {
    ahead_ = AheadOfEnd{StepSnapshot(records_, next_step_),
                        method_->evaluation(next_step_, records_)({})};
  }
}

EvaluationOutput RunEvaluator::take_output() {
  EvaluationOutput output;
  if (finished_ || is_given_up() || !undescribed().empty()) {
    return output;
  }
  if (!is_ending() && !has_all_steps()) {
    if (runs_ahead_ && recipe_->reference_table.empty()) {
      records_.search(next_step_ + 1); // a result does not wait for the search for the next step
    } else {
      records_.search(); // of a table the samples are ahead, and tell when all was excited
    }
    if (!evaluate_next_steps(output)) {
      return output;
    }
    if (runs_ahead_ && !output.results.empty()) {
      return output; // they do not wait for the rest, which the next call does
    }
    evaluate_ahead();
    records_.forget_before_step(next_step_);
  }
  if (is_given_up()) {
    return {};
  }
  if (is_ending() || records_.excitation().is_cut_short() ||
      (has_all_steps() && !source_of_clock_alone())) {
    finish(output);
  }
  return output;
}

std::vector<StepResult> RunEvaluator::settled_results() {
  const bool by_method = method_->settle(results_);
  std::vector<StepResult> settled;
  for (const StepResult& one : results_) {
    StepResult now = is_given_up() ? one : channel_faults_.settled(line_bounds_.settled(one));
    if (by_method || is_changed(one, now)) {
      settled.push_back(std::move(now));
    }
  }
  begin_work(count_, "settling", "results", settled.size());
  for (StepResult& one : settled) {
    if (is_given_up()) {
      break;
    }
    redo_monte_carlo_check(recipe_->monte_carlo_trials, evaluations_.stop_token(), one);
    add_done(count_);
  }
  return settled;
}

std::string RunEvaluator::reference_unit() const {
  if (!recipe_->reference_table.empty()) {
    return reference_step_unit;
  }
  const SourceRecord& acs = records_.of(recipe_->reference().source);
  return excitation_unit(acs.description(), recipe_->reference().channel);
}

// A result that was settled is handed over once, with its last flag.
void RunEvaluator::close(EvaluationOutput& output) const {
  const DescribedRun run{.recipe = *recipe_,
                         .reference_unit = reference_unit(),
                         .nominal_rate_hz = [&](const std::string& source) {
                           return records_.of(source).description().nominal_rate_hz;
                         }};
  for (StepResult& flagged : add_closures(run, summary_.results(), output.transfer_functions)) {
    const auto earlier = std::ranges::find_if(output.settled, [&](const StepResult& one) {
      return one.channel == flagged.channel && one.step == flagged.step &&
             one.repetition == flagged.repetition;
    });
    if (earlier == output.settled.end()) {
      output.settled.push_back(std::move(flagged));
    } else {
      *earlier = std::move(flagged);
    }
  }
}

// What all steps together tell, of what does not change any more.
EvaluationOutput RunEvaluator::end_of_run() {
  EvaluationOutput end;
  end.settled = settled_results();
  if (is_given_up()) {
    return end;
  }
  for (const StepResult& result : end.settled) {
    summary_.add(result);
  }
  end.transfer_functions = summary_.transfer_functions();
  close(end);
  if (clock_) {
    end.clock_reports =
        clock_->reports(lost_at_clock_end_.value_or(records_.of(clock_->source()).lost()));
  }
  for (ClockReport& report : method_->clock_reports()) {
    end.clock_reports.push_back(std::move(report));
  }
  return end;
}

void RunEvaluator::finish(EvaluationOutput& output) {
  if (!ending_.valid()) {
    if (never_waits_ && !evaluations_.is_idle()) {
      return;
    }
    take_results(evaluations_.take_all(), output);
    ending_ = std::async(never_waits_ ? std::launch::async : std::launch::deferred,
                         [this] { return end_of_run(); });
  }
  if (never_waits_ && !is_ready(ending_)) {
    return;
  }
  EvaluationOutput end = ending_.get();
  if (is_given_up()) {
    output = {};
    return;
  }
  finished_ = true;
  end.results = std::move(output.results);
  output = std::move(end);
}

} // namespace dyncal::inline evaluation
