#include "services/replay/recorded_run.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <thread>
#include <variant>

#include <fmt/core.h>

#include "services/contract/bench_file_origin.hpp"
#include "services/contract/source_block.hpp"
#include "services/contract/source_description.hpp"
#include "services/contract/source_kind.hpp"
#include "services/contract/topics.hpp"
#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/evaluation/result/adc_file_message.hpp"
#include "services/evaluation/result/clock_report_message.hpp"
#include "services/evaluation/result/result_message.hpp"
#include "services/evaluation/result/transfer_function_message.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "services/recording/recorded_topics.hpp"
#include "services/replay/measured_later.hpp"
#include "services/replay/recorded_messages.hpp"
#include "services/replay/recording_index.hpp"
#include "services/replay/waiting_announcements.hpp"

namespace dyncal::services {
namespace {

namespace topics = bus::topics;

// At once, one a processor; each holds the samples of its step.
constexpr std::size_t max_evaluations = 4;
constexpr std::size_t max_damages_named = 20;
// A source that has restarted is waited with for so long (services/analysis/source_streams.hpp).
constexpr std::uint64_t session_limit_ns = 5'000'000'000;

void collect(const Recipe& recipe, EvaluationOutput output, RunOutcome& outcome) {
  for (auto* results : {&output.results, &output.settled}) {
    for (const StepResult& evaluated : *results) {
      StepResult result = from_message(to_message(recipe, evaluated));
      const auto known =
          std::find_if(outcome.results.begin(), outcome.results.end(), [&](const StepResult& one) {
            return one.channel == result.channel && one.step == result.step &&
                   one.repetition == result.repetition;
          });
      if (known == outcome.results.end()) {
        outcome.results.push_back(std::move(result));
      } else if (result.attempt >= known->attempt) {
        *known = std::move(result);
      }
    }
  }
  for (const TransferFunction& function : output.transfer_functions) {
    outcome.transfer_functions.push_back(from_message(to_message(recipe, function)));
  }
  for (const ClockReport& report : output.clock_reports) {
    outcome.clock_reports.push_back(from_message(to_message(recipe, report)));
  }
}

// The second walk: what was recorded goes to the evaluation.
class Evaluating {
public:
  Evaluating(const recording::RecordingReader& reader, const RecordedRunIndex& index,
             RunEvaluator& evaluator, RunOutcome& outcome)
      : evaluator_(evaluator), outcome_(outcome), others_(reader),
        bench_(index.plan.bench().to_string()), run_(index.plan.run().to_string()) {
    for (const std::string& name : evaluator.recipe().sources()) {
      if (const auto found = index.sources.find(name); found != index.sources.end()) {
        auto& source = sources_.try_emplace(name, Source{found->second}).first->second;
        source.next = found->second.messages.begin();
        // Without the answer in the recording its samples count from the first one.
        source.answered = !found->second.answered.contains(run_);
        if (!source.recorded.triggered) {
          announcements_.wait_for(name);
        }
      }
    }
    if (index.first_announced) {
      evaluator.expect_announcements();
    }
  }

  void take(const recording::MessageInFile& message) {
    if (!outcome_of_walk_ || evaluator_.finished()) {
      return;
    }
    now_ = message.message.log_time;
    ++walked_;
    const std::string& topic = message.channel.topic;
    if (topic == topics::excitation) {
      take_excitation(message);
    } else if (topic == topics::measurement) {
      take_state(message);
    } else if (topic == topics::dau_samples || topic == topics::acs_samples ||
               topic == topics::can_samples) {
      take_of_source<wire::SampleBlock>(message);
    } else if (topic == topics::dso_record || topic == topics::tss_record) {
      take_of_source<wire::TriggeredRecord>(message);
    } else {
      return;
    }
    announce(false);
    collect(evaluator_.recipe(), evaluator_.take_output(), outcome_);
  }

  [[nodiscard]] Expected<void> finish(bool aborted) {
    if (outcome_of_walk_ && !evaluator_.finished()) {
      for (auto& [name, source] : sources_) {
        hand_over_waiting(name, source, true);
      }
      announce(true);
      collect(evaluator_.recipe(), evaluator_.take_output(), outcome_);
    }
    if (outcome_of_walk_ && !evaluator_.finished()) {
      evaluator_.end_of_excitation(aborted);
      evaluator_.finish_now();
      collect(evaluator_.recipe(), evaluator_.take_output(), outcome_);
    }
    lateness_.refuse(outcome_);
    return outcome_of_walk_;
  }

private:
  struct Source {
    const RecordedSource& recorded;
    std::map<RecordedPosition, RecordedPlace>::const_iterator next{};
    bool answered = false;
    std::optional<std::uint64_t> described{}; // session
    drivers::SourceDescription first{};       // what the run began with
    std::deque<wire::SampleBlock> waiting{};
    std::uint64_t waiting_since = 0;
    bool is_unfit =
        false; // its session: the run cannot go by what it describes (source_streams.hpp)
  };

  void take_excitation(const recording::MessageInFile& message) {
    const auto excitation = recording::decode<wire::Excitation>(message.message.data);
    if (excitation && excitation->run() == run_) {
      const StepAnnouncement announcement = from_message(*excitation);
      lateness_.add(announcement, static_cast<std::int64_t>(now_));
      announcements_.add(here(), announcement);
    }
  }

  void take_state(const recording::MessageInFile& message) {
    const auto measurement = recording::decode<wire::Measurement>(message.message.data);
    if (measurement && measurement->run() == run_ &&
        (measurement->state() == wire::MEASUREMENT_DONE ||
         measurement->state() == wire::MEASUREMENT_ABORTED)) {
      announcements_.add(here(), measurement->state());
    }
  }

  void announce(bool at_once) {
    announcements_.hand_over(at_once, [this](const auto& announcement) {
      if (const auto* step = std::get_if<StepAnnouncement>(&announcement)) {
        evaluator_.announce(*step);
      } else {
        evaluator_.end_of_excitation(std::get<wire::MeasurementState>(announcement) ==
                                     wire::MEASUREMENT_ABORTED);
      }
    });
  }
  [[nodiscard]] WaitingAnnouncements::Instant here() const {
    return {walked_, static_cast<std::int64_t>(now_)};
  }

  // Everything of the source up to this message that has not been handed over yet.
  template <class T>
  void take_of_source(const recording::MessageInFile& message) {
    const auto decoded = recording::decode<T>(message.message.data);
    const auto found = decoded && decoded->bench() == bench_
                           ? sources_.find(decoded->source().to_string())
                           : sources_.end();
    const std::uint64_t number = decoded ? recording::number_in_source(*decoded) : 0;
    if (found == sources_.end() || (std::is_same_v<T, wire::TriggeredRecord> && number == 0)) {
      return;
    }
    Source& source = found->second;
    const RecordedPosition here = source.recorded.position(decoded->session(), number);
    while (source.next != source.recorded.messages.end() && source.next->first <= here) {
      const auto& [position, place] = *source.next++;
      if (position == here) {
        add(found->first, source, *decoded, place.sent_ns);
        continue;
      }
      const auto elsewhere = others_.at(place);
      const auto other = elsewhere ? recording::decode<T>(elsewhere->data) : std::nullopt;
      if (!elsewhere) {
        outcome_of_walk_ = fail(elsewhere.error());
        return;
      }
      if (other) {
        add(found->first, source, *other, place.sent_ns);
      }
    }
  }

  void describe(const std::string& name, Source& source, std::uint64_t session) {
    if (source.described == session) {
      return;
    }
    const auto of_session = source.recorded.descriptions.find(session);
    if (of_session == source.recorded.descriptions.end() && source.described) {
      return;
    }
    const bool is_first = !source.described;
    source.described = session;
    if (of_session == source.recorded.descriptions.end() && !source.recorded.newest) {
      outcome_of_walk_ =
          fail(ErrorCode::no_source,
               fmt::format("the recording holds no description of source '{}' of bench '{}'", name,
                           bench_));
      return;
    }
    const wire::SourceDescription& description = of_session == source.recorded.descriptions.end()
                                                     ? *source.recorded.newest
                                                     : of_session->second;
    const auto& settings = evaluator_.recipe().source_settings;
    if (is_first) {
      source.first = from_message(description);
    }
    source.is_unfit =
        !is_first && (settings_difference(description.settings(), settings, name).has_value() ||
                      !device_difference(name, source.first, from_message(description)).empty());
    if (source.is_unfit) {
      return;
    }
    if (auto described = evaluator_.describe(name, from_message(description)); !described) {
      source.is_unfit = !is_first;
      outcome_of_walk_ = is_first ? std::move(described) : Expected<void>{};
    }
  }

  void add(const std::string& name, Source& source, const wire::SampleBlock& block,
           std::int64_t sent_ns) {
    source.answered = source.answered || block.acknowledged_run() == run_;
    if (!source.answered) {
      return;
    }
    lateness_.add(name, view_block(block), sent_ns);
    source.waiting.push_back(block);
    hand_over_waiting(name, source, false);
    if (source.waiting.empty() && !source.is_unfit) {
      announcements_.reach(name, walked_, sent_ns, block.end_of_stream());
    }
  }
  void add(const std::string& name, Source& source, const wire::TriggeredRecord& record,
           std::int64_t /*sent_ns*/) {
    describe(name, source, record.session());
    if (outcome_of_walk_ && !source.is_unfit && record.run() == run_) {
      evaluator_.add(name, from_message(record));
    }
  }

  // A new session waits as long as steps of the one before may still be evaluated.
  void hand_over_waiting(const std::string& name, Source& source, bool at_once) {
    while (outcome_of_walk_ && !source.waiting.empty()) {
      const wire::SampleBlock& block = source.waiting.front();
      if (source.waiting_since == 0) {
        source.waiting_since = now_;
      }
      const bool overdue = at_once || now_ > source.waiting_since + session_limit_ns;
      if (!overdue && !evaluator_.is_ready_for(name, block.session())) {
        return;
      }
      describe(name, source, block.session());
      if (outcome_of_walk_ && !source.is_unfit) {
        evaluator_.add(name, view_block(block));
      }
      source.waiting.pop_front();
      source.waiting_since = 0;
    }
  }

  RunEvaluator& evaluator_;
  RunOutcome& outcome_;
  RecordedMessages others_;
  std::string bench_;
  std::string run_;
  std::map<std::string, Source> sources_;
  std::uint64_t now_ = 0; // log_time
  std::uint64_t walked_ = 0;
  WaitingAnnouncements announcements_;
  MeasuredLater lateness_;
  Expected<void> outcome_of_walk_;
};

// The recorder came later than the first step.
bool begins_behind(const RecordedRunIndex& index, const Recipe& recipe) {
  if (!index.first_announced || recipe.steps.empty()) {
    return false;
  }
  const StepAnnouncement first = from_message(*index.first_announced);
  return first.step != recipe.steps.front().step || first.attempt > 1 ||
         !first.repeated_steps.empty();
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

} // namespace

Expected<RecordedRunOutcome> evaluate_recording(recording::RecordingReader& reader,
                                                const RecordedRunWish& wish,
                                                const std::stop_token& stop) {
  const auto index = index_recording(reader, wish.run, wish.count, stop);
  if (!index) {
    return fail(index.error());
  }
  auto recipe = wish.recipe ? Expected<Recipe>(*wish.recipe) : parse_recipe(index->plan);
  if (!recipe) {
    return fail(recipe.error());
  }
  recipe->bench = index->plan.bench().to_string();
  recipe->run = index->plan.run().to_string();
  if (wish.recipe) {
    recipe->source_settings.clear(); // the sources had read the file of their run
  }
  RecordedRunOutcome result;
  result.live_results = index->live_results;
  for (const std::string& name : recipe->sources()) {
    const auto source = index->sources.find(name);
    result.source_restarted = result.source_restarted || (source != index->sources.end() &&
                                                          source->second.sessions.size() > 1);
  }
  result.outcome = outcome_of(*recipe);
  result.outcome.adc_file = wish.recipe ? std::nullopt : adc_file_of(index->plan);
  result.warnings = warnings_of(*index, *recipe, reader.path());
  add_setup(*index, result.outcome);
  const bool behind = begins_behind(*index, *recipe);
  RunEvaluator evaluator(std::move(*recipe),
                         {.evaluations_at_once = std::clamp<std::size_t>(
                              std::thread::hardware_concurrency(), 1, max_evaluations),
                          .clock_to_the_end = index->clock_end.has_value(),
                          .clock_end = index->clock_end,
                          .count = wish.count,
                          .behind = behind});
  const std::stop_callback end_checks(stop, [&evaluator] { evaluator.stop_checks(); });
  Evaluating evaluating(reader, *index, evaluator, result.outcome);
  const auto walked =
      reader.scan({.message =
                       [&](const recording::MessageInFile& message) {
                         if (!stop.stop_requested()) {
                           evaluating.take(message);
                         }
                       },
                   .attachment = {},
                   .metadata = {},
                   .walked = [&](std::uint64_t /*bytes*/) { return !stop.stop_requested(); }});
  if (!walked && walked.error().code != ErrorCode::interrupted) {
    return fail(walked.error());
  }
  if (wish.whole_or_none && stop.stop_requested()) {
    return fail(ErrorCode::interrupted, "interrupted");
  }
  const bool aborted = stop.stop_requested() || index->newest.state() != wire::MEASUREMENT_DONE;
  if (const auto finished = evaluating.finish(aborted); !finished) {
    return fail(finished.error());
  }
  result.outcome.interrupted = result.outcome.interrupted || stop.stop_requested();
  sort_outcome(result.outcome);
  return result;
}

} // namespace dyncal::services
