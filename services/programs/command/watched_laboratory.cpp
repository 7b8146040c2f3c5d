#include "services/programs/command/watched_laboratory.hpp"

#include "services/base/version.hpp"
#include "services/bus/host_clocks/clock_messages.hpp"
#include "services/daemon/program/watched_network.hpp"

namespace dyncal::inline programs {

WatchedLaboratory::WatchedLaboratory(std::unique_ptr<WatchedNetwork> network,
                                     std::shared_ptr<bus::WakeUp> wake_up)
    : network_(std::move(network)), wake_up_(std::move(wake_up)), laboratory_(bus::system_clock()) {
}

WatchedLaboratory::~WatchedLaboratory() = default;

bool WatchedLaboratory::is_over() const {
  return network_->stop().stop_requested();
}

std::string WatchedLaboratory::strangers() const {
  return network_->strangers();
}

Expected<void> WatchedLaboratory::outcome() const {
  return network_->outcome({});
}

Expected<std::unique_ptr<WatchedLaboratory>> WatchedLaboratory::open(const NetworkOptions& network,
                                                                     const std::string& program,
                                                                     const std::string& bench,
                                                                     const std::stop_token& asked) {
  DYNCAL_TRY(auto joined, WatchedNetwork::join(network, program, asked));
  std::unique_ptr<WatchedLaboratory> watched(
      new WatchedLaboratory(std::move(joined), std::make_shared<bus::WakeUp>()));
  DYNCAL_TRY(auto readers,
             network::BusReaders::open(watched->network_->participant, bench,
                                       this_program(program, software_version(), network.dds),
                                       bus::system_clock(), watched->wake_up_));
  watched->readers_.emplace(std::move(readers));
  return watched;
}

void WatchedLaboratory::work(std::chrono::steady_clock::time_point until) {
  wake_up_->wait_until(until);
  readers_->work(laboratory_);
  laboratory_.work();
}

} // namespace dyncal::inline programs
