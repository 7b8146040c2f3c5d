// Listens on the bus and gives what was observed, LaboratoryView. It asks every program for its
// clock and sends it probes, and writes nothing else. Belongs to one thread.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/bus/host_clocks/clock_asker.hpp"
#include "services/bus/host_clocks/link_meter.hpp"
#include "services/checks/doctor/laboratory_view.hpp"
#include "services/network/bus_state.hpp"

namespace dyncal::inline checks::doctor {

class LaboratoryWatch {
public:
  // `participant` and `clock` outlive the object. Fails (network) as readers and writers do.
  [[nodiscard]] static Expected<std::unique_ptr<LaboratoryWatch>>
  open(bus::Participant& participant, const ProgramIdentity& own, bus::Clock& clock);

  // Takes what has come and asks when it is time; waits for 200 ms at most.
  void work();
  // Of everything since open(); announcements by multicast are left to the caller.
  [[nodiscard]] LaboratoryView view() const;

private:
  void take(const wire::SourceStatus& status, const bus::WriterId& writer);

  // Nothing of a laboratory is left out, however large.
  static constexpr std::size_t max_senders = 8; // of a source
  static constexpr network::Limits limits{.benches = 1024, .sources = 1024, .services = 1024};

  struct Readers {
    bus::Reader<wire::SourceDescription> descriptions;
    bus::Reader<wire::SourceStatus> statuses;
    bus::Reader<wire::ServiceStatus> services;
    std::shared_ptr<bus::WakeUp> wake_up; // of all of them
  };

  LaboratoryWatch(bus::Participant& participant, ProgramIdentity own, bus::Clock& clock,
                  Readers readers, ClockAsker asker, LinkMeter meter)
      : participant_(participant), clock_(clock), readers_(std::move(readers)),
        state_(clock, limits), asker_(std::move(asker)), meter_(std::move(meter)),
        own_(std::move(own)) {}

  bus::Participant& participant_;
  bus::Clock& clock_;
  Readers readers_;
  network::BusState state_;
  ClockAsker asker_;
  LinkMeter meter_;
  std::map<LaboratoryView::Key, std::set<std::string>> senders_;
  ProgramIdentity own_;
};

} // namespace dyncal::inline checks::doctor
