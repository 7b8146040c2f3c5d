// Echoes the probes of whoever measures what is lost on the way to this program and back
// (link_loss.hpp), and counts them. What it has counted goes into answers about the clock
// (clock_responder.hpp), in whose thread it lives.
//
// Bounds: `max_echoes_per_s`; probes beyond it are counted and not echoed, so a flood of probes
// makes no flood of echoes, and an asker sees that those are not lost. `max_askers`; who has been
// silent longest is forgotten for one more, and begins anew with its next probe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/error.hpp"
#include "services/host_clocks/link_loss.hpp"

namespace dyncal::services {

class LinkResponder {
public:
  static constexpr int max_echoes_per_s = 500;
  static constexpr std::size_t max_askers = 16;

  // `service` names this program on the bus. Fails (network) as writers and readers do. `clock`
  // outlives the object.
  [[nodiscard]] static Expected<LinkResponder> open(bus::Participant& participant,
                                                    std::string service, bus::Clock& clock,
                                                    const std::shared_ptr<bus::WakeUp>& wake_up);

  // Echoes what has come.
  void work();
  // Zeros of an asker that nothing has come from.
  [[nodiscard]] ProbeCounts counts(const std::string& asker) const;

  [[nodiscard]] std::uint64_t not_echoed() const { return not_echoed_; }
  [[nodiscard]] std::uint64_t forgotten_askers() const { return forgotten_askers_; }

private:
  struct Asker {
    ProbeCounts counts;
    bus::Clock::Instant last_probe;
  };

  LinkResponder(std::string service, bus::Clock& clock, bus::Reader<wire::LinkProbe> probes,
                bus::Writer<wire::LinkEcho> echoes)
      : service_(std::move(service)), clock_(&clock), probes_(std::move(probes)),
        echoes_(std::move(echoes)) {}
  void take(const wire::LinkProbe& probe);
  void echo(const wire::LinkProbe& probe, ProbeCounts& counts);
  ProbeCounts& counts_of(const std::string& asker);
  [[nodiscard]] bool may_echo();

  std::string service_;
  bus::Clock* clock_;
  bus::Reader<wire::LinkProbe> probes_;
  bus::Writer<wire::LinkEcho> echoes_;
  std::map<std::string, Asker> askers_;
  bus::Clock::Instant second_began_;
  int echoes_in_second_ = 0;
  std::uint64_t not_echoed_ = 0;
  std::uint64_t forgotten_askers_ = 0;
};

} // namespace dyncal::services
