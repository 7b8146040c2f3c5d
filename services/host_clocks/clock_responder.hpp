// Answers whoever asks for this host's clock (clock_offset.hpp), and so tells that the program is
// there. An answer also tells what has come of the asker's probes, which it echoes
// (link_responder.hpp).
//
// Bound: `max_answers_per_s`; requests beyond it stay without an answer. A reader that does not
// take its answers costs one attempt of a write each. Threads: create() starts one of its own,
// which lasts as long as the object; a test calls work() instead.
#pragma once

#include <cstdint>
#include <memory>
#include <thread>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/error.hpp"
#include "services/host_clocks/clock_messages.hpp"
#include "services/host_clocks/link_responder.hpp"

namespace dyncal::services {

class ClockResponder {
public:
  static constexpr int max_answers_per_s = 50;

  // Fail (network) as writers and readers do. `participant` need not outlive the object, `clock`
  // must.
  [[nodiscard]] static Expected<std::unique_ptr<ClockResponder>>
  open(bus::Participant& participant, ProgramIdentity identity, bus::Clock& clock);
  // The same, and answers in a thread of its own by the host's clock.
  [[nodiscard]] static Expected<std::unique_ptr<ClockResponder>>
  start(bus::Participant& participant, ProgramIdentity identity);

  // Answers and echoes what has come.
  void work();

private:
  ClockResponder(ProgramIdentity identity, bus::Clock& clock, std::shared_ptr<bus::WakeUp> wake_up,
                 bus::Reader<wire::ClockRequest> requests, bus::Writer<wire::ClockAnswer> answers,
                 LinkResponder links, std::shared_ptr<const bus::RefusedPackets> refused)
      : identity_(std::move(identity)), name_(service_name(identity_)), clock_(&clock),
        wake_up_(std::move(wake_up)), requests_(std::move(requests)), answers_(std::move(answers)),
        links_(std::move(links)), refused_(std::move(refused)) {}
  void run(const std::stop_token& stop);
  void answer(const wire::ClockRequest& request, std::int64_t received_utc_ns);
  [[nodiscard]] bool may_answer();

  ProgramIdentity identity_;
  std::string name_;
  bus::Clock* clock_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  bus::Reader<wire::ClockRequest> requests_;
  bus::Writer<wire::ClockAnswer> answers_;
  LinkResponder links_;
  std::shared_ptr<const bus::RefusedPackets> refused_;
  bus::Clock::Instant second_began_;
  int answers_in_second_ = 0;
  std::jthread thread_; // the last: ended first
};

} // namespace dyncal::services
