#include "services/evaluation/closures/closures.hpp"

#include <algorithm>
#include <iterator>

#include "services/evaluation/closures/clock_closures.hpp"
#include "services/evaluation/closures/phase_closures.hpp"
#include "services/evaluation/closures/record_closures.hpp"
#include "services/evaluation/closures/repetition_closures.hpp"

namespace dyncal::inline evaluation {
namespace {

ChannelRun run_of(const DescribedRun& described, std::span<const StepResult> results,
                  const TransferFunction& function) {
  ChannelRun run{.recipe = described.recipe,
                 .function = function,
                 .results = {},
                 .reference_unit = described.reference_unit,
                 .nominal_rate_hz = described.nominal_rate_hz(source_of(function.channel))};
  for (const StepResult& result : results) {
    if (result.valid && result.channel == function.channel) {
      run.results.push_back(&result);
    }
  }
  const auto place = [&](const StepResult* one) {
    const auto& steps = described.recipe.steps;
    return std::find_if(steps.begin(), steps.end(), [&](const RecipeStep& step) {
      return step.step == one->step && step.repetition == one->repetition;
    });
  };
  std::stable_sort(run.results.begin(), run.results.end(),
                   [&](const auto* a, const auto* b) { return place(a) < place(b); });
  return run;
}

void append(std::vector<Closure> more, std::vector<Closure>& all) {
  std::move(more.begin(), more.end(), std::back_inserter(all));
}

void add_flag(const std::vector<Closure>& closures, std::vector<Flag>& flags) {
  for (const Closure& closure : closures) {
    if (is_open(closure)) {
      flags.push_back(flag_with_reason(ResultFlag::closure_open, closure.sentence));
      if (closure.kind == ClosureKind::delay_fit) {
        flags.push_back(make_flag(ResultFlag::group_delay_not_constant));
      }
    }
  }
}

// With the other channels of its kind.
std::vector<Closure> of_channels(const ChannelRun& run, const std::vector<ChannelRun>& all) {
  std::vector<Closure> closures;
  for (const ChannelRun& other : all) {
    if (other.function.channel != run.function.channel &&
        source_of(other.function.channel) == source_of(run.function.channel) &&
        other.function.unit == run.function.unit) {
      closures.push_back(delays_of_channels(run, other));
      closures.push_back(clocks_of_channels(run, other));
    }
  }
  if (closures.empty()) {
    for (const auto kind : {ClosureKind::channel_delays, ClosureKind::channel_clocks}) {
      closures.push_back(not_possible(kind, "", "the sensor has no other channel of this kind"));
    }
  }
  return closures;
}

} // namespace

std::vector<StepResult> add_closures(const DescribedRun& described,
                                     std::span<const StepResult> results,
                                     std::vector<TransferFunction>& functions) {
  std::vector<ChannelRun> runs;
  runs.reserve(functions.size());
  for (const TransferFunction& function : functions) {
    runs.push_back(run_of(described, results, function));
  }
  std::vector<std::vector<Closure>> all(runs.size());
  std::vector<StepResult> flagged;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    append(clock_closures(runs[i]), all[i]);
    append(record_closures(runs[i]), all[i]);
    RepetitionClosures repetitions = repetition_closures(runs[i]);
    append(std::move(repetitions.closures), all[i]);
    append(phase_closures(runs[i]), all[i]);
    append(of_channels(runs[i], runs), all[i]);
    for (const StepResult* off : repetitions.off) {
      flagged.push_back(*off);
      flagged.back().flags.push_back(flag_with_reason(
          ResultFlag::closure_open, "it does not agree with the other repetitions of its point"));
    }
  }
  for (std::size_t i = 0; i < functions.size(); ++i) {
    functions[i].closures = std::move(all[i]);
    add_flag(functions[i].closures, functions[i].flags);
  }
  return flagged;
}

} // namespace dyncal::inline evaluation
