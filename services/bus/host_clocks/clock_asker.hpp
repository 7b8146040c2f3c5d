// Asks the programs of a laboratory for their clocks, and keeps what follows from their answers:
// who is there, and how far the clock of its host is ahead of ours (clock_offset.hpp).
//
// The first `quick_requests` are sent `quick_interval` apart, the others `interval`. An answer
// during which our own clock was set is left out. A program that has not answered for
// `forgotten_after` is forgotten; `max_programs` are held at most, those that come later are not.
//
// Belongs to one thread, which calls work() when the wake-up rings or next_request() is due.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/bus/host_clocks/clock_messages.hpp"
#include "services/bus/host_clocks/clock_offset.hpp"

namespace dyncal::inline host_clocks {

struct AskingPace {
  int quick_requests = 5;
  std::chrono::milliseconds quick_interval{500};
  std::chrono::milliseconds interval{10'000};
};

// A program that has answered.
struct DiscoveredProgram {
  ProgramIdentity identity;
  std::uint32_t contract_version = 0;
  std::optional<ClockOffset> clock;
  std::uint64_t answers = 0;
  std::uint64_t packets_refused = 0;     // since its start
  std::uint64_t packets_refused_now = 0; // of these, since its first answer
  std::string packets_refused_from = {}; // the last of them; empty if that is not known
  bus::Clock::Instant first_answer = {};
  bus::Clock::Instant asked = {}; // when the newest request was sent that it has answered
};

struct HostClock {
  std::string host;
  ClockOffset clock;
};

class ClockAsker {
public:
  using Instant = bus::Clock::Instant;
  static constexpr std::chrono::seconds forgotten_after{60};
  static constexpr std::size_t max_programs = 500;

  // Fails (network) as writers and readers do. `clock` outlives the object.
  [[nodiscard]] static Expected<ClockAsker> open(bus::Participant& participant,
                                                 const ProgramIdentity& identity, bus::Clock& clock,
                                                 const std::shared_ptr<bus::WakeUp>& wake_up,
                                                 AskingPace pace = {});

  // Takes answers, and asks when it is time.
  void work();
  [[nodiscard]] Instant next_request() const { return next_request_; }

  // In alphabetical order of their names on the bus.
  [[nodiscard]] std::vector<DiscoveredProgram> programs() const;
  // One a host that is not ours: by its program with the best exchange. In alphabetical order.
  [[nodiscard]] std::vector<HostClock> other_hosts() const;
  [[nodiscard]] std::size_t program_count() const { return heard_.size(); }
  [[nodiscard]] std::uint64_t requests() const { return number_; }

private:
  struct Request {
    std::uint64_t number;
    std::int64_t sent_utc_ns;
    Instant sent;
  };
  struct Heard {
    DiscoveredProgram program;
    OffsetTracker offsets;
    Instant last_answer;
  };

  ClockAsker(const ProgramIdentity& identity, bus::Clock& clock, AskingPace pace,
             bus::Writer<wire::ClockRequest> requests, bus::Reader<wire::ClockAnswer> answers)
      : name_(service_name(identity)), host_(identity.host), clock_(&clock), pace_(pace),
        requests_(std::move(requests)), answers_(std::move(answers)), next_request_(clock.now()) {}
  void take(const wire::ClockAnswer& answer);
  void ask();

  std::string name_;
  std::string host_;
  bus::Clock* clock_;
  AskingPace pace_;
  bus::Writer<wire::ClockRequest> requests_;
  bus::Reader<wire::ClockAnswer> answers_;
  Instant next_request_;
  std::uint64_t number_ = 0;
  std::deque<Request> sent_; // the newest last
  std::map<std::string, Heard> heard_;
};

} // namespace dyncal::inline host_clocks
