// Measures what is lost on the way to every program of a laboratory and back (link_loss.hpp).
//
// Sends probes once a program answers about its clock, one every `interval`, and more slowly where
// many programs answer: each gets a packet of its own, and the link must not lose any because of
// the probes. Ends after `max_probes`. A probe that is late is not made up for: no bursts. A packet
// that comes after one that was sent later is lost to DDS, and counts as lost.
//
// Bound: echoes of `max_programs`. Belongs to one thread, which calls work() when the wake-up rings
// or next_probe() is due.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/error.hpp"
#include "services/host_clocks/clock_asker.hpp"
#include "services/host_clocks/link_loss.hpp"

namespace dyncal::services {

class LinkMeter {
public:
  using Instant = bus::Clock::Instant;
  static constexpr std::chrono::milliseconds interval{10};
  static constexpr std::chrono::milliseconds interval_per_program{2};
  static constexpr std::size_t max_probes = 2000;
  static constexpr std::size_t max_programs = 500;
  // From the first answer of a program until it also gets probes; on the way.
  static constexpr std::chrono::milliseconds settling{300};

  // Fails (network) as writers and readers do. `clock` outlives the object.
  [[nodiscard]] static Expected<LinkMeter> open(bus::Participant& participant,
                                                const ProgramIdentity& identity, bus::Clock& clock,
                                                const std::shared_ptr<bus::WakeUp>& wake_up);

  // Takes echoes, and sends a probe when it is time; `programs` answer about their clocks.
  void work(std::size_t programs);
  // The end of time before a program has answered, and after the last probe.
  [[nodiscard]] Instant next_probe() const { return next_probe_; }

  // One a program, in their order.
  [[nodiscard]] std::vector<LinkLoss> losses(const std::vector<HeardProgram>& programs) const;
  [[nodiscard]] std::uint64_t probes() const { return sent_.size(); }

private:
  LinkMeter(std::string name, bus::Clock& clock, bus::Writer<wire::LinkProbe> probes,
            bus::Reader<wire::LinkEcho> echoes);
  void take(const wire::LinkEcho& echo);
  void send();
  [[nodiscard]] std::uint64_t sent_until(Instant time) const;

  std::string name_;
  bus::Clock* clock_;
  bus::Writer<wire::LinkProbe> probes_;
  bus::Reader<wire::LinkEcho> echoes_;
  std::uint64_t series_;
  Instant next_probe_ = Instant::max();
  std::vector<Instant> sent_; // of each probe, the first first
  std::map<std::string, EchoCounts> echoes_of_;
};

} // namespace dyncal::services
