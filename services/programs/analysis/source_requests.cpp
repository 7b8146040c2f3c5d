#include "services/programs/analysis/source_requests.hpp"

#include <chrono>
#include <utility>

#include <spdlog/spdlog.h>

#include "services/contract/topics.hpp"

namespace dyncal::inline programs {
namespace {

constexpr std::chrono::milliseconds write_limit{50};

} // namespace

Expected<std::shared_ptr<SourceRequests>>
SourceRequests::open(bus::Participant& participant, std::string bench, std::string sender) {
  DYNCAL_TRY(auto command, participant.writer(bus::topics::command, bench));
  DYNCAL_TRY(auto catch_up, participant.writer(bus::topics::catch_up_request, bench));
  return std::shared_ptr<SourceRequests>(new SourceRequests(
      std::move(bench), std::move(sender), std::move(command), std::move(catch_up)));
}

void SourceRequests::ask_for_answer(const std::string& run, const std::string& source) {
  command(wire::COMMAND_ARM, run, source);
}

void SourceRequests::ask_conductor_to_end(const std::string& run) {
  command(wire::COMMAND_ABORT, run, "conductor");
}

void SourceRequests::command(wire::CommandKind kind, const std::string& run,
                             const std::string& target) {
  wire::Command command;
  command.target(target);
  command.kind(kind);
  command.bench(bench_);
  command.run(run);
  command.sender(sender_);
  write(command_, command, run);
}

void SourceRequests::ask_to_catch_up(const std::string& run, const std::string& source,
                                     const std::string& asker, const CatchUp& what) {
  wire::CatchUpRequest request;
  request.bench(bench_);
  request.source(source);
  request.asker(asker);
  request.request(what.request);
  request.run(run);
  request.session(what.behind.session);
  request.after(what.behind.number);
  write(catch_up_, request, run);
}

template <class Message>
void SourceRequests::write(bus::Writer<Message>& writer, const Message& message,
                           const std::string& run) {
  if (writer.write(message, write_limit) != bus::WriteOutcome::written) {
    spdlog::error("bench {}, run {}: a request could not be written to the network", bench_, run);
  }
}

} // namespace dyncal::inline programs
