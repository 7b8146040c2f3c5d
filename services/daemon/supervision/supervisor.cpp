#include "services/daemon/supervision/supervisor.hpp"

namespace dyncal::services {

Expected<std::unique_ptr<Supervisor>> Supervisor::create(ProgramIdentity identity,
                                                         const std::string& metrics_address) {
  std::unique_ptr<Supervisor> supervisor(new Supervisor(std::move(identity)));
  services::report(supervisor->identity_, supervisor->store_);
  if (!metrics_address.empty()) {
    auto server = MetricsServer::start(metrics_address, supervisor->store_);
    if (!server) {
      return fail(server.error());
    }
    supervisor->server_ = std::move(*server);
  }
  return supervisor;
}

} // namespace dyncal::services
