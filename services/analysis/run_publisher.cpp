#include "services/analysis/run_publisher.hpp"

#include <spdlog/spdlog.h>

#include "services/contract/topics.hpp"
#include "services/evaluation/result/clock_report_message.hpp"
#include "services/evaluation/result/result_message.hpp"
#include "services/evaluation/result/transfer_function_message.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;

constexpr auto write_limit = 10s;          // longer than the lease of a reader that was killed
constexpr auto command_write_limit = 50ms; // a command is repeated until it is answered

} // namespace

Expected<RunPublisher> RunPublisher::open(bus::Participant& participant, bus::Clock& clock,
                                          AnalysisIdentity identity, std::string bench,
                                          std::string run) {
  namespace topics = bus::topics;
  auto command = participant.writer(topics::command, bench);
  auto catch_up = participant.writer(topics::catch_up_request, bench);
  auto status = participant.writer(topics::service_status, bench);
  auto result = participant.writer(topics::calibration_result, bench);
  auto transfer = participant.writer(topics::transfer_function, bench);
  auto report = participant.writer(topics::sample_clock_report, bench);
  if (auto error = first_error(command, catch_up, status, result, transfer, report)) {
    return fail(*error);
  }
  return RunPublisher(clock, std::move(identity), std::move(bench), std::move(run),
                      Writers{std::move(*command), std::move(*catch_up), std::move(*status),
                              std::move(*result), std::move(*transfer), std::move(*report)});
}

void RunPublisher::ask_for_answer(const std::string& source) {
  wire::Command command;
  command.target(source);
  command.kind(wire::COMMAND_ARM);
  command.bench(bench_);
  command.run(run_);
  command.sender(identity_.service);
  write(writers_.command, command, command_write_limit);
}

void RunPublisher::ask_to_catch_up(const std::string& source, const std::string& asker,
                                   const CatchUp& what) {
  wire::CatchUpRequest request;
  request.bench(bench_);
  request.source(source);
  request.asker(asker);
  request.request(what.request);
  request.run(run_);
  request.session(what.behind.session);
  request.after(what.behind.number);
  write(writers_.catch_up, request, command_write_limit);
}

void RunPublisher::publish(const RunState& state) {
  wire::ServiceStatus status;
  status.service(identity_.service);
  status.run(run_);
  status.bench(bench_);
  status.health(state.health);
  status.arm(state.arm);
  status.message(state.message);
  status.software(software_version());
  status.contract_version(wire::CONTRACT_VERSION);
  status.dds(identity_.dds);
  status.host(identity_.host);
  status.process_id(identity_.process_id);
  status.published_utc_ns(clock_->utc_now_ns());
  status.results_published(results_);
  status.transfer_functions_published(transfer_functions_);
  status.clock_reports_published(clock_reports_);
  write(writers_.status, status, write_limit);
}

void RunPublisher::publish(const Recipe& recipe, const EvaluationOutput& output) {
  for (const StepResult& result : output.results) {
    if (!result.valid) {
      spdlog::warn("bench {}, run {}, step {}, {}: {}", bench_, run_, result.step, result.channel,
                   result.problem);
    }
    write(writers_.result, to_message(recipe, result), write_limit);
    results_ += result.attempt == 1 ? 1 : 0; // a later attempt has the same key
  }
  for (const StepResult& result : output.settled) { // again: not counted
    write(writers_.result, to_message(recipe, result), write_limit);
  }
  for (const TransferFunction& function : output.transfer_functions) {
    write(writers_.transfer_function, to_message(recipe, function), write_limit);
    ++transfer_functions_;
  }
  for (const ClockReport& report : output.clock_reports) {
    write(writers_.clock_report, to_message(recipe, report), write_limit);
    ++clock_reports_;
  }
}

template <class Message>
void RunPublisher::write(bus::Writer<Message>& writer, const Message& message,
                         std::chrono::nanoseconds limit) {
  if (writer.write(message, limit) != bus::WriteOutcome::written) {
    spdlog::error("bench {}, run {}: a message could not be written to the network", bench_, run_);
  }
}

} // namespace dyncal::services
