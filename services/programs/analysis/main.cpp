// dyncal-analysis: computes transfer functions from the samples that sources publish, and publishes
// the results.
#include <fmt/core.h>

#include "services/daemon/program/daemon.hpp"
#include "services/daemon/supervision/supervisor.hpp"
#include "services/programs/analysis/analysis_service.hpp"

namespace {

using namespace dyncal;
using dyncal::fail;

Expected<void> serve(Daemon& daemon) {
  DYNCAL_TRY(daemon.join());
  Supervisor& supervisor = daemon.supervisor();
  AnalysisIdentity identity;
  identity.host = daemon.identity().host;
  identity.process_id = daemon.identity().process_id;
  identity.service =
      fmt::format("analysis@{}:{}", identity.host, identity.process_id).substr(0, 64);
  identity.dds = daemon.network.dds;
  supervisor.describe(fmt::format("{} on {}", identity.dds, identity.service));
  DYNCAL_TRY(const auto service,
             AnalysisService::create(std::move(daemon.participant()), std::move(identity)));
  supervisor.serving();
  service->serve(daemon.stop(), [&](const AnalysisFigures& figures) {
    supervisor.report(figures);
    supervisor.turned();
  });
  return {};
}

} // namespace

int main(int argc, char** argv) {
  return run_daemon(argc, argv,
                    {.name = "dyncal-analysis",
                     .description = "Computes the complex transfer function of digital sensors "
                                    "from samples on DDS and publishes it.",
                     .serve = serve});
}
