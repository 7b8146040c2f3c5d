#include "services/run/run_watch.hpp"

#include <set>
#include <utility>

#include <fmt/core.h>

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;

constexpr auto alive_interval = 2s; // between two messages about the run, which keep it alive
constexpr auto look_interval = 200ms;

} // namespace

Expected<std::unique_ptr<RunWatch>> RunWatch::open(bus::Participant& participant, bus::Clock& clock,
                                                   wire::Measurement measurement,
                                                   std::string generator,
                                                   const std::shared_ptr<bus::WakeUp>& wake_up,
                                                   RunOutcome& outcome, ShowProgress show) {
  const std::string bench = measurement.bench().to_string();
  const std::string run = measurement.run().to_string();
  DYNCAL_TRY(auto messages,
             RunMessages::open(participant, clock, bench, run, std::move(generator), wake_up));
  std::set<std::uint32_t> steps; // that may be excited again
  for (const wire::PlannedStep& step : measurement.steps()) {
    if (measurement.reference_table().empty()) {
      steps.insert(step.step());
    }
  }
  DYNCAL_TRY(auto commands,
             RunCommands::open(participant, clock, bench, run, std::move(steps), wake_up));
  return std::unique_ptr<RunWatch>(new RunWatch(clock, std::move(measurement), wake_up, outcome,
                                                std::move(show), std::move(messages),
                                                std::move(commands)));
}

RunWatch::RunWatch(bus::Clock& clock, wire::Measurement measurement,
                   std::shared_ptr<bus::WakeUp> wake_up, RunOutcome& outcome, ShowProgress show,
                   RunMessages messages, RunCommands commands)
    : clock_(clock), measurement_(std::move(measurement)), wake_up_(std::move(wake_up)),
      outcome_(outcome), show_progress_(std::move(show)), messages_(std::move(messages)),
      commands_(std::move(commands)) {}

void RunWatch::set_state(wire::MeasurementState state, const std::string& message) {
  measurement_.state(state);
  measurement_.message(message);
  const bool is_armed = analysis() && analysis()->arm() == wire::ARM_ARMED;
  if (is_armed && measurement_.analysis_software().empty()) {
    measurement_.analysis_software(analysis()->software());
  }
  messages_.publish(measurement_);
  measurement_published_ = clock_.now();
}

void RunWatch::look() {
  look_without_hold();
  messages_.repeat_announcement();
}

void RunWatch::look_without_hold() {
  if (messages_.take(outcome_) > 0 && new_results_) {
    new_results_(outcome_);
  }
  if (messages_.unplanned() > 0 && !std::exchange(unplanned_said_, true)) {
    notice("results of this run came that it did not plan or excite; they are left out: does "
           "another program "
           "publish as the analysis of this run?");
  }
  if (messages_.of_others() > 0 && !std::exchange(others_said_, true)) {
    notice(fmt::format("{} publishes about this run and is not its analysis; what it says is left "
                       "out",
                       messages_.other_publisher()));
  }
  if (measurement_.state() == wire::MEASUREMENT_RUNNING) {
    if (const auto sentence = messages_.notice_of_guard()) {
      notice(*sentence);
    }
  }
  commands_.take(measurement_.state() == wire::MEASUREMENT_PLANNED ||
                 measurement_.state() == wire::MEASUREMENT_RUNNING);
  while (const auto answer = commands_.take_answer()) {
    measurement_.answered_command(answer->command);
    measurement_.answer(answer->refusal);
    set_state(measurement_.state(), measurement_.message());
  }
  if (clock_.now() - measurement_published_ > alive_interval) {
    set_state(measurement_.state(), measurement_.message());
  }
}

void RunWatch::follow(const std::string& phase) {
  show(phase);
  clock_.wait(*wake_up_, clock_.now() + look_interval);
  look();
}

std::string RunWatch::silence_of_analysis(std::chrono::seconds limit) const {
  return fmt::format(
      "the analysis service {} has gone silent; waiting for it or another up to {} s",
      analysis()->service().c_str(), limit.count());
}

std::optional<Error> RunWatch::other_recipe() const {
  return messages_.has_other_recipe()
             ? std::optional(Error{ErrorCode::bad_file,
                                   "the analysis evaluates this run by another bench file than it "
                                   "is conducted by; begin a new run"})
             : std::nullopt;
}

RunOutlook RunWatch::outlook() const {
  const RunOutlook outlook = run_outlook(messages_.analysis(), messages_.analysis_participant(),
                                         clock_.now() - messages_.analysis_heard(), commands_);
  if (outlook.kind != RunOutlook::Kind::well) {
    return outlook;
  }
  if (auto other = other_recipe()) {
    return {RunOutlook::Kind::over, std::move(*other)};
  }
  if (std::string other = messages_.other_instrument(); !other.empty()) {
    return {RunOutlook::Kind::waits, {ErrorCode::no_source, std::move(other)}};
  }
  std::string deafness = messages_.deafness_of_guard();
  return deafness.empty()
             ? outlook
             : RunOutlook{RunOutlook::Kind::waits, {ErrorCode::device, std::move(deafness)}};
}

void RunWatch::show_step(std::size_t place, std::uint32_t attempt) {
  if (place_ == 0) {
    first_step_began_ = clock_.now();
  }
  place_ = place;
  attempt_ = attempt;
}

// Of the planned steps, by those that are over.
std::optional<double> RunWatch::seconds_left() const {
  if (place_ < 2 || attempt_ > 1) {
    return std::nullopt;
  }
  const std::chrono::duration<double> so_far = clock_.now() - first_step_began_;
  return so_far.count() / static_cast<double>(place_ - 1) *
         static_cast<double>(measurement_.steps().size() - place_ + 1);
}

void RunWatch::show(const std::string& phase, const std::string& request,
                    const std::string& notice) {
  RunProgress progress;
  progress.step = place_;
  progress.steps = measurement_.steps().size();
  progress.attempt = attempt_;
  progress.phase = phase;
  progress.request = request;
  progress.notice = notice;
  progress.results = outcome_.results.size();
  if (place_ > 0) {
    progress.frequency_hz = measurement_.steps()[place_ - 1].frequency_text_hz();
    progress.seconds_left = seconds_left();
  }
  show_progress_(progress);
}

} // namespace dyncal::inline run
