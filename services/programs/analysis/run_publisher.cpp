#include "services/programs/analysis/run_publisher.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "services/base/version.hpp"
#include "services/contract/topics.hpp"
#include "services/evaluation/result/result_messages.hpp"

namespace dyncal::inline programs {
namespace {

constexpr std::chrono::seconds write_limit{10}; // longer than the lease of a reader that was killed
constexpr std::chrono::milliseconds turn_limit{50}; // other benches and the status wait for it

} // namespace

Expected<RunPublisher> RunPublisher::open(bus::Participant& participant, bus::Clock& clock,
                                          AnalysisIdentity identity, std::string bench,
                                          std::string run) {
  namespace topics = bus::topics;
  DYNCAL_TRY(auto status, participant.writer_of_run(topics::service_status, bench, run));
  DYNCAL_TRY(auto result, participant.writer_of_run(topics::calibration_result, bench, run));
  DYNCAL_TRY(auto transfer, participant.writer_of_run(topics::transfer_function, bench, run));
  DYNCAL_TRY(auto report, participant.writer_of_run(topics::sample_clock_report, bench, run));
  return RunPublisher(
      clock, std::move(identity), std::move(bench), std::move(run),
      Writers{std::move(status), std::move(result), std::move(transfer), std::move(report)});
}

void RunPublisher::publish(const RunState& state) {
  wire::ServiceStatus status;
  status.service(identity_.service);
  status.run(run_);
  status.bench(bench_);
  status.health(state.health);
  status.arm(state.arm);
  status.message(state.message);
  status.conductor(state.conductor);
  status.recipe_sha256(state.recipe_sha256);
  status.software(software_version());
  status.contract_version(wire::CONTRACT_VERSION);
  status.dds(identity_.dds);
  status.host(identity_.host);
  status.process_id(identity_.process_id);
  status.published_utc_ns(clock_->utc_now_ns());
  status.results_published(results_);
  status.transfer_functions_published(transfer_functions_);
  status.clock_reports_published(clock_reports_);
  write(writers_.status, status);
}

void RunPublisher::publish(const Recipe& recipe, const EvaluationOutput& output) {
  for (const StepResult& result : output.results) {
    if (!result.valid) {
      spdlog::warn("bench {}, run {}, step {}, {}: {}", bench_, run_, result.step, result.channel,
                   result.problem);
    }
  }
  queue(recipe, output);
  hand_over();
}

void RunPublisher::queue(const Recipe& recipe, const EvaluationOutput& output) {
  for (const StepResult& result : output.results) {
    // A later attempt has the same key.
    waiting_.push_back({to_message(recipe, result), result.attempt == 1});
  }
  for (const StepResult& result : output.settled) {
    waiting_.push_back({to_message(recipe, result), false});
  }
  comes_once_more_ = comes_once_more_ || !output.settled.empty();
  for (const TransferFunction& function : output.transfer_functions) {
    functions_waiting_.push_back(to_message(recipe, function));
  }
  for (const ClockReport& report : output.clock_reports) {
    reports_waiting_.push_back(to_message(recipe, report));
  }
}

void RunPublisher::hand_over() {
  const auto turn_ends = clock_->now() + turn_limit;
  while (!waiting_.empty()) {
    if (unacknowledged_ >= results_at_once && !are_acknowledged(turn_ends)) {
      return;
    }
    write(writers_.result, waiting_.front().message);
    results_ += waiting_.front().counts ? 1 : 0;
    waiting_.pop_front();
    waits_since_ = unacknowledged_++ == 0 ? clock_->now() : waits_since_;
  }
  // Topics have no order among each other, and nothing tells a reader of FINISHED that a result
  // comes once more: so it is there before.
  if (comes_once_more_ && unacknowledged_ > 0 && !are_acknowledged(turn_ends)) {
    return;
  }
  comes_once_more_ = false;
  for (const wire::TransferFunction& function : functions_waiting_) {
    write(writers_.transfer_function, function);
    ++transfer_functions_;
  }
  for (const wire::SampleClockReport& report : reports_waiting_) {
    write(writers_.clock_report, report);
    ++clock_reports_;
  }
  functions_waiting_.clear();
  reports_waiting_.clear();
}

bool RunPublisher::are_acknowledged(bus::Clock::Instant turn_ends) {
  const auto limit = std::max(bus::Clock::Instant::duration::zero(), turn_ends - clock_->now());
  const bool acknowledged = writers_.result.wait_for_acknowledgments(limit);
  if (!acknowledged && !is_unheard_ && clock_->now() - waits_since_ < acknowledgment_limit) {
    return false;
  }
  if (!acknowledged && !is_unheard_) {
    spdlog::warn("bench {}, run {}: not everybody has acknowledged the last results", bench_, run_);
  }
  is_unheard_ = !acknowledged;
  unacknowledged_ = 0;
  return true;
}

template <class Message>
void RunPublisher::write(bus::Writer<Message>& writer, const Message& message) {
  if (writer.write(message, write_limit) != bus::WriteOutcome::written) {
    spdlog::error("bench {}, run {}: a message could not be written to the network", bench_, run_);
  }
}

} // namespace dyncal::inline programs
