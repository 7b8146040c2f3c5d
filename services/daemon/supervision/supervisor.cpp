#include "services/daemon/supervision/supervisor.hpp"

#include <spdlog/spdlog.h>

namespace dyncal::inline daemon {

Expected<std::unique_ptr<Supervisor>> Supervisor::create(ProgramIdentity identity,
                                                         const std::string& metrics_address) {
  std::unique_ptr<Supervisor> supervisor(new Supervisor(std::move(identity)));
  daemon::report(supervisor->identity_, supervisor->store_);
  if (!metrics_address.empty()) {
    DYNCAL_TRY(supervisor->server_, MetricsServer::start(metrics_address, supervisor->store_));
  }
  return supervisor;
}

void Supervisor::serving() {
  if (!line_.empty()) {
    spdlog::info("{}", line_);
  }
  manager_.serving(status_);
}

} // namespace dyncal::inline daemon
