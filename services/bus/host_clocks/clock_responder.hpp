// Answers anyone who asks for this host's clock (clock_offset.hpp), and so tells that the program
// is there; and echoes the probes of anyone who measures the path to it (link_meter.hpp).
//
// Bounds: `max_answers_per_s` and `max_echoes_per_s`; requests and probes beyond stay without an
// answer, so a flood of them makes no flood of answers. A reader that does not take its answers
// costs one attempt of a write each. Threads: create() starts one of its own, which lasts as long
// as the object; a test calls work() instead.
#pragma once

#include <cstdint>
#include <memory>
#include <thread>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/bus/host_clocks/clock_messages.hpp"

namespace dyncal::inline host_clocks {

class ClockResponder {
public:
  static constexpr int max_answers_per_s = 50;
  static constexpr int max_echoes_per_s = 500; // of five doctors at once

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
  struct Topics {
    bus::Reader<wire::ClockRequest> requests;
    bus::Writer<wire::ClockAnswer> answers;
    bus::Reader<wire::LinkProbe> probes;
    bus::Writer<wire::LinkEcho> echoes;
  };
  // What may be written in a second.
  class Allowance {
  public:
    explicit Allowance(int per_second) : per_second_(per_second) {}
    bool take(bus::Clock::Instant now);

  private:
    int per_second_;
    int taken_ = 0;
    bus::Clock::Instant second_began_;
  };

  ClockResponder(ProgramIdentity identity, bus::Clock& clock, std::shared_ptr<bus::WakeUp> wake_up,
                 Topics topics, std::shared_ptr<const bus::RefusedPackets> refused)
      : identity_(std::move(identity)), name_(service_name(identity_)), clock_(&clock),
        wake_up_(std::move(wake_up)), topics_(std::move(topics)), refused_(std::move(refused)) {}
  void run(const std::stop_token& stop);
  void answer(const wire::ClockRequest& request, std::int64_t received_utc_ns);
  void echo(const wire::LinkProbe& probe);

  ProgramIdentity identity_;
  std::string name_;
  bus::Clock* clock_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  Topics topics_;
  std::shared_ptr<const bus::RefusedPackets> refused_;
  Allowance answers_left_{max_answers_per_s};
  Allowance echoes_left_{max_echoes_per_s};
  std::jthread thread_; // the last: ended first
};

} // namespace dyncal::inline host_clocks
