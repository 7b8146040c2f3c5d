#include "services/programs/analysis/run_publisher.hpp"

#include <spdlog/spdlog.h>

#include "services/base/version.hpp"
#include "services/contract/topics.hpp"
#include "services/evaluation/result/result_messages.hpp"

namespace dyncal::inline programs {
namespace {

constexpr std::chrono::seconds write_limit{10}; // longer than the lease of a reader that was killed
constexpr std::chrono::seconds settled_limit{10};

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
    write(writers_.result, to_message(recipe, result));
    results_ += result.attempt == 1 ? 1 : 0; // a later attempt has the same key
  }
  for (const StepResult& result : output.settled) { // again: not counted
    write(writers_.result, to_message(recipe, result));
  }
  // Topics have no order among each other, and nothing tells a reader of FINISHED that a result
  // comes once more: so it is there before.
  if (!output.settled.empty() && !writers_.result.wait_for_acknowledgments(settled_limit)) {
    spdlog::warn("bench {}, run {}: not everybody has acknowledged the last results", bench_, run_);
  }
  for (const TransferFunction& function : output.transfer_functions) {
    write(writers_.transfer_function, to_message(recipe, function));
    ++transfer_functions_;
  }
  for (const ClockReport& report : output.clock_reports) {
    write(writers_.clock_report, to_message(recipe, report));
    ++clock_reports_;
  }
}

template <class Message>
void RunPublisher::write(bus::Writer<Message>& writer, const Message& message) {
  if (writer.write(message, write_limit) != bus::WriteOutcome::written) {
    spdlog::error("bench {}, run {}: a message could not be written to the network", bench_, run_);
  }
}

} // namespace dyncal::inline programs
