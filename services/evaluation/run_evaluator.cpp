#include "services/evaluation/run_evaluator.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/evaluation/method/analogue_step_evaluation.hpp"
#include "services/evaluation/method/series_clock.hpp"
#include "services/evaluation/method/time_scales.hpp"

namespace dyncal::services {
namespace {

// Samples that a source's service received this long after a step was over belong to later times
// for sure: devices, services and clocks of hosts that keep time by NTP delay and differ by far
// less.
constexpr std::int64_t grace_ns = 2'000'000'000;

std::vector<std::string> channel_names(const wire::SourceDescription& description) {
  std::vector<std::string> names;
  for (const wire::ChannelDescription& channel : description.channels()) {
    names.push_back(channel.name());
  }
  return names;
}

std::vector<std::string> flags_of(const Recipe& recipe, const RecipeStep& step,
                                  const SourceRecord& source, const StretchOfTime& stretch) {
  std::vector<std::string> flags;
  if (source.lost_between(stretch.begin_ns, stretch.end_ns) > 0) {
    flags.push_back(source.source() + ": samples lost");
  }
  if (!recipe.whole_record &&
      static_cast<double>(stretch.end_ns - stretch.begin_ns) < 0.95e9 * step.duration_s) {
    flags.push_back(source.source() + ": shorter than planned");
  }
  return flags;
}

std::string no_sine(const RecipeStep& step, const ChannelName& sync) {
  return fmt::format("no steady sine of {} Hz was found in {}; is the sync signal connected?",
                     step.frequency_text_hz, sync.text());
}

} // namespace

RunEvaluator::RunEvaluator(Recipe recipe, std::size_t evaluations_at_once)
    : recipe_(std::move(recipe)), clock_(recipe_), summary_(recipe_),
      evaluations_(evaluations_at_once) {
  for (const std::string& source : recipe_.sources()) {
    records_.emplace(source, std::make_unique<SourceRecord>(source));
  }
  acs_search_ = std::make_unique<StepSearch>(recipe_, *records_.at(recipe_.sync_acs.source),
                                             recipe_.sync_acs.channel);
  if (!by_series() && !recipe_.without_sync()) {
    dau_search_ = std::make_unique<StepSearch>(recipe_, *records_.at(recipe_.sync_dau.source),
                                               recipe_.sync_dau.channel);
  }
}

RunEvaluator::~RunEvaluator() = default;

SourceRecord* RunEvaluator::record(const std::string& source) {
  const auto found = records_.find(source);
  return found == records_.end() ? nullptr : found->second.get();
}

Expected<void> RunEvaluator::describe(const wire::SourceDescription& description) {
  SourceRecord* source = record(description.source().to_string());
  if (source == nullptr) {
    return {};
  }
  const std::vector<std::string> names = channel_names(description);
  for (const ChannelName& channel : channels_needed()) {
    if (channel.source == source->source() &&
        std::find(names.begin(), names.end(), channel.channel) == names.end()) {
      return fail(ErrorCode::no_source,
                  fmt::format("source '{}' has no channel '{}'; it has: {}", channel.source,
                              channel.channel, fmt::join(names, ", ")));
    }
  }
  source->describe(description);
  if (!recipe_.dut.empty()) { // else all channels are under calibration
    keep_only_what_is_needed(*source);
  }
  clock_.describe(description);
  return check_time_scales(recipe_, [this](const std::string& name) {
    const SourceRecord& other = *records_.at(name);
    return other.described() ? std::optional(other.description().time_base()) : std::nullopt;
  });
}

std::vector<ChannelName> RunEvaluator::channels_needed() const {
  std::vector<ChannelName> needed{recipe_.reference, recipe_.sync_acs, recipe_.sync_dau};
  needed.insert(needed.end(), recipe_.dut.begin(), recipe_.dut.end());
  if (recipe_.temperature) {
    needed.push_back(*recipe_.temperature);
  }
  return needed;
}

void RunEvaluator::keep_only_what_is_needed(SourceRecord& source) const {
  std::set<std::size_t> channels;
  for (const ChannelName& name : channels_needed()) {
    if (const auto channel = source.channel(name.channel);
        channel && name.source == source.source()) {
      channels.insert(*channel);
    }
  }
  source.keep_only(std::move(channels));
}

std::vector<std::string> RunEvaluator::undescribed() const {
  std::vector<std::string> names;
  for (const auto& [name, source] : records_) {
    if (!source->described()) {
      names.push_back(name);
    }
  }
  return names;
}

void RunEvaluator::add(const wire::SampleBlock& block) {
  SourceRecord* source = record(block.source().to_string());
  if (source != nullptr && !finished_ && source->add(block)) {
    clock_.add(block);
  }
}

void RunEvaluator::add(const wire::TriggeredRecord& record) {
  const bool evaluated = std::any_of(
      recipe_.steps.begin(), recipe_.steps.begin() + static_cast<std::ptrdiff_t>(next_step_),
      [&](const RecipeStep& step) { return step.step == record.step(); });
  if (finished_ || !by_series() || evaluated || record.run() != recipe_.run) {
    return;
  }
  const std::string source = record.source().to_string();
  if (source == recipe_.sync_dau.source) {
    shots_.add_trace(record);
  } else if (source == recipe_.dut.front().source) {
    shots_.add_series(record);
  }
}

void RunEvaluator::announce(const wire::Excitation& excitation) {
  const auto found =
      std::find_if(recipe_.steps.begin(), recipe_.steps.end(),
                   [&](const RecipeStep& step) { return step.step == excitation.step(); });
  if (found == recipe_.steps.end()) {
    return;
  }
  const auto step = static_cast<std::size_t>(found - recipe_.steps.begin());
  steps_announced_ = std::max(steps_announced_, step + 1);
  if (excitation.state() == wire::EXCITATION_DONE ||
      excitation.state() == wire::EXCITATION_ABORTED) {
    over_utc_ns_.emplace(step, excitation.window_end_utc_ns());
  }
  if (excitation.state() == wire::EXCITATION_ABORTED) {
    broken_off_.insert(step);
  }
  // Only the newest state is kept on the way: a step that is announced says that the ones before it
  // are over.
  for (std::size_t before = next_step_; before < step; ++before) {
    over_utc_ns_.emplace(before, excitation.window_begin_utc_ns());
  }
}

void RunEvaluator::end_of_excitation(bool aborted) {
  excitation_done_ = true;
  excitation_aborted_ = excitation_aborted_ || aborted;
}

std::size_t RunEvaluator::steps_expected() const {
  return excitation_aborted_ ? std::min(steps_announced_, recipe_.steps.size())
                             : recipe_.steps.size();
}

bool RunEvaluator::over_in(const SourceRecord& source, std::size_t step) const {
  if (finish_now_ || source.ended()) {
    return true;
  }
  const auto over = over_utc_ns_.find(step);
  return over != over_utc_ns_.end() && source.newest_received_utc_ns() > over->second + grace_ns;
}

void RunEvaluator::follow(StepSearch& search, const SourceRecord& source) {
  const std::size_t expected = steps_expected();
  if (expected == 0) {
    return;
  }
  search.advance(expected - 1);
  while (search.step() < expected && over_in(source, search.step())) {
    search.give_up_step();
    search.advance(expected - 1);
  }
}

// All that were wanted; or when none can come any more, which has the same grace as the samples of
// the ACS.
bool RunEvaluator::shots_are_there(std::size_t step) const {
  const bool complete = over_utc_ns_.contains(step) &&
                        shots_.of_step(recipe_.steps[step].step).size() >= recipe_.shots;
  return complete || over_in(*records_.at(recipe_.sync_acs.source), step);
}

bool RunEvaluator::sensors_are_there(std::size_t step) const {
  const auto stretch = search_of_sensors().stretch(step);
  const std::vector<std::string> sources = recipe_.dut_sources();
  return !stretch || std::all_of(sources.begin(), sources.end(), [&](const std::string& name) {
    const SourceRecord& sensor = *records_.at(name);
    return (!sensor.stamps_ns().empty() && sensor.stamps_ns().back() >= stretch->end_ns) ||
           over_in(sensor, step);
  });
}

bool RunEvaluator::ready_to_evaluate(std::size_t step) const {
  if (acs_search_->step() <= step || (dau_search_ && dau_search_->step() <= step)) {
    return false;
  }
  if (by_series()) {
    return shots_are_there(step);
  }
  return !recipe_.stamped_apart() || sensors_are_there(step);
}

void RunEvaluator::take_results(std::vector<wire::CalibrationResult> results,
                                EvaluationOutput& output) {
  for (wire::CalibrationResult& result : results) {
    summary_.add(result);
    output.results.push_back(std::move(result));
  }
}

void RunEvaluator::evaluate_next_steps(EvaluationOutput& output) {
  while (next_step_ < steps_expected() && ready_to_evaluate(next_step_)) {
    evaluations_.make_room();
    evaluations_.begin(evaluation_by_method(recipe_.steps[next_step_]));
    ++next_step_;
  }
  take_results(evaluations_.take_finished(), output);
}

EvaluationQueue::Evaluation RunEvaluator::evaluation_by_method(const RecipeStep& step) {
  if (by_series()) { // a step depends on the one before
    return [results = evaluate_triggered_step(step)] { return results; };
  }
  if (recipe_.method == wire::METHOD_ANALOGUE) {
    return analogue_evaluation(step);
  }
  return recipe_.stamped_apart() ? apart_evaluation(step) : stamped_evaluation(step);
}

std::shared_ptr<const SourceRecord> RunEvaluator::samples_of(const std::string& source,
                                                             const StretchOfTime& stretch) const {
  const SourceRecord& whole = *records_.at(source);
  if (evaluations_.in_background()) {
    return std::make_shared<const SourceRecord>(whole.part(stretch.begin_ns, stretch.end_ns));
  }
  return {std::shared_ptr<const SourceRecord>(), &whole};
}

EvaluationQueue::Evaluation RunEvaluator::analogue_evaluation(const RecipeStep& step) const {
  const SourceRecord& acs = *records_.at(recipe_.reference.source);
  const auto stretch = acs_search_->stretch(next_step_);
  if (!stretch) {
    return [results = results_of_missing_step(recipe_, step, acs,
                                              no_sine(step, recipe_.sync_acs))] { return results; };
  }
  std::vector<std::string> flags = flags_of(recipe_, step, acs, *stretch);
  if (broken_off_.contains(next_step_)) {
    flags.emplace_back("excitation broken off");
  }
  return [this, &step, samples = samples_of(acs.source(), *stretch), stretch, flags] {
    return evaluate_analogue_step(recipe_, step, *samples, *stretch, flags);
  };
}

EvaluationQueue::Evaluation RunEvaluator::stamped_evaluation(const RecipeStep& step) const {
  const SourceRecord& acs = *records_.at(recipe_.sync_acs.source);
  const SourceRecord& dau = *records_.at(recipe_.sync_dau.source);
  const auto acs_stretch = acs_search_->stretch(next_step_);
  const auto dau_stretch = dau_search_->stretch(next_step_);
  if (!acs_stretch || !dau_stretch) {
    const std::string problem = no_sine(step, acs_stretch ? recipe_.sync_dau : recipe_.sync_acs);
    return [results = results_of_missing_step(recipe_, step, dau, problem)] { return results; };
  }
  std::vector<std::string> flags = flags_of(recipe_, step, acs, *acs_stretch);
  const std::vector<std::string> dau_flags = flags_of(recipe_, step, dau, *dau_stretch);
  flags.insert(flags.end(), dau_flags.begin(), dau_flags.end());
  if (broken_off_.contains(next_step_)) {
    flags.emplace_back("excitation broken off");
  }
  return [this, &step, acs_samples = samples_of(acs.source(), *acs_stretch),
          dau_samples = samples_of(dau.source(), *dau_stretch), acs_stretch, dau_stretch, flags] {
    return evaluate_step(recipe_, step, *acs_samples, *acs_stretch, *dau_samples, *dau_stretch,
                         flags);
  };
}

EvaluationQueue::Evaluation RunEvaluator::apart_evaluation(const RecipeStep& step) const {
  const std::vector<std::string> sensors = recipe_.dut_sources();
  const auto acs_stretch = acs_search_->stretch(next_step_);
  const auto stretch = search_of_sensors().stretch(next_step_);
  if (!acs_stretch || !stretch) {
    const std::string problem = no_sine(step, acs_stretch ? recipe_.sync_dau : recipe_.sync_acs);
    return [results = results_of_missing_step(recipe_, step, *records_.at(sensors.front()),
                                              problem)] { return results; };
  }
  std::vector<std::string> flags =
      flags_of(recipe_, step, *records_.at(recipe_.sync_acs.source), *acs_stretch);
  std::vector<std::string> others = sensors;
  if (!by_absolute_time()) {
    others.insert(others.begin(), recipe_.sync_dau.source);
  }
  std::vector<std::shared_ptr<const SourceRecord>> samples;
  for (const std::string& source : others) {
    samples.push_back(samples_of(source, *stretch));
    const std::vector<std::string> more = flags_of(recipe_, step, *records_.at(source), *stretch);
    flags.insert(flags.end(), more.begin(), more.end());
  }
  if (broken_off_.contains(next_step_)) {
    flags.emplace_back("excitation broken off");
  }
  return [this, &step, acs = samples_of(recipe_.sync_acs.source, *acs_stretch), acs_stretch,
          samples, stretch, flags] {
    const SourceRecord* const sync = by_absolute_time() ? nullptr : samples.front().get();
    std::vector<const SourceRecord*> of_sensors;
    for (std::size_t i = sync == nullptr ? 0 : 1; i < samples.size(); ++i) {
      of_sensors.push_back(samples[i].get());
    }
    return evaluate_apart_step(recipe_, step, {*acs, *acs_stretch, sync, *stretch}, of_sensors,
                               flags);
  };
}

std::vector<wire::CalibrationResult> RunEvaluator::evaluate_triggered_step(const RecipeStep& step) {
  const SourceRecord& acs = *records_.at(recipe_.sync_acs.source);
  const SourceRecord& sensor = *records_.at(recipe_.dut.front().source);
  const auto stretch = acs_search_->stretch(next_step_);
  if (!stretch) {
    return results_of_missing_step(recipe_, step, sensor, no_sine(step, recipe_.sync_acs));
  }
  std::vector<std::string> flags = flags_of(recipe_, step, acs, *stretch);
  if (broken_off_.contains(next_step_)) {
    flags.emplace_back("excitation broken off");
  }
  SeriesStepOutput evaluated = evaluate_series_step(
      recipe_, step,
      {acs, *stretch, *records_.at(recipe_.sync_dau.source), sensor, shots_.of_step(step.step)},
      start_, std::move(flags));
  start_ = evaluated.start;
  if (evaluated.rate) {
    rates_.push_back(*evaluated.rate);
  }
  shots_.forget_step(step.step);
  return std::move(evaluated.results);
}

void RunEvaluator::forget_what_is_evaluated() {
  const auto forget = [&](SourceRecord& source, const StepSearch& search) {
    std::int64_t needed = search.needed_from_ns();
    for (std::size_t step = next_step_; step < search.step(); ++step) {
      if (const auto stretch = search.stretch(step)) {
        needed = std::min(needed, stretch->begin_ns);
      }
    }
    source.forget_before(needed);
  };
  forget(*records_.at(recipe_.sync_acs.source), *acs_search_);
  if (dau_search_) {
    forget(*records_.at(recipe_.sync_dau.source), *dau_search_);
  }
  if (recipe_.stamped_apart()) {
    for (const std::string& name : recipe_.dut_sources()) {
      forget(*records_.at(name), search_of_sensors());
    }
  }
}

EvaluationOutput RunEvaluator::take_output() {
  EvaluationOutput output;
  if (finished_ || !undescribed().empty()) {
    return output;
  }
  follow(*acs_search_, *records_.at(recipe_.sync_acs.source));
  if (dau_search_) {
    follow(*dau_search_, *records_.at(recipe_.sync_dau.source));
  }
  evaluate_next_steps(output);
  forget_what_is_evaluated();
  const bool all_steps =
      next_step_ >= steps_expected() && (excitation_done_ || next_step_ >= recipe_.steps.size());
  if (all_steps || finish_now_) {
    finish(output);
  }
  return output;
}

void RunEvaluator::finish_now() {
  finish_now_ = true;
}

void RunEvaluator::finish(EvaluationOutput& output) {
  finished_ = true;
  take_results(evaluations_.take_all(), output);
  output.transfer_functions = summary_.transfer_functions();
  if (!by_series()) {
    output.clock_reports = clock_.reports();
  } else if (!rates_.empty()) {
    output.clock_reports.push_back(
        series_clock_report(recipe_, recipe_.dut.front().source, rates_));
  }
}

} // namespace dyncal::services
