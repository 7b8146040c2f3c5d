#include "services/programs/analysis/run_session.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "services/contract/run_identity.hpp"
#include "services/evaluation/recipe/recipe_message.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;

constexpr auto command_interval = 100ms;
constexpr auto status_interval = 1s;
constexpr auto max_pause = 1s;              // between two calls of work() of a process that runs
constexpr std::size_t max_announced = 4096; // one implies that those before it are over
// A Monte Carlo check of more trials takes so long (milliseconds a channel) that it has a thread of
// its own: reception and other benches must not wait for it.
constexpr std::uint64_t quick_trials = 5000;

EvaluationLimits limits_of(const Recipe& recipe) {
  EvaluationLimits limits;
  if (recipe.monte_carlo_trials > quick_trials) {
    limits.evaluations_at_once = 1;
    limits.never_waits = true;
  } else {
    limits.ahead = true;
  }
  return limits;
}

} // namespace

Expected<std::unique_ptr<RunSession>> RunSession::create(const AnalysisContext& context,
                                                         const wire::Measurement& measurement,
                                                         std::shared_ptr<SourceRequests> requests,
                                                         SourceStreams::Begin begin) {
  auto publisher =
      RunPublisher::open(context.participant, context.clock, context.identity,
                         measurement.bench().to_string(), measurement.run().to_string());
  if (!publisher) {
    return fail(publisher.error());
  }
  std::unique_ptr<RunSession> session(
      new RunSession(context, measurement, std::move(requests), std::move(*publisher)));
  session->prepare(measurement, begin);
  return session;
}

RunSession::RunSession(const AnalysisContext& context, const wire::Measurement& measurement,
                       std::shared_ptr<SourceRequests> requests, RunPublisher publisher)
    : participant_(context.participant), clock_(context.clock), wake_up_(context.wake_up),
      bench_(measurement.bench().to_string()), run_(measurement.run().to_string()),
      conductor_(measurement.conductor()), requests_(std::move(requests)),
      publisher_(std::move(publisher)), measurement_(measurement), created_(clock_.now()),
      arms_since_(created_), last_heard_of_run_(created_), last_progress_(created_),
      worked_(created_), present_since_(created_), next_command_(created_),
      next_status_(created_ + status_interval) {}

void RunSession::prepare(const wire::Measurement& measurement, SourceStreams::Begin begin) {
  auto recipe = parse_recipe(measurement);
  if (!recipe) {
    refuse(recipe.error().message);
    return;
  }
  EvaluationLimits limits = limits_of(*recipe);
  limits.behind = begin == SourceStreams::Begin::behind;
  evaluator_ = std::make_unique<RunEvaluator>(std::move(*recipe), limits);
  streams_.emplace(participant_, wake_up_, bench_, run_, *evaluator_, begin);
  if (begin == SourceStreams::Begin::behind) {
    status_ = {wire::ARM_ARMED, wire::HEALTH_WAITING, taking_over_sentence()};
    taking_over_ = true;
    evaluator_->expect_announcements(); // what was announced before, it has not heard
    spdlog::info("bench {}, run {}: began before this service; asking its sources for what they "
                 "have sent",
                 bench_, run_);
    if (excitation_over()) {
      excitation_ended_ = measurement_.state() == wire::MEASUREMENT_ABORTED;
    }
  } else {
    spdlog::info("bench {}, run {}: {} steps planned, waiting for its sources", bench_, run_,
                 measurement.steps().size());
  }
  publisher_.publish(status_);
}

void RunSession::update(const wire::Measurement& measurement) {
  if (!is_of_this_run(measurement)) {
    return;
  }
  last_heard_of_run_ = clock_.now();
  is_resumed_ = is_resumed_ || measurement.conductor() != conductor_;
  conductor_ = measurement.conductor();
  if (measurement.state() == measurement_.state()) {
    return;
  }
  measurement_ = measurement;
  if (!evaluator_ || !excitation_over()) {
    return;
  }
  const bool aborted = measurement_.state() == wire::MEASUREMENT_ABORTED;
  spdlog::info("bench {}, run {}: {}", bench_, run_, aborted ? "aborted" : "excitation done");
  excitation_ended_ = aborted;
  if (status_.health == wire::HEALTH_FAILED || (aborted && waits_for_source())) {
    evaluator_->end_of_excitation(aborted);
    evaluator_->finish_now(); // a source is lost: nothing more will come, or nobody waits for it
  }
  last_progress_ = clock_.now();
}

// A name of an older program may come again. Who resumes a run begins with RUNNING, and has its
// recipe.
bool RunSession::is_of_this_run(const wire::Measurement& measurement) {
  const bool other_conductor =
      measurement.state() == wire::MEASUREMENT_PLANNED && measurement.conductor() != conductor_;
  const bool other_recipe = measurement.recipe_sha256() != measurement_.recipe_sha256();
  if (!other_conductor && !other_recipe) {
    return true;
  }
  if (!std::exchange(other_run_said_, true)) {
    spdlog::warn("bench {}, run {}: {} announces another run of this name{}; it is not taken for "
                 "the one of {}: give it another name",
                 bench_, run_, measurement.conductor(), other_recipe ? ", of another recipe" : "",
                 conductor_);
  }
  // Unless two have one name, of which one lives.
  const bool resumes = measurement.state() == wire::MEASUREMENT_RUNNING &&
                       measurement.conductor() != conductor_ &&
                       clock_.now() - last_heard_of_run_ > bench_limit;
  if (resumes && !finished()) {
    requests_->ask_conductor_to_end(run_);
  }
  return false;
}

void RunSession::announce(const wire::Excitation& excitation) {
  excited_by_steps_ = true;
  last_heard_of_run_ = clock_.now();
  if (evaluator_) {
    evaluator_->expect_announcements();
    announced_.emplace_back(from_message(excitation), last_heard_of_run_);
    if (announced_.size() > max_announced) {
      announced_.pop_front();
    }
  }
}

// The time of a process that was stopped is not the silence of others.
void RunSession::discount_own_stall(Instant now) {
  if (now - worked_ > max_pause) {
    spdlog::warn("bench {}, run {}: this service did not work for {:.1f} s", bench_, run_,
                 std::chrono::duration<double>(now - worked_).count());
    present_since_ = now;
    arms_since_ = now;
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
    report(wire::HEALTH_FAILED, due.error().message);
    return;
  }
  for (const SourceStreams::Request& request : *due) {
    requests_->ask_to_catch_up(run_, request.source, streams_->asker(), request.what);
  }
  if (lacks_samples(now)) {
    return;
  }
  for (; !announced_.empty(); announced_.pop_front()) {
    const auto& [announcement, heard] = announced_.front();
    evaluator_->announce(announcement, heard.time_since_epoch().count());
  }
  if (const auto aborted = std::exchange(excitation_ended_, std::nullopt)) {
    evaluator_->end_of_excitation(*aborted);
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
  if (status_.arm == wire::ARM_WAITING && before == nullptr) {
    arm(sources, now);
  }
  if (status_.arm == wire::ARM_ARMED) {
    catch_up(now);
    watch_sources(now);
    watch_measurement();
    evaluate(now);
    end_takeover(now);
  }
  if (now >= next_status_) {
    report_work(now);
    publisher_.publish(status_);
    next_status_ = now + status_interval;
  }
}

std::string RunSession::taking_over_sentence() const {
  return fmt::format("taking the run over; its sources have repeated {} messages so far",
                     streams_->recovered());
}

// With the results of all that was measured before: anyone who goes on with the run knows by them
// what is left.
void RunSession::end_takeover(Instant now) {
  if (!taking_over_ || lacks_samples(now) || evaluator_->is_evaluating()) {
    return;
  }
  taking_over_ = false;
  if (status_.health == wire::HEALTH_WAITING) {
    report(wire::HEALTH_OK, "");
  }
}

// What takes longer than a result should: anyone who waits for results goes on waiting.
void RunSession::report_work(Instant now) {
  if (status_.arm != wire::ARM_ARMED || status_.health != wire::HEALTH_OK) {
    return;
  }
  status_.message.clear();
  const auto waited = std::chrono::duration_cast<std::chrono::seconds>(now - last_progress_);
  if (evaluator_->is_evaluating() && waited > status_interval) {
    status_.message = fmt::format("evaluating a step, for {} s so far", waited.count());
  } else if (streams_->is_catching_up() && (streams_->recovered() > 0 || waited > 0s)) {
    status_.message = fmt::format("catching up with what the sources have sent: {} messages so "
                                  "far, none for {} s",
                                  streams_->recovered(), waited.count());
  }
}

// Nothing is taken meanwhile: the samples are those of the run before.
void RunSession::wait_for_bench(RunSession& before, Instant now) {
  arms_since_ = now;
  if (status_.message.empty()) {
    status_.message = fmt::format("waiting for run '{}' of this bench to end",
                                  RunIdentity::parse(before.run_).name);
    publisher_.publish(status_);
  }
  if (!before.excitation_over() && before.last_heard_of_run_ > created_) {
    refuse(fmt::format("bench '{}' is in use by {}; wait for its end, or end it there", bench_,
                       called_of(before.run_, before.conductor_)));
  } else if (now - created_ > listening_time &&
             now - (before.excitation_over() ? created_ : before.last_heard_of_run_) >
                 bench_limit) {
    before.give_way_to(run_);
  }
}

void RunSession::give_way_to(const std::string& next) {
  const bool died = !excitation_over();
  if (died && status_.health == wire::HEALTH_OK) {
    report(wire::HEALTH_FAILED,
           fmt::format("nothing was heard of this run for {} s; its bench was given to run '{}'",
                       bench_limit.count(), RunIdentity::parse(next).name));
  }
  if (died) {
    evaluator_->stop_checks(); // nobody waits for them, and the bench is wanted
  }
  evaluator_->end_of_excitation(died);
  evaluator_->finish_now();
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
  if (now >= next_command_) {
    next_command_ = now + command_interval;
    for (const std::string& source : streams_->unanswered()) {
      requests_->ask_for_answer(run_, source);
    }
  }
  const auto missing = streams_->what_is_missing(sources);
  const std::string other_file = streams_->settings_mismatch(evaluator_->recipe().source_settings);
  if (!missing && !other_file.empty()) {
    refuse(other_file);
  } else if (!missing) {
    status_.arm = wire::ARM_ARMED;
    status_.message.clear();
    last_progress_ = now;
    spdlog::info("bench {}, run {}: armed", bench_, run_);
    publisher_.publish(status_);
  } else if (missing->is_there && now - arms_since_ <= present_limit) {
    starting_ = missing->is_starting ? now : starting_;
    report_missing_source(missing->sentence, now);
  } else if (now - std::max(arms_since_, starting_) > arm_limit || missing->is_starting) {
    refuse(missing->sentence);
  } else {
    report_missing_source(missing->sentence, now);
  }
}

// Before the run is refused for it: anyone who waits may be able to mend it.
void RunSession::report_missing_source(const std::string& sentence, Instant now) {
  if (now - arms_since_ > notice_after && status_.message != sentence) {
    status_.message = sentence;
    publisher_.publish(status_);
  }
}

void RunSession::watch_sources(Instant now) {
  const bool goes_on = measurement_.state() == wire::MEASUREMENT_RUNNING ||
                       (measurement_.state() == wire::MEASUREMENT_DONE && excited_by_steps_);
  if (!goes_on || status_.health == wire::HEALTH_FAILED ||
      now - last_heard_of_run_ > runner_limit) {
    return;
  }
  if (const auto recovered = streams_->recovered(); recovered != recovered_) {
    recovered_ = recovered;
    last_progress_ = now;
  }
  auto lost =
      streams_->lost_source(now, std::max(last_progress_, present_since_), silence_limit,
                            excited_by_steps_ && measurement_.state() == wire::MEASUREMENT_RUNNING);
  if (!lost) {
    is_resumed_ = false;
    if (taking_over_) {
      waiting_since_ = now;
      status_.message = taking_over_sentence();
    } else if (status_.health == wire::HEALTH_WAITING) {
      spdlog::info("bench {}, run {}: all sources are back", bench_, run_);
      last_progress_ = now;
      report(wire::HEALTH_OK, "");
    }
  } else if (lost->may_come_back) {
    wait_for_source(std::move(*lost), now);
  } else {
    report(wire::HEALTH_FAILED, std::move(lost->message));
  }
}

void RunSession::wait_for_source(LostSource lost, Instant now) {
  if (status_.health == wire::HEALTH_OK) {
    waiting_since_ = now;
  }
  if (is_resumed_ && lost.is_other_device && now >= next_command_) {
    next_command_ = now + command_interval;
    requests_->ask_conductor_to_end(run_);
  }
  if (now - std::max(waiting_since_, present_since_) > patience) {
    report(wire::HEALTH_FAILED,
           fmt::format("{}, and nothing more for {} s", lost.message, patience.count()));
  } else if (status_.message != lost.message) {
    report(wire::HEALTH_WAITING, std::move(lost.message));
  }
}

// The conductor switches the output off as soon as it hears of it.
void RunSession::watch_measurement() {
  if (measurement_.state() != wire::MEASUREMENT_RUNNING || status_.health == wire::HEALTH_FAILED) {
    return;
  }
  if (auto excess = evaluator_->excess_of_level()) {
    report(wire::HEALTH_FAILED, std::move(*excess));
  } else if (const auto& slow = evaluator_->too_slow_source(); slow && excited_by_steps_) {
    report(wire::HEALTH_FAILED, *slow);
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
  if (evaluator_->finished()) {
    finish();
  } else {
    end_overdue(now);
  }
}

void RunSession::finish() {
  if (std::exchange(taking_over_, false) && status_.health == wire::HEALTH_WAITING) {
    status_ = {};
  }
  status_.arm = wire::ARM_FINISHED;
  streams_.reset();
  evaluator_.reset();
  spdlog::info("bench {}, run {}: finished, {} results", bench_, run_, publisher_.results());
  publisher_.publish(status_);
}

// Anyone who excites by steps goes on, or ends the run, as soon as it knows what was measured
// before. Files, and excitation by hand, announce nothing.
bool RunSession::is_played_to_its_end(Instant now) const {
  return !excited_by_steps_ && !excitation_over() && !taking_over_ &&
         evaluator_->has_planned_steps() && now - last_progress_ > announcement_limit;
}

void RunSession::end_overdue(Instant now) {
  const bool runner_lost = now - last_heard_of_run_ > runner_limit;
  const bool quiet = excitation_over() && !waits_for_source() && now - last_progress_ > quiet_limit;
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
  evaluator_->end_of_excitation(runner_lost);
  evaluator_->finish_now();
  wake_up_->ring();
}

void RunSession::report(wire::HealthState health, std::string message) {
  status_.health = health;
  status_.message = std::move(message);
  if (!status_.message.empty()) {
    spdlog::warn("bench {}, run {}: {}", bench_, run_, status_.message);
  }
  publisher_.publish(status_);
}

void RunSession::refuse(std::string message) {
  status_ = {wire::ARM_REFUSED, wire::HEALTH_FAILED, std::move(message)};
  spdlog::warn("bench {}, run {}: refused: {}", bench_, run_, status_.message);
  streams_.reset();
  evaluator_.reset();
  publisher_.publish(status_);
}

} // namespace dyncal::services
