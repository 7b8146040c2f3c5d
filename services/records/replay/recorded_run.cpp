#include "services/records/replay/recorded_run.hpp"

#include <algorithm>
#include <thread>

#include <fmt/core.h>

#include "services/contract/source_description.hpp"
#include "services/contract/source_kind.hpp"
#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "services/records/replay/recorded_run_feed.hpp"
#include "services/records/replay/recording_index.hpp"

namespace dyncal::inline records {
namespace {

// At once, one a processor; each holds the samples of its step.
constexpr std::size_t max_evaluations = 4;
constexpr std::size_t max_damages_named = 20;

// The recorder came later than the first step.
bool begins_behind(const RecordedRunIndex& index, const Recipe& recipe) {
  if (!index.first_announced || recipe.steps.empty()) {
    return false;
  }
  const StepAnnouncement first = from_message(*index.first_announced);
  return first.step != recipe.steps.front().step || first.attempt > 1 ||
         !first.repeated_steps.empty();
}

// From the answer to the run on, every message of every session.
bool has_all_messages(const RecordedSource& source, const std::string& run) {
  const auto leaves_out = [](const auto& one, const auto& next) {
    return one.first.session == next.first.session && next.first.number > one.first.number + 1;
  };
  return source.answered.contains(run) &&
         std::ranges::adjacent_find(source.messages, leaves_out) == source.messages.end();
}

// Some of what a source has sent since the beginning of the run, nobody has recorded.
bool may_lack_steps(const RecordedRunIndex& index, const Recipe& recipe) {
  const auto names = recipe.sources();
  return !std::ranges::all_of(names, [&](const std::string& name) {
    const auto found = index.sources.find(name);
    return found != index.sources.end() &&
           has_all_messages(found->second, index.plan.run().to_string());
  });
}

void add_setup(const RecordedRunIndex& index, RunOutcome& outcome) {
  for (const std::string& name : outcome.recipe->sources()) {
    const auto found = index.sources.find(name);
    if (found != index.sources.end() && found->second.newest) {
      const wire::SourceDescription& description = *found->second.newest;
      outcome.sources.push_back(
          {name, from_wire(description.kind()), description.software(), from_message(description)});
    }
  }
  if (index.analysis) {
    outcome.analysis_dds = index.analysis->dds();
    outcome.analysis_software = index.analysis->software();
    outcome.analysis_host = index.analysis->host();
  }
  outcome.began_utc_ns = static_cast<std::int64_t>(index.began);
  outcome.ended_utc_ns = static_cast<std::int64_t>(index.ended);
  outcome.pauses = index.pauses;
  if (index.newest.state() == wire::MEASUREMENT_ABORTED) {
    outcome.interrupted = index.newest.message() == interrupted_by_user;
    outcome.problem = outcome.interrupted ? "" : index.newest.message();
  }
}

std::vector<std::string> warnings_of(const RecordedRunIndex& index, const Recipe& recipe,
                                     const std::filesystem::path& path) {
  std::vector<std::string> warnings;
  const auto& damages = index.report.damages;
  for (std::size_t i = 0; i < std::min(damages.size(), max_damages_named); ++i) {
    warnings.push_back(recording::to_string(damages[i], path));
  }
  if (index.report.damage_count > max_damages_named) {
    warnings.push_back(fmt::format("{}: {} more places are damaged ('dyncal recording check')",
                                   path.string(), index.report.damage_count - max_damages_named));
  }
  if (index.ended == 0) {
    warnings.push_back(
        fmt::format("{}: the end of the run is not in the recording", path.string()));
  }
  const std::string run = index.plan.run().to_string();
  for (const std::string& name : recipe.sources()) {
    const auto found = index.sources.find(name);
    if (found == index.sources.end()) {
      warnings.push_back(fmt::format("{}: holds nothing of source '{}'", path.string(), name));
    } else if (!found->second.answered.contains(run)) {
      warnings.push_back(fmt::format("{}: the beginning of the run is missing in source '{}': look "
                                     "whether steps were taken for others",
                                     path.string(), name));
    }
  }
  return warnings;
}

bool has_restarted_source(const RecordedRunIndex& index, const Recipe& recipe) {
  const auto names = recipe.sources();
  return std::ranges::any_of(names, [&](const std::string& name) {
    const auto source = index.sources.find(name);
    return source != index.sources.end() && source->second.sessions.size() > 1;
  });
}

} // namespace

Expected<RecordedRunOutcome> evaluate_recording(recording::RecordingReader& reader,
                                                const RecordedRunOptions& wish,
                                                const std::stop_token& stop) {
  DYNCAL_TRY(const auto index, index_recording(reader, wish.run, wish.count, stop));
  DYNCAL_TRY(auto recipe, wish.recipe ? Expected<Recipe>(*wish.recipe) : parse_recipe(index.plan));
  recipe.bench = index.plan.bench().to_string();
  recipe.run = index.plan.run().to_string();
  if (wish.recipe) {
    recipe.source_settings.clear(); // the sources had read the file of their run
  }
  RecordedRunOutcome result;
  result.live_results = index.live_results;
  result.source_restarted = has_restarted_source(index, recipe);
  result.outcome = outcome_of(recipe);
  result.outcome.adc_file = wish.recipe ? std::nullopt : adc_file_of(index.plan);
  result.warnings = warnings_of(index, recipe, reader.path());
  add_setup(index, result.outcome);
  const bool behind = begins_behind(index, recipe);
  const bool may_begin_late = may_lack_steps(index, recipe);
  RunEvaluator evaluator(std::move(recipe),
                         {.evaluations_at_once = std::clamp<std::size_t>(
                              std::thread::hardware_concurrency(), 1, max_evaluations),
                          .clock_to_the_end = index.clock_end.has_value(),
                          .clock_end = index.clock_end,
                          .count = wish.count,
                          .behind = behind,
                          .may_begin_late = may_begin_late});
  const std::stop_callback end(stop, [&evaluator, all = wish.whole_or_none] {
    all ? evaluator.give_up() : evaluator.stop_checks();
  });
  RecordedRunFeed feed(reader, index, evaluator, result.outcome);
  const auto walked =
      reader.scan({.message =
                       [&](const recording::MessageInFile& message) {
                         if (!stop.stop_requested()) {
                           feed.take(message);
                         }
                       },
                   .walked = [&](std::uint64_t /*bytes*/) { return !stop.stop_requested(); }});
  if (!walked && walked.error().code != ErrorCode::interrupted) {
    return fail(walked.error());
  }
  const bool aborted = stop.stop_requested() || index.newest.state() != wire::MEASUREMENT_DONE;
  DYNCAL_TRY(feed.finish(aborted));
  if (wish.whole_or_none && stop.stop_requested()) {
    return fail(ErrorCode::interrupted, "interrupted");
  }
  result.outcome.interrupted = result.outcome.interrupted || stop.stop_requested();
  sort_outcome(result.outcome);
  return result;
}

} // namespace dyncal::inline records
