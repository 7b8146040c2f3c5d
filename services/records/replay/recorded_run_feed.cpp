#include "services/records/replay/recorded_run_feed.hpp"

#include <algorithm>
#include <type_traits>
#include <variant>

#include <fmt/core.h>

#include "services/contract/bench_file_origin.hpp"
#include "services/contract/number_in_source.hpp"
#include "services/contract/source_block.hpp"
#include "services/contract/source_description.hpp"
#include "services/contract/topics.hpp"
#include "services/contract/triggered_record.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "services/records/capture/recorded_topics.hpp"

namespace dyncal::inline records {
namespace {

namespace topics = bus::topics;

// A source that has restarted is waited with for so long
// (services/programs/analysis/source_streams.hpp).
constexpr std::uint64_t session_limit_ns = 5'000'000'000;

void collect(const Recipe& recipe, EvaluationOutput output, RunOutcome& outcome) {
  for (auto* results : {&output.results, &output.settled}) {
    for (const StepResult& evaluated : *results) {
      StepResult result = from_message(to_message(recipe, evaluated));
      const auto known = std::ranges::find_if(outcome.results, [&](const StepResult& one) {
        return one.step == result.step && one.repetition == result.repetition &&
               one.channel == result.channel;
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

} // namespace

RecordedRunFeed::RecordedRunFeed(const recording::RecordingReader& reader,
                                 const RecordedRunIndex& index, RunEvaluator& evaluator,
                                 RunOutcome& outcome)
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

void RecordedRunFeed::take(const recording::MessageInFile& message) {
  if (!outcome_of_walk_ || evaluator_.finished() || evaluator_.is_given_up()) {
    return;
  }
  now_ = message.message.log_time;
  ++walked_;
  const std::string& topic = message.channel.topic;
  if (topic == topics::excitation) {
    take_excitation(message);
  } else if (topic == topics::measurement) {
    take_state(message);
  } else if (topic == topics::source_description) {
    take_description(message);
  } else if (topic == topics::dau_samples || topic == topics::acs_samples ||
             topic == topics::can_samples) {
    take_of_source<wire::SampleBlock>(message);
  } else if (topic == topics::dso_record || topic == topics::tss_record) {
    take_of_source<wire::TriggeredRecord>(message);
  } else if (topic == topics::acs_step) {
    take_reference_step(message);
  } else {
    return;
  }
  announce(false);
  collect_output();
}

Expected<void> RecordedRunFeed::finish(bool aborted) {
  if (outcome_of_walk_ && !evaluator_.finished()) {
    for (auto& [name, source] : sources_) {
      hand_over_waiting(name, source, true);
    }
    announce(true);
    collect_output();
  }
  if (outcome_of_walk_ && !evaluator_.finished()) {
    evaluator_.end_of_excitation(aborted);
    evaluator_.finish_now();
    collect_output();
  }
  return outcome_of_walk_;
}

void RecordedRunFeed::collect_output() {
  collect(evaluator_.recipe(), evaluator_.take_output(), outcome_);
}

void RecordedRunFeed::take_excitation(const recording::MessageInFile& message) {
  const auto excitation = recording::decode<wire::Excitation>(message.message.data);
  if (excitation && excitation->run() == run_) {
    announcements_.add(here(), from_message(*excitation));
  }
}

void RecordedRunFeed::take_state(const recording::MessageInFile& message) {
  const auto measurement = recording::decode<wire::Measurement>(message.message.data);
  if (measurement && measurement->run() == run_ &&
      (measurement->state() == wire::MEASUREMENT_DONE ||
       measurement->state() == wire::MEASUREMENT_ABORTED)) {
    announcements_.add(here(), measurement->state());
  }
}

// A source describes its quadrature signals anew when it has found a better ellipse.
void RecordedRunFeed::take_description(const recording::MessageInFile& message) {
  const auto description = recording::decode<wire::SourceDescription>(message.message.data);
  const auto found = description && description->bench() == bench_
                         ? sources_.find(description->source().to_string())
                         : sources_.end();
  if (found == sources_.end()) {
    return;
  }
  Source& source = found->second;
  auto& signals = source.signals[description->session()];
  signals = from_message(*description).quadrature_signals;
  if (source.described == description->session() && !source.is_unfit) {
    evaluator_.describe_signals(found->first, signals);
  }
}

void RecordedRunFeed::take_reference_step(const recording::MessageInFile& message) {
  const auto step = recording::decode<wire::AcsStep>(message.message.data);
  if (step && step->bench() == bench_ && step->run() == run_) {
    evaluator_.add(step->source().to_string(), from_message(*step));
  }
}

void RecordedRunFeed::announce(bool at_once) {
  announcements_.hand_over(
      at_once, [this](const WaitingAnnouncements::Announcement& one, std::int64_t recorded_ns) {
        if (const auto* step = std::get_if<StepAnnouncement>(&one)) {
          evaluator_.announce(*step, recorded_ns);
        } else {
          evaluator_.end_of_excitation(std::get<wire::MeasurementState>(one) ==
                                       wire::MEASUREMENT_ABORTED);
        }
      });
}

// Everything of the source up to this message that has not been handed over yet.
template <class T>
void RecordedRunFeed::take_of_source(const recording::MessageInFile& message) {
  const auto decoded = recording::decode<T>(message.message.data);
  const auto found = decoded && decoded->bench() == bench_
                         ? sources_.find(decoded->source().to_string())
                         : sources_.end();
  const std::uint64_t number = decoded ? contract::number_in_source(*decoded) : 0;
  if (found == sources_.end() || (std::is_same_v<T, wire::TriggeredRecord> && number == 0)) {
    return;
  }
  Source& source = found->second;
  const RecordedPosition here = source.recorded.position(decoded->session(), number);
  while (source.next != source.recorded.messages.end() && source.next->first <= here &&
         !evaluator_.is_given_up()) {
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

void RecordedRunFeed::describe(const std::string& name, Source& source, std::uint64_t session) {
  if (source.described == session) {
    return;
  }
  const auto of_session = source.recorded.descriptions.find(session);
  if (of_session == source.recorded.descriptions.end() && source.described) {
    source.described = session;
    source.is_unfit = true; // another session's description says nothing of its samples
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
  drivers::SourceDescription stated = from_message(description);
  if (const auto walked = source.signals.find(session); walked != source.signals.end()) {
    stated.quadrature_signals = walked->second;
  }
  if (auto described = evaluator_.describe(name, std::move(stated)); !described) {
    source.is_unfit = !is_first;
    outcome_of_walk_ = is_first ? std::move(described) : Expected<void>{};
  }
}

void RecordedRunFeed::add(const std::string& name, Source& source, const wire::SampleBlock& block,
                          std::int64_t sent_ns) {
  source.answered = source.answered || block.acknowledged_run() == run_;
  if (!source.answered) {
    return;
  }
  source.waiting.push_back({block, sent_ns});
  hand_over_waiting(name, source, false);
  if (source.waiting.empty() && !source.is_unfit) {
    announcements_.reach(name, walked_, sent_ns, block.end_of_stream());
  }
}

void RecordedRunFeed::add(const std::string& name, Source& source,
                          const wire::TriggeredRecord& record, std::int64_t /*sent_ns*/) {
  describe(name, source, record.session());
  if (outcome_of_walk_ && !source.is_unfit && record.run() == run_) {
    evaluator_.add(name, from_message(record));
  }
}

void RecordedRunFeed::hand_over_waiting(const std::string& name, Source& source, bool at_once) {
  while (outcome_of_walk_ && !source.waiting.empty() && !evaluator_.is_given_up()) {
    const auto& [block, sent_ns] = source.waiting.front();
    if (source.waiting_since == 0) {
      source.waiting_since = now_;
    }
    const bool overdue = at_once || now_ > source.waiting_since + session_limit_ns;
    if (!overdue && !evaluator_.is_ready_for(name, block.session())) {
      return;
    }
    describe(name, source, block.session());
    if (outcome_of_walk_ && !source.is_unfit) {
      evaluator_.add(name, view_block(block), BlockTimes{sent_ns, sent_ns});
    }
    source.waiting.pop_front();
    source.waiting_since = 0;
  }
}

} // namespace dyncal::inline records
