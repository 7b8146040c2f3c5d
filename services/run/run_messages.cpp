#include "services/run/run_messages.hpp"

#include <algorithm>

#include "services/contract/source_description.hpp"
#include "services/contract/topics.hpp"
#include "services/evaluation/result/clock_report_message.hpp"
#include "services/evaluation/result/result_message.hpp"
#include "services/evaluation/result/transfer_function_message.hpp"
#include "services/run/run_outlook.hpp"

namespace dyncal::services {
namespace {

constexpr std::chrono::milliseconds announcement_interval{500};

bool is_over(wire::ExcitationState state) {
  return state == wire::EXCITATION_DONE || state == wire::EXCITATION_ABORTED;
}

} // namespace

Expected<RunMessages> RunMessages::open(bus::Participant& participant, bus::Clock& clock,
                                        const std::string& bench, std::string run,
                                        const std::shared_ptr<bus::WakeUp>& wake_up) {
  namespace topics = bus::topics;
  auto measurement = participant.writer(topics::measurement, bench);
  auto excitation = participant.writer(topics::excitation, bench);
  auto status = participant.reader(topics::service_status, bench, wake_up);
  auto results = participant.reader(topics::calibration_result, bench, wake_up);
  auto transfer = participant.reader(topics::transfer_function, bench, wake_up);
  auto clocks = participant.reader(topics::sample_clock_report, bench, wake_up);
  auto sources = participant.reader(topics::source_description, bench, wake_up);
  if (auto error =
          first_error(measurement, excitation, status, results, transfer, clocks, sources)) {
    return fail(*error);
  }
  return RunMessages(clock, bench, std::move(run),
                     Endpoints{std::move(*measurement), std::move(*excitation), std::move(*status),
                               std::move(*results), std::move(*transfer), std::move(*clocks),
                               std::move(*sources)});
}

void RunMessages::publish(const wire::Measurement& measurement) {
  endpoints_.measurement.write(measurement);
}

void RunMessages::announce(const wire::PlannedStep& step, std::uint32_t attempt,
                           wire::ExcitationState state, bool output_may_be_on) {
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
  endpoints_.excitation.write(excitation_);
  announced_ = clock_->now();
}

void RunMessages::confirm_off() {
  if (is_over(excitation_.state()) && excitation_.window_end_utc_ns() == 0) {
    excitation_.window_end_utc_ns(clock_->utc_now_ns());
    endpoints_.excitation.write(excitation_);
  }
}

void RunMessages::repeat_announcement() {
  const bool driven = excitation_.step() != 0 && !is_over(excitation_.state());
  if (driven && clock_->now() - announced_ >= announcement_interval) {
    endpoints_.excitation.write(excitation_);
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
                                     SameKey same_key) {
  std::size_t taken = 0;
  reader.take([&](const Message& message) {
    if (message.run().to_string() != run_) {
      return;
    }
    ++taken;
    other_recipe_ = other_recipe_ || is_of_other_recipe(message, recipe_sha256_);
    Result result = from_message(message);
    const auto known = std::find_if(all.begin(), all.end(),
                                    [&](const Result& other) { return same_key(other, result); });
    if (known == all.end()) {
      all.push_back(std::move(result));
    } else if (!is_older(result, *known)) {
      *known = std::move(result);
    }
  });
  return taken;
}

void RunMessages::take_sources(RunOutcome& outcome) {
  const std::vector<std::string> of_run =
      outcome.recipe ? outcome.recipe->sources() : std::vector<std::string>{};
  endpoints_.sources.take([&](const wire::SourceDescription& message) {
    RunSource source{message.source().to_string(), from_wire(message.kind()), message.software(),
                     from_message(message)};
    if (std::find(of_run.begin(), of_run.end(), source.source) == of_run.end()) {
      return;
    }
    const auto known =
        std::find_if(outcome.sources.begin(), outcome.sources.end(),
                     [&](const RunSource& other) { return other.source == source.source; });
    if (known == outcome.sources.end()) {
      outcome.sources.push_back(std::move(source));
    } else {
      *known = std::move(source);
    }
  });
}

std::size_t RunMessages::take(RunOutcome& outcome) {
  take_sources(outcome);
  recipe_sha256_ = outcome.recipe_sha256;
  const std::size_t results =
      take_newest(endpoints_.results, outcome.results, [](const auto& a, const auto& b) {
        return a.step == b.step && a.repetition == b.repetition && a.channel == b.channel;
      });
  signs_of_work_ += results;
  const std::size_t functions =
      take_newest(endpoints_.transfer_functions, outcome.transfer_functions,
                  [](const auto& a, const auto& b) { return a.channel == b.channel; });
  const std::size_t reports =
      take_newest(endpoints_.clock_reports, outcome.clock_reports,
                  [](const auto& a, const auto& b) { return a.source == b.source; });
  take_status(outcome);
  return results + functions + reports;
}

void RunMessages::take_status(RunOutcome& outcome) {
  endpoints_.status.take([&](const wire::ServiceStatus& status) {
    if (status.run().to_string() == run_ && follows(status)) {
      const bool reports_work = !status.message().empty() && status.health() != wire::HEALTH_FAILED;
      const bool is_news = !analysis_ || analysis_->message() != status.message();
      signs_of_work_ += reports_work && is_news ? 1 : 0;
      analysis_ = status;
      analysis_heard_ = clock_->now();
      outcome.analysis_dds = status.dds();
      outcome.analysis_software = status.software();
      outcome.analysis_host = status.host();
    }
  });
}

bool RunMessages::follows(const wire::ServiceStatus& status) const {
  if (!analysis_ || status.service() == analysis_->service()) {
    return true;
  }
  const bool evaluates =
      analysis_->arm() == wire::ARM_ARMED || analysis_->arm() == wire::ARM_FINISHED;
  return !evaluates || clock_->now() - analysis_heard_ > attention_limit;
}

} // namespace dyncal::services
