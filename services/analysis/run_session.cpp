#include "services/analysis/run_session.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "services/evaluation/recipe/recipe_message.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;

constexpr auto command_interval = 250ms;
constexpr auto status_interval = 1s;

} // namespace

Expected<std::unique_ptr<RunSession>> RunSession::create(const AnalysisContext& context,
                                                         const wire::Measurement& measurement) {
  auto publisher =
      RunPublisher::open(context.participant, context.clock, context.identity,
                         measurement.bench().to_string(), measurement.run().to_string());
  if (!publisher) {
    return fail(publisher.error());
  }
  std::unique_ptr<RunSession> session(new RunSession(context, measurement, std::move(*publisher)));
  session->prepare(measurement);
  return session;
}

RunSession::RunSession(const AnalysisContext& context, const wire::Measurement& measurement,
                       RunPublisher publisher)
    : participant_(context.participant), clock_(context.clock), wake_up_(context.wake_up),
      bench_(measurement.bench().to_string()), run_(measurement.run().to_string()),
      conductor_(measurement.conductor()), publisher_(std::move(publisher)),
      measurement_(measurement.state()), created_(clock_.now()), arms_since_(created_),
      last_heard_of_run_(created_), last_progress_(created_), next_command_(created_),
      next_status_(created_ + status_interval) {}

void RunSession::prepare(const wire::Measurement& measurement) {
  auto recipe = parse_recipe(measurement);
  if (!recipe) {
    refuse(recipe.error().message);
    return;
  }
  streams_.emplace(participant_, wake_up_, bench_, run_, recipe->sources());
  evaluator_ = std::make_unique<RunEvaluator>(std::move(*recipe), EvaluationLimits{.ahead = true});
  spdlog::info("bench {}, run {}: {} steps planned, waiting for its sources", bench_, run_,
               measurement.steps().size());
  publisher_.publish(status_);
}

void RunSession::update(const wire::Measurement& measurement) {
  last_heard_of_run_ = clock_.now();
  if (measurement.state() == measurement_) {
    return;
  }
  measurement_ = measurement.state();
  if (!evaluator_ || !excitation_over()) {
    return;
  }
  const bool aborted = measurement_ == wire::MEASUREMENT_ABORTED;
  spdlog::info("bench {}, run {}: {}", bench_, run_, aborted ? "aborted" : "excitation done");
  evaluator_->end_of_excitation(aborted);
  if (status_.health == wire::HEALTH_FAILED) {
    evaluator_->finish_now(); // a source is lost: nothing more will come
  }
  last_progress_ = clock_.now();
}

void RunSession::announce(const wire::Excitation& excitation) {
  excited_by_steps_ = true;
  if (evaluator_) {
    evaluator_->announce(from_message(excitation));
  }
}

void RunSession::work(const KnownSources& sources, RunSession* before) {
  if (finished()) {
    return;
  }
  const Instant now = clock_.now();
  if (before != nullptr) {
    wait_for_bench(*before, now);
  } else {
    take_samples(sources, now);
  }
  if (status_.arm == wire::ARM_WAITING && before == nullptr) {
    arm(sources, now);
  }
  if (status_.arm == wire::ARM_ARMED) {
    watch_sources(now);
    watch_level();
    evaluate(now);
  }
  if (now >= next_status_) {
    publisher_.publish(status_);
    next_status_ = now + status_interval;
  }
}

// Nothing is taken meanwhile: the samples are those of the run before.
void RunSession::wait_for_bench(RunSession& before, Instant now) {
  arms_since_ = now;
  if (status_.message.empty()) {
    status_.message = fmt::format("waiting for run '{}' of this bench to end", before.run_);
    publisher_.publish(status_);
  }
  if (!before.excitation_over() && before.last_heard_of_run_ > created_) {
    refuse(fmt::format("bench '{}' is in use by run '{}'{}; wait for its end, or end it there",
                       bench_, before.run_,
                       before.conductor_.empty() ? "" : " of " + before.conductor_));
  } else if (now - created_ > bench_limit) {
    before.give_way_to(run_);
  }
}

void RunSession::give_way_to(const std::string& next) {
  const bool died = !excitation_over();
  if (died && status_.health == wire::HEALTH_OK) {
    report_failure(fmt::format("nothing was heard of this run for {} s; its bench was given to "
                               "run '{}'",
                               bench_limit.count(), next));
  }
  evaluator_->end_of_excitation(died);
  evaluator_->finish_now();
  evaluate(clock_.now());
}

void RunSession::take_samples(const KnownSources& sources, Instant now) {
  if (const auto described = streams_->take_descriptions(sources, *evaluator_); !described) {
    refuse(described.error().message);
    return;
  }
  streams_->take_samples(now, *evaluator_);
}

void RunSession::arm(const KnownSources& sources, Instant now) {
  if (now >= next_command_) {
    next_command_ = now + command_interval;
    for (const std::string& source : streams_->unanswered()) {
      publisher_.ask_for_answer(source);
    }
  }
  const std::string missing = streams_->what_is_missing(sources);
  if (missing.empty()) {
    status_.arm = wire::ARM_ARMED;
    status_.message.clear();
    last_progress_ = now;
    spdlog::info("bench {}, run {}: armed", bench_, run_);
    publisher_.publish(status_);
  } else if (now - arms_since_ > arm_limit) {
    refuse(missing);
  }
}

void RunSession::watch_sources(Instant now) {
  if (measurement_ != wire::MEASUREMENT_RUNNING || status_.health != wire::HEALTH_OK ||
      now - last_heard_of_run_ > runner_limit) {
    return;
  }
  if (auto lost = streams_->lost_source(now, last_progress_, silence_limit, excited_by_steps_)) {
    report_failure(std::move(*lost));
  }
}

// The conductor switches the output off as soon as it hears of it.
void RunSession::watch_level() {
  if (measurement_ != wire::MEASUREMENT_RUNNING || status_.health != wire::HEALTH_OK) {
    return;
  }
  if (auto excess = evaluator_->excess_of_level()) {
    report_failure(std::move(*excess));
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
  status_.arm = wire::ARM_FINISHED;
  streams_.reset();
  evaluator_.reset();
  spdlog::info("bench {}, run {}: finished, {} results", bench_, run_, publisher_.results());
  publisher_.publish(status_);
}

void RunSession::end_overdue(Instant now) {
  const bool runner_lost = now - last_heard_of_run_ > runner_limit;
  const bool quiet = excitation_over() && now - last_progress_ > quiet_limit;
  if (!runner_lost && !quiet) {
    return;
  }
  if (runner_lost) {
    spdlog::warn("bench {}, run {}: nothing heard of the run for {} s; it ends with what there is",
                 bench_, run_, runner_limit.count());
  }
  evaluator_->end_of_excitation(runner_lost);
  evaluator_->finish_now();
  wake_up_->ring();
}

void RunSession::report_failure(std::string message) {
  status_.health = wire::HEALTH_FAILED;
  status_.message = std::move(message);
  spdlog::warn("bench {}, run {}: {}", bench_, run_, status_.message);
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
