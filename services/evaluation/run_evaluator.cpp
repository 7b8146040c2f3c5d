#include "services/evaluation/run_evaluator.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dyncal::services {
namespace {

// Samples that a source's service received this long after a step was over belong to later times for sure: devices, services and clocks
// of hosts that keep time by NTP delay and differ by far less.
constexpr std::int64_t grace_ns = 2'000'000'000;

std::vector<std::string> channel_names(const SourceDescription& description) {
  std::vector<std::string> names;
  for (const ChannelDescription& channel : description.channels()) {
    names.push_back(channel.name());
  }
  return names;
}

std::vector<std::string> flags_of(const Recipe& recipe, const RecipeStep& step, const SourceRecord& source, const StretchOfTime& stretch) {
  std::vector<std::string> flags;
  if (source.lost_between(stretch.begin_ns, stretch.end_ns) > 0) {
    flags.push_back(source.source() + ": samples lost");
  }
  if (!recipe.whole_record && static_cast<double>(stretch.end_ns - stretch.begin_ns) < 0.95e9 * step.duration_s) {
    flags.push_back(source.source() + ": shorter than planned");
  }
  return flags;
}

} // namespace

RunEvaluator::RunEvaluator(Recipe recipe) : recipe_(std::move(recipe)), clock_(recipe_), summary_(recipe_) {
  for (const std::string& source : recipe_.sources()) {
    records_.emplace(source, std::make_unique<SourceRecord>(source));
  }
  acs_search_ = std::make_unique<StepSearch>(recipe_, *records_.at(recipe_.sync_acs.source), recipe_.sync_acs.channel);
  dau_search_ = std::make_unique<StepSearch>(recipe_, *records_.at(recipe_.sync_dau.source), recipe_.sync_dau.channel);
}

RunEvaluator::~RunEvaluator() = default;

SourceRecord* RunEvaluator::record(const std::string& source) {
  const auto found = records_.find(source);
  return found == records_.end() ? nullptr : found->second.get();
}

Expected<void> RunEvaluator::describe(const SourceDescription& description) {
  SourceRecord* source = record(description.source().to_string());
  if (source == nullptr) {
    return {};
  }
  std::vector<ChannelName> needed{recipe_.reference, recipe_.sync_acs, recipe_.sync_dau};
  needed.insert(needed.end(), recipe_.dut.begin(), recipe_.dut.end());
  if (recipe_.temperature) {
    needed.push_back(*recipe_.temperature);
  }
  const std::vector<std::string> names = channel_names(description);
  for (const ChannelName& channel : needed) {
    if (channel.source == source->source() && std::find(names.begin(), names.end(), channel.channel) == names.end()) {
      return tl::unexpected(Error{ErrorCode::no_source, fmt::format("source '{}' has no channel '{}'; it has: {}", channel.source,
                                                                    channel.channel, fmt::join(names, ", "))});
    }
  }
  source->describe(description);
  clock_.describe(description);
  return {};
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

void RunEvaluator::add(const SampleBlock& block) {
  SourceRecord* source = record(block.source().to_string());
  if (source != nullptr && !finished_ && source->add(block)) {
    clock_.add(block);
  }
}

void RunEvaluator::announce(const Excitation& excitation) {
  const auto found =
      std::find_if(recipe_.steps.begin(), recipe_.steps.end(), [&](const RecipeStep& step) { return step.step == excitation.step(); });
  if (found == recipe_.steps.end()) {
    return;
  }
  const auto step = static_cast<std::size_t>(found - recipe_.steps.begin());
  steps_announced_ = std::max(steps_announced_, step + 1);
  if (excitation.state() == EXCITATION_DONE || excitation.state() == EXCITATION_ABORTED) {
    over_utc_ns_.emplace(step, excitation.window_end_utc_ns());
  }
  if (excitation.state() == EXCITATION_ABORTED) {
    broken_off_.insert(step);
  }
  // Only the newest state is kept on the way: a step that is announced says that the ones before it are over.
  for (std::size_t before = next_step_; before < step; ++before) {
    over_utc_ns_.emplace(before, excitation.window_begin_utc_ns());
  }
}

void RunEvaluator::end_of_excitation(bool aborted) {
  excitation_done_ = true;
  excitation_aborted_ = excitation_aborted_ || aborted;
}

std::size_t RunEvaluator::steps_expected() const {
  return excitation_aborted_ ? std::min(steps_announced_, recipe_.steps.size()) : recipe_.steps.size();
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

void RunEvaluator::evaluate_next_steps(EvaluationOutput& output) {
  const SourceRecord& acs = *records_.at(recipe_.sync_acs.source);
  const SourceRecord& dau = *records_.at(recipe_.sync_dau.source);
  while (next_step_ < steps_expected() && acs_search_->step() > next_step_ && dau_search_->step() > next_step_) {
    const RecipeStep& step = recipe_.steps[next_step_];
    const auto acs_stretch = acs_search_->stretch(next_step_);
    const auto dau_stretch = dau_search_->stretch(next_step_);
    std::vector<CalibrationResult> results;
    if (acs_stretch && dau_stretch) {
      std::vector<std::string> flags = flags_of(recipe_, step, acs, *acs_stretch);
      const std::vector<std::string> dau_flags = flags_of(recipe_, step, dau, *dau_stretch);
      flags.insert(flags.end(), dau_flags.begin(), dau_flags.end());
      if (broken_off_.contains(next_step_)) {
        flags.emplace_back("excitation broken off");
      }
      results = evaluate_step(recipe_, step, acs, *acs_stretch, dau, *dau_stretch, flags);
    } else {
      const ChannelName& sync = acs_stretch ? recipe_.sync_dau : recipe_.sync_acs;
      results = results_of_missing_step(
          recipe_, step, dau,
          fmt::format("no steady sine of {} Hz was found in {}; is the sync signal connected?", step.frequency_text_hz, sync.text()));
    }
    for (CalibrationResult& result : results) {
      summary_.add(result);
      output.results.push_back(std::move(result));
    }
    ++next_step_;
  }
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
  forget(*records_.at(recipe_.sync_dau.source), *dau_search_);
}

EvaluationOutput RunEvaluator::take_output() {
  EvaluationOutput output;
  if (finished_ || !undescribed().empty()) {
    return output;
  }
  follow(*acs_search_, *records_.at(recipe_.sync_acs.source));
  follow(*dau_search_, *records_.at(recipe_.sync_dau.source));
  evaluate_next_steps(output);
  forget_what_is_evaluated();
  const bool all_steps = next_step_ >= steps_expected() && (excitation_done_ || next_step_ >= recipe_.steps.size());
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
  output.transfer_functions = summary_.transfer_functions();
  output.clock_reports = clock_.reports();
}

} // namespace dyncal::services
