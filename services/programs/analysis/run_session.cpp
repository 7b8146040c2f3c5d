#include "services/programs/analysis/run_session.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "services/programs/analysis/live_limits.hpp"
#include "services/programs/analysis/session_sentences.hpp"

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;

constexpr auto command_interval = 100ms;
constexpr auto status_interval = 1s;
constexpr auto max_pause = 1s; // between two calls of work() of a process that runs

} // namespace

Expected<std::unique_ptr<RunSession>> RunSession::create(const AnalysisContext& context,
                                                         const wire::Measurement& measurement,
                                                         std::shared_ptr<SourceRequests> requests,
                                                         SourceStreams::Begin begin) {
  DYNCAL_TRY(auto publisher,
             RunPublisher::open(context.participant, context.clock, context.identity,
                                measurement.bench().to_string(), measurement.run().to_string()));
  std::unique_ptr<RunSession> session(
      new RunSession(context, measurement, std::move(requests), std::move(publisher)));
  session->prepare(measurement, begin);
  return session;
}

RunSession::RunSession(const AnalysisContext& context, const wire::Measurement& measurement,
                       std::shared_ptr<SourceRequests> requests, RunPublisher publisher)
    : participant_(context.participant), clock_(context.clock), wake_up_(context.wake_up),
      left_out_(context.left_out), bench_(measurement.bench().to_string()),
      run_(measurement.run().to_string()), conductor_(measurement), requests_(std::move(requests)),
      publisher_(std::move(publisher)), measurement_(measurement), created_(clock_.now()),
      state_(Arming{created_}), last_heard_of_run_(created_), last_progress_(created_),
      worked_(created_), present_since_(created_), next_command_(created_),
      next_status_(created_ + status_interval) {}

void RunSession::prepare(const wire::Measurement& measurement, SourceStreams::Begin begin) {
  auto recipe = parse_recipe(measurement);
  if (!recipe) {
    refuse(recipe.error().message);
    return;
  }
  EvaluationLimits limits = live_limits(*recipe);
  limits.behind = begin == SourceStreams::Begin::behind;
  evaluator_ = std::make_unique<RunEvaluator>(std::move(*recipe), limits);
  streams_.emplace(participant_, wake_up_, left_out_, bench_, run_, *evaluator_, begin);
  if (begin == SourceStreams::Begin::behind) {
    state_ = TakingOver{created_};
    message_ = taking_over_sentence(*streams_);
    evaluator_->expect_announcements(); // what was announced before, it has not heard
    spdlog::info("bench {}, run {}: began before this service; asking its sources for what they "
                 "have sent",
                 bench_, run_);
    if (excitation_over()) {
      announced_.end_excitation(measurement_.state() == wire::MEASUREMENT_ABORTED);
    }
  } else {
    spdlog::info("bench {}, run {}: {} steps planned, waiting for its sources", bench_, run_,
                 measurement.steps().size());
  }
  publish();
}

void RunSession::update(const wire::Measurement& measurement) {
  const auto claim = conductor_.judge(measurement, clock_.now() - last_heard_of_run_, bench_limit);
  if (claim == RunConductor::Claim::resumes_wrongly && !finished()) {
    requests_->ask_conductor_to_end(run_);
  }
  if (claim != RunConductor::Claim::this_run) {
    return;
  }
  last_heard_of_run_ = clock_.now();
  if (measurement.state() == measurement_.state()) {
    return;
  }
  measurement_ = measurement;
  if (!evaluator_ || !excitation_over()) {
    return;
  }
  const bool aborted = measurement_.state() == wire::MEASUREMENT_ABORTED;
  spdlog::info("bench {}, run {}: {}", bench_, run_, aborted ? "aborted" : "excitation done");
  announced_.end_excitation(aborted);
  if (is<Failed>() || (aborted && is<Held>())) {
    end_with_what_came(aborted); // a source is lost: nothing more will come, or nobody waits for it
  }
  last_progress_ = clock_.now();
}

void RunSession::announce(const wire::Excitation& excitation) {
  excited_by_steps_ = true;
  last_heard_of_run_ = clock_.now();
  if (evaluator_) {
    evaluator_->expect_announcements();
    announced_.add(from_message(excitation), last_heard_of_run_);
  }
}

// The time of a process that was stopped is not the silence of others.
void RunSession::discount_own_stall(Instant now) {
  if (now - worked_ > max_pause) {
    spdlog::warn("bench {}, run {}: this service did not work for {:.1f} s", bench_, run_,
                 std::chrono::duration<double>(now - worked_).count());
    present_since_ = now;
    begin_arming_again(now);
    last_heard_of_run_ = std::max(last_heard_of_run_, now - (runner_limit - patience));
    last_progress_ = now;
  }
  worked_ = now;
}

// What its sources have sent so far. The position of a silent one is unknown: one that has started
// again answers before it has sent anything.
bool RunSession::lacks_samples(Instant now) const {
  return streams_->is_catching_up() || (!excitation_over() && streams_->is_held_up(now));
}

// What was announced is of the samples that have come: a step that is over shows in a source within
// some seconds of its own time (run_records.hpp).
void RunSession::catch_up(Instant now) {
  auto due = streams_->requests_due(now);
  if (!due) {
    enter(Failed{}, due.error().message);
    return;
  }
  for (const SourceStreams::Request& request : *due) {
    requests_->ask_to_catch_up(run_, request.source, streams_->asker(), request.what);
  }
  if (lacks_samples(now)) {
    return;
  }
  if (announced_.hand_over(*evaluator_)) {
    last_progress_ = now;
  }
}

void RunSession::work(const KnownSources& sources, RunSession* before) {
  if (finished()) {
    return;
  }
  const Instant now = clock_.now();
  discount_own_stall(now);
  if (before != nullptr) {
    wait_for_bench(*before, now);
  } else {
    take_samples(sources, now);
  }
  if (is<Arming>() && before == nullptr) {
    arm(sources, now);
  }
  if (armed()) {
    if (!evaluator_->is_ending()) { // else its last results are made, or on their way
      catch_up(now);
      watch_sources(now);
      watch_measurement();
    }
    evaluate(now);
    end_takeover(now);
  }
  if (now >= next_status_) {
    if (is<Attending>()) {
      message_ = attending_sentence(*evaluator_, *streams_, now - last_progress_);
    }
    publish();
    next_status_ = now + status_interval;
  }
}

// With the results of all that was measured before: anyone who goes on with the run knows by them
// what is left.
void RunSession::end_takeover(Instant now) {
  if (is<TakingOver>() && !lacks_samples(now) && !evaluator_->is_evaluating() &&
      publisher_.has_published_all()) {
    enter(Attending{}, "");
  }
}

// Nothing is taken meanwhile: the samples are those of the run before.
void RunSession::wait_for_bench(RunSession& before, Instant now) {
  begin_arming_again(now);
  if (message_.empty()) {
    message_ = waiting_for_bench_sentence(before.run_);
    publish();
  }
  if (!before.excitation_over() && before.last_heard_of_run_ > created_) {
    refuse(bench_in_use_sentence(bench_, before.run_, before.conductor_.name()));
  } else if (now - created_ > listening_time &&
             now - (before.excitation_over() ? created_ : before.last_heard_of_run_) >
                 bench_limit) {
    before.give_way_to(run_);
  }
}

void RunSession::give_way_to(const std::string& next) {
  const bool died = !excitation_over();
  if (died && health_of(state_) == wire::HEALTH_OK) {
    enter(Failed{armed()}, bench_given_sentence(bench_limit, next));
  }
  if (died) {
    evaluator_->stop_checks(); // nobody waits for them, and the bench is wanted
  }
  end_with_what_came(died);
  evaluate(clock_.now());
}

void RunSession::take_samples(const KnownSources& sources, Instant now) {
  if (const auto described = streams_->take_descriptions(sources, now); !described) {
    refuse(described.error().message);
    return;
  }
  streams_->take_samples(now);
  if (std::string gone = streams_->lost_beginning(); !gone.empty()) {
    refuse(std::move(gone));
  }
}

void RunSession::arm(const KnownSources& sources, Instant now) {
  auto& arming = std::get<Arming>(state_);
  if (now >= next_command_) {
    next_command_ = now + command_interval;
    for (const std::string& source : streams_->unanswered()) {
      requests_->ask_for_answer(run_, source);
    }
  }
  const auto missing = streams_->what_is_missing(sources);
  const std::string problem =
      missing ? missing->sentence
              : streams_->settings_mismatch(evaluator_->recipe().source_settings);
  if (problem.empty()) {
    last_progress_ = now;
    spdlog::info("bench {}, run {}: armed", bench_, run_);
    enter(Attending{}, "");
  } else if (!missing || arming.is_over(*missing, now)) {
    refuse(problem);
  } else if (now - arming.since > notice_after && message_ != problem) {
    message_ = problem; // before the run is refused: anyone who waits may be able to mend it
    publish();
  }
}

void RunSession::watch_sources(Instant now) {
  const bool goes_on = measurement_.state() == wire::MEASUREMENT_RUNNING ||
                       (measurement_.state() == wire::MEASUREMENT_DONE && excited_by_steps_);
  if (!goes_on || is<Failed>() || now - last_heard_of_run_ > runner_limit) {
    return;
  }
  if (const auto come = streams_->recovered() + streams_->steps_handed_out(); come != come_) {
    come_ = come;
    last_progress_ = now;
  }
  auto lost =
      streams_->lost_source(now, std::max(last_progress_, present_since_), silence_limit,
                            excited_by_steps_ && measurement_.state() == wire::MEASUREMENT_RUNNING);
  const bool is_here = !lost;
  if (is_here) {
    lost = late_steps(now);
  }
  if (!lost) {
    conductor_.note_sources_seen();
    if (auto* const takeover = std::get_if<TakingOver>(&state_)) {
      takeover->all_there = now;
      message_ = taking_over_sentence(*streams_);
    } else if (is<Held>()) {
      spdlog::info("bench {}, run {}: all sources are back", bench_, run_);
      last_progress_ = now;
      enter(Attending{}, "");
    }
  } else if (lost->may_come_back) {
    wait_for_source(std::move(*lost), now);
  } else {
    enter(Failed{}, std::move(lost->message));
  }
  if (is_here && is<Failed>()) { // the steps that have come are evaluated
    end_with_what_came(false);
  }
}

// All has been excited, and a system that evaluates itself is behind.
std::optional<LostSource> RunSession::late_steps(Instant now) const {
  const bool is_all_excited =
      excitation_over() || (!excited_by_steps_ && evaluator_->has_found_planned_steps());
  std::string late = is_all_excited && now - last_progress_ > silence_limit
                         ? streams_->steps_not_handed_out()
                         : std::string();
  return late.empty() ? std::nullopt : std::optional(LostSource{.message = std::move(late)});
}

void RunSession::wait_for_source(LostSource lost, Instant now) {
  if (conductor_.is_resumed() && lost.is_other_device && now >= next_command_) {
    next_command_ = now + command_interval;
    requests_->ask_conductor_to_end(run_);
  }
  const Instant since = waits_since(state_, now);
  if (now - std::max(since, present_since_) > patience) {
    enter(Failed{}, fmt::format("{}, and nothing more for {} s", lost.message, patience.count()));
  } else if (message_ != lost.message) {
    enter(is<TakingOver>() ? state_ : SessionState(Held{since}), std::move(lost.message));
  }
}

// The conductor switches the output off as soon as it hears of it.
void RunSession::watch_measurement() {
  if (measurement_.state() != wire::MEASUREMENT_RUNNING || is<Failed>()) {
    return;
  }
  if (auto excess = evaluator_->excess_of_level()) {
    enter(Failed{}, std::move(*excess));
  } else if (const auto& slow = evaluator_->too_slow_source(); slow && excited_by_steps_) {
    enter(Failed{}, *slow);
  }
}

void RunSession::evaluate(Instant now) {
  bool any = true;
  while (any) { // results first, then what can wait
    const EvaluationOutput output = evaluator_->take_output();
    any = !output.results.empty();
    if (any) {
      last_progress_ = now;
    }
    publisher_.publish(evaluator_->recipe(), output);
  }
  if (!publisher_.has_published_all()) {
    last_progress_ = now;
    wake_up_->ring();
  } else if (evaluator_->finished()) {
    finish();
  } else {
    end_overdue(now);
  }
}

void RunSession::finish() {
  const bool took_over = is<TakingOver>();
  state_ = Ended{wire::ARM_FINISHED, took_over ? wire::HEALTH_OK : health_of(state_)};
  if (took_over) {
    message_.clear();
  }
  streams_.reset();
  evaluator_.reset();
  spdlog::info("bench {}, run {}: finished, {} results", bench_, run_, publisher_.results());
  publish();
}

// Anyone who excites by steps goes on, or ends the run, as soon as it knows what was measured
// before. Files, and excitation by hand, announce nothing.
bool RunSession::is_played_to_its_end(Instant now) const {
  return !excited_by_steps_ && !excitation_over() && !is<TakingOver>() &&
         evaluator_->has_planned_steps() && now - last_progress_ > announcement_limit;
}

void RunSession::end_overdue(Instant now) {
  const bool runner_lost = now - last_heard_of_run_ > runner_limit;
  const bool quiet = excitation_over() && !is<Held>() && now - last_progress_ > quiet_limit;
  if (is_played_to_its_end(now)) {
    evaluator_->end_of_excitation(false);
    wake_up_->ring();
  }
  if ((!runner_lost && !quiet) || evaluator_->is_evaluating()) {
    return;
  }
  if (runner_lost) {
    spdlog::warn("bench {}, run {}: no message from the conductor for {} s; finishing with the "
                 "results so far",
                 bench_, run_, runner_limit.count());
  }
  end_with_what_came(runner_lost);
}

void RunSession::end_with_what_came(bool aborted) {
  evaluator_->end_of_excitation(aborted);
  evaluator_->finish_now();
  wake_up_->ring();
}

void RunSession::enter(SessionState state, std::string message) {
  state_ = state;
  message_ = std::move(message);
  if (!message_.empty()) {
    spdlog::warn("bench {}, run {}: {}", bench_, run_, message_);
  }
  publish();
}

void RunSession::publish() {
  publisher_.publish({arm_of(state_), health_of(state_), message_, conductor_.name(),
                      measurement_.recipe_sha256()});
}

void RunSession::begin_arming_again(Instant now) {
  if (auto* const arming = std::get_if<Arming>(&state_)) {
    arming->since = now;
  }
}

void RunSession::refuse(std::string message) {
  state_ = Ended{wire::ARM_REFUSED, wire::HEALTH_FAILED};
  message_ = std::move(message);
  spdlog::warn("bench {}, run {}: refused: {}", bench_, run_, message_);
  streams_.reset();
  evaluator_.reset();
  publish();
}

} // namespace dyncal::inline programs
