#include "services/run/run_messages.hpp"

#include <algorithm>

#include "services/contract/contract_versions.hpp"
#include "services/contract/source_description.hpp"
#include "services/contract/topics.hpp"
#include "services/evaluation/record/step_order.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "services/run/run_outlook.hpp"

namespace dyncal::inline run {
namespace {

constexpr std::chrono::milliseconds announcement_interval{500};

bool is_over(wire::ExcitationState state) {
  return state == wire::EXCITATION_DONE || state == wire::EXCITATION_ABORTED;
}

} // namespace

Expected<RunMessages> RunMessages::open(bus::Participant& participant, bus::Clock& clock,
                                        const std::string& bench, std::string run,
                                        std::string generator,
                                        const std::shared_ptr<bus::WakeUp>& wake_up) {
  namespace topics = bus::topics;
  DYNCAL_TRY(auto measurement, participant.writer(topics::measurement, bench));
  DYNCAL_TRY(auto excitation, participant.writer(topics::excitation, bench));
  DYNCAL_TRY(auto status, participant.reader(topics::service_status, bench, wake_up));
  DYNCAL_TRY(auto published, open_readers(participant, bench, run, wake_up));
  DYNCAL_TRY(auto sources, participant.reader(topics::source_description, bench, wake_up));
  std::optional<AttendanceLinks> links;
  if (!generator.empty()) {
    DYNCAL_TRY(links, AttendanceLinks::draw());
  }
  return RunMessages(participant, clock, GuardWatch(bench, std::move(generator), clock.now()),
                     std::move(links), bench, std::move(run), wake_up,
                     Endpoints{std::move(measurement), std::move(excitation), std::move(status),
                               std::move(sources)},
                     std::move(published));
}

Expected<RunMessages::ResultReaders>
RunMessages::open_readers(bus::Participant& participant, const std::string& bench,
                          const std::optional<std::string>& run,
                          const std::shared_ptr<bus::WakeUp>& wake_up) {
  namespace topics = bus::topics;
  const auto reader = [&](const auto& topic) {
    return run ? participant.reader_of_run(topic, bench, *run, wake_up)
               : participant.reader(topic, bench, wake_up);
  };
  DYNCAL_TRY(auto results, reader(topics::calibration_result));
  DYNCAL_TRY(auto transfer, reader(topics::transfer_function));
  DYNCAL_TRY(auto clocks, reader(topics::sample_clock_report));
  return ResultReaders{std::move(results), std::move(transfer), std::move(clocks)};
}

void RunMessages::collect_again() {
  const auto run = reads_whole_bench_ ? std::nullopt : std::optional(run_);
  auto status = participant_->reader(bus::topics::service_status, bench_, wake_up_);
  auto again = open_readers(*participant_, bench_, run, wake_up_);
  if (status && again) {
    endpoints_.status = std::move(*status);
    published_ = std::move(*again);
  }
}

void RunMessages::publish(wire::Measurement measurement) {
  was_planned_here_ = was_planned_here_ || measurement.state() == wire::MEASUREMENT_PLANNED;
  has_begun_ = has_begun_ || measurement.state() == wire::MEASUREMENT_RUNNING;
  conductor_ = measurement.conductor();
  if (links_) {
    links_->show(measurement);
  }
  endpoints_.measurement.write(measurement);
}

void RunMessages::write_announcement() {
  if (links_) {
    links_->show(excitation_);
  }
  endpoints_.excitation.write(excitation_);
}

void RunMessages::announce(const wire::PlannedStep& step, std::uint32_t attempt,
                           wire::ExcitationState state, bool output_may_be_on) {
  attempts_[step.step()] = std::max(attempts_[step.step()], attempt);
  if (step.step() != excitation_.step() || attempt != excitation_.attempt()) {
    excitation_.window_begin_utc_ns(0);
    if (attempt > 1) {
      excitation_.repeated_steps().push_back(step.step());
    }
  }
  if (state == wire::EXCITATION_SETTLING) {
    excitation_.window_begin_utc_ns(clock_->utc_now_ns());
  }
  excitation_.bench(bench_);
  excitation_.run(run_);
  excitation_.step(step.step());
  excitation_.frequency_text_hz(step.frequency_text_hz());
  excitation_.level_m_s2(step.level_m_s2());
  excitation_.repetition(step.repetition());
  excitation_.state(state);
  excitation_.window_end_utc_ns(is_over(state) && !output_may_be_on ? clock_->utc_now_ns() : 0);
  excitation_.attempt(attempt);
  write_announcement();
  announced_ = clock_->now();
}

void RunMessages::confirm_off() {
  if (is_over(excitation_.state()) && excitation_.window_end_utc_ns() == 0) {
    excitation_.window_end_utc_ns(clock_->utc_now_ns());
    write_announcement();
  }
}

void RunMessages::repeat_announcement() {
  const bool driven = excitation_.step() != 0 && !is_over(excitation_.state());
  if (driven && clock_->now() - announced_ >= announcement_interval) {
    write_announcement();
    announced_ = clock_->now();
  }
}

void RunMessages::wait_for_acknowledgments(std::chrono::nanoseconds limit) {
  endpoints_.measurement.wait_for_acknowledgments(limit);
}

namespace {

bool is_older(const StepResult& result, const StepResult& known) {
  return result.attempt < known.attempt;
}

// Without channels under calibration all of the recipe's sources are.
bool has_channel(const Recipe& recipe, const std::string& name) {
  const std::vector<ChannelName> channels = recipe.channels();
  const std::vector<std::string> sources = recipe.sources();
  return std::ranges::any_of(channels,
                             [&](const ChannelName& channel) { return channel.text() == name; }) ||
         (recipe.dut().empty() && std::ranges::any_of(sources, [&](const std::string& source) {
            return name.starts_with(source + "/");
          }));
}
bool is_planned(const StepResult& result, const Recipe& recipe) {
  return has_channel(recipe, result.channel) &&
         std::ranges::any_of(recipe.steps, [&](const RecipeStep& step) {
           return step.step == result.step && step.repetition == result.repetition;
         });
}
// The step whose announcement is of this one too: the first line of its multi-sine, or itself.
std::uint32_t excitation_of(const Recipe& recipe, std::uint32_t step) {
  const StepOrder order(recipe);
  const auto place = order.find(step, 1);
  return place ? order.step(*place).step : step;
}
bool is_planned(const TransferFunction& function, const Recipe& recipe) {
  return has_channel(recipe, function.channel);
}
bool is_planned(const ClockReport& report, const Recipe& recipe) {
  const std::vector<std::string> sources = recipe.sources();
  return std::ranges::find(sources, report.source) != sources.end();
}

bool is_of_other_recipe(const wire::CalibrationResult& result, const std::string& sha256) {
  return !result.recipe_sha256().empty() && result.recipe_sha256() != sha256;
}
template <class Message>
bool is_of_other_recipe(const Message& /*message*/, const std::string& /*sha256*/) {
  return false;
}

template <class Result>
bool is_older(const Result& /*result*/, const Result& /*known*/) {
  return false;
}

} // namespace

template <class Message, class Result, class SameKey>
std::size_t RunMessages::take_newest(bus::Reader<Message>& reader, std::vector<Result>& all,
                                     const std::optional<Recipe>& planned, SameKey same_key) {
  std::size_t taken = 0;
  reader.take_with_writer([&](const Message& message, const bus::WriterId& writer) {
    if (message.run().to_string() != run_) {
      return;
    }
    if (!analysis_ || writer.participant() != analysis_participant_) {
      leave_out(writer);
      return;
    }
    if (is_of_other_recipe(message, recipe_sha256_)) {
      other_recipe_ = true;
      return;
    }
    Result result = from_message(message);
    if (planned && (!is_planned(result, *planned) || !was_excited(*planned, result, all))) {
      ++unplanned_;
      return;
    }
    ++taken;
    const auto known =
        std::ranges::find_if(all, [&](const Result& other) { return same_key(other, result); });
    if (known == all.end()) {
      all.push_back(std::move(result));
    } else if (!is_older(result, *known)) {
      *known = std::move(result);
    }
  });
  return taken;
}

// Recorded files announce no steps. A result that is not valid may be of a step that was never
// begun: it says why. An attempt of the conductor before may have no result yet.
bool RunMessages::was_excited(const Recipe& planned, const StepResult& result,
                              const std::vector<StepResult>& known) const {
  const auto announced = attempts_.find(excitation_of(planned, result.step));
  std::uint32_t made = announced == attempts_.end() ? 0 : announced->second;
  if (was_planned_here_) {
    return result.attempt <= std::max(made, 1U) && (made > 0 || attempts_.empty() || !result.valid);
  }
  for (const StepResult& one : known) {
    made = one.step == result.step ? std::max(made, one.attempt) : made;
  }
  return attempts_.empty() || result.attempt <= made + 1;
}

void RunMessages::take_source(RunSource source, std::vector<RunSource>& sources) {
  described_.insert(source.source);
  const auto known = std::ranges::find(sources, source.source, &RunSource::source);
  if (known == sources.end()) {
    sources.push_back(std::move(source));
    return;
  }
  std::string other =
      has_begun_ ? device_difference(source.source, known->description, source.description) : "";
  if (other.empty()) {
    other_instruments_.erase(source.source);
    *known = std::move(source);
  } else {
    other_instruments_.insert_or_assign(source.source, std::move(other));
  }
}

void RunMessages::take_sources(RunOutcome& outcome) {
  const std::vector<std::string> of_run =
      outcome.recipe ? outcome.recipe->sources() : std::vector<std::string>{};
  endpoints_.sources.take([&](const wire::SourceDescription& message) {
    RunSource source{message.source().to_string(), from_wire(message.kind()), message.software(),
                     from_message(message)};
    if (std::ranges::find(of_run, source.source) == of_run.end()) {
      return;
    }
    take_source(std::move(source), outcome.sources);
  });
}

std::size_t RunMessages::take(RunOutcome& outcome) {
  take_sources(outcome);
  take_status(outcome); // first: with FINISHED all results are there
  const std::size_t results = take_newest(
      published_.results, outcome.results, outcome.recipe, [](const auto& a, const auto& b) {
        return a.step == b.step && a.repetition == b.repetition && a.channel == b.channel;
      });
  signs_of_work_ += results;
  const std::size_t functions =
      take_newest(published_.transfer_functions, outcome.transfer_functions, outcome.recipe,
                  [](const auto& a, const auto& b) { return a.channel == b.channel; });
  const std::size_t reports =
      take_newest(published_.clock_reports, outcome.clock_reports, outcome.recipe,
                  [](const auto& a, const auto& b) { return a.source == b.source; });
  return results + functions + reports;
}

void RunMessages::take_status(RunOutcome& outcome) {
  bool is_of_older_contract = false;
  const std::string before = analysis_participant_;
  recipe_sha256_ = outcome.recipe_sha256;
  endpoints_.status.take_with_writer(
      [&](const wire::ServiceStatus& status, const bus::WriterId& writer) {
        if (!status.guarded_generator().empty()) {
          guard_.take(status, clock_->now());
        } else if (status.run().to_string() == run_ && follows(status, writer)) {
          is_of_older_contract = status.contract_version() < contract_versions::partitions_of_runs;
          follow(status, writer.participant());
          outcome.analysis_dds = status.dds();
          outcome.analysis_software = status.software();
          outcome.analysis_host = status.host();
        } else if (status.run().to_string() == run_) {
          leave_out(writer);
        }
      });
  const bool is_of_older_for_the_first_time = is_of_older_contract && !reads_whole_bench_;
  reads_whole_bench_ = reads_whole_bench_ || is_of_older_contract;
  const bool was_left_out =
      analysis_participant_ != before && left_out_.erase(analysis_participant_) > 0;
  if (is_of_older_for_the_first_time || was_left_out) {
    collect_again();
  }
}

bool RunMessages::follows(const wire::ServiceStatus& status, const bus::WriterId& writer) const {
  if (!analysis_ || writer.participant() == analysis_participant_) {
    return true;
  }
  const bool evaluates =
      analysis_->arm() == wire::ARM_ARMED || analysis_->arm() == wire::ARM_FINISHED;
  const bool is_free = !evaluates || clock_->now() - analysis_heard_ > attention_limit;
  // Not told before contract 3.
  const bool is_of_this_run =
      status.conductor().empty() || status.recipe_sha256().empty() ||
      (status.conductor() == conductor_ && status.recipe_sha256() == recipe_sha256_);
  return is_free && is_of_this_run;
}

void RunMessages::follow(const wire::ServiceStatus& status, const std::string& participant) {
  const bool reports_work = !status.message().empty() && status.health() != wire::HEALTH_FAILED;
  const bool is_news = !analysis_ || analysis_->message() != status.message();
  signs_of_work_ += reports_work && is_news ? 1 : 0;
  analysis_ = status;
  analysis_participant_ = participant;
  analysis_heard_ = clock_->now();
}

void RunMessages::leave_out(const bus::WriterId& writer) {
  if (analysis_ && ++of_others_ == 1) {
    other_publisher_ = writer.participant();
  }
  if (left_out_.size() < max_left_out) {
    left_out_.insert(writer.participant());
  }
}

} // namespace dyncal::inline run
