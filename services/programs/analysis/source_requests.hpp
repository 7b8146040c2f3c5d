// What the analysis service asks the sources of a bench: to answer in their sample stream, and to
// send again what somebody has missed (idl/README.md, "The run protocol", "Who was away"). Who
// resumes a run that cannot go on as it is now is asked to end it.
//
// The runs of a bench share one object, and so two writers: one a run would have to be found again
// by every source at each beginning, and every new program of the network would be told of those of
// the runs before. A request that the network does not take within 50 ms is logged and given up: it
// is repeated until it is answered. Belongs to the service's one thread.
#pragma once

#include <memory>
#include <string>

#include "idl/dyncal.h"
#include "services/bus/bus.hpp"
#include "services/programs/analysis/stream_follower.hpp"

namespace dyncal::inline programs {

class SourceRequests {
public:
  // `sender` is the service that asks. `participant` need not outlive the object. Fails (network)
  // as writers do.
  [[nodiscard]] static Expected<std::shared_ptr<SourceRequests>>
  open(bus::Participant& participant, std::string bench, std::string sender);

  void ask_for_answer(const std::string& run, const std::string& source);
  void ask_to_catch_up(const std::string& run, const std::string& source, const std::string& asker,
                       const CatchUp& what);
  void ask_conductor_to_end(const std::string& run);

private:
  SourceRequests(std::string bench, std::string sender, bus::Writer<wire::Command> command,
                 bus::Writer<wire::CatchUpRequest> catch_up)
      : bench_(std::move(bench)), sender_(std::move(sender)), command_(std::move(command)),
        catch_up_(std::move(catch_up)) {}
  void command(wire::CommandKind kind, const std::string& run, const std::string& target);
  template <class Message>
  void write(bus::Writer<Message>& writer, const Message& message, const std::string& run);

  std::string bench_;
  std::string sender_;
  bus::Writer<wire::Command> command_;
  bus::Writer<wire::CatchUpRequest> catch_up_;
};

} // namespace dyncal::inline programs
