#include "services/network/bus_readers.hpp"

#include "services/contract/topics.hpp"

namespace dyncal::network {

Expected<BusReaders> BusReaders::open(bus::Participant& participant, const std::string& bench,
                                      const ProgramIdentity& own, bus::Clock& clock,
                                      const std::shared_ptr<bus::WakeUp>& wake_up) {
  namespace topics = bus::topics;
  DYNCAL_TRY(auto descriptions, participant.reader(topics::source_description, bench, wake_up));
  DYNCAL_TRY(auto sources, participant.reader(topics::source_status, bench, wake_up));
  DYNCAL_TRY(auto measurements, participant.reader(topics::measurement, bench, wake_up));
  DYNCAL_TRY(auto excitation, participant.reader(topics::excitation, bench, wake_up));
  DYNCAL_TRY(auto services, participant.reader(topics::service_status, bench, wake_up));
  DYNCAL_TRY(auto recorders, participant.reader(topics::recorder_status, bench, wake_up));
  DYNCAL_TRY(auto results, participant.reader(topics::calibration_result, bench, wake_up));
  DYNCAL_TRY(auto functions, participant.reader(topics::transfer_function, bench, wake_up));
  DYNCAL_TRY(auto clocks, participant.reader(topics::sample_clock_report, bench, wake_up));
  DYNCAL_TRY(auto asker, ClockAsker::open(participant, own, clock, wake_up));
  return BusReaders(Readers{std::move(descriptions), std::move(sources), std::move(measurements),
                            std::move(excitation), std::move(services), std::move(recorders),
                            std::move(results), std::move(functions), std::move(clocks)},
                    std::move(asker));
}

void BusReaders::work(BusState& state) {
  const auto feed = [&](const auto& message) { state.take(message); };
  readers_.descriptions.take(feed);
  readers_.sources.take(feed);
  readers_.measurements.take(feed);
  readers_.excitation.take(feed);
  readers_.services.take(feed);
  readers_.recorders.take([&](const auto& message) { state.take_of_recorder(message); });
  readers_.results.take(feed);
  readers_.functions.take(feed);
  readers_.clocks.take(feed);
  asker_.work();
  state.set_programs(asker_.programs(), asker_.other_hosts());
  state.work();
}

} // namespace dyncal::network
