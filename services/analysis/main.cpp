// dyncal-analysis: computes transfer functions from the samples that sources publish, and publishes
// the results.
#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "services/analysis/analysis_service.hpp"
#include "services/host_clocks/clock_messages.hpp"
#include "services/host_clocks/clock_responder.hpp"
#include "services/program/command_line.hpp"
#include "services/program/program.hpp"
#include "services/program/watched_network.hpp"
#include "services/supervision/supervisor.hpp"
#include "services/version.hpp"

int main(int argc, char** argv) {
  using namespace dyncal;
  CLI::App app{"Computes the complex transfer function of digital sensors from samples on DDS and "
               "publishes it.",
               "dyncal-analysis"};
  app.set_version_flag("--version", services::build_description());
  services::NetworkOptions network;
  services::add_network_options(app, network);
  std::string metrics;
  services::add_metrics_option(app, metrics);
  if (const auto status = services::read_command_line(app, argc, argv)) {
    return *status;
  }

  services::set_up_log("dyncal-analysis");
  const auto joined =
      services::WatchedNetwork::join(network, "dyncal-analysis", services::stop_on_signals());
  if (!joined) {
    return services::report_error(joined.error());
  }
  const std::stop_token stop = (*joined)->stop();
  const auto created = services::Supervisor::create(
      services::this_program("dyncal-analysis", services::software_version(), network.dds),
      metrics);
  if (!created) {
    return services::report_error(created.error());
  }
  services::Supervisor& supervisor = **created;
  const auto clock = services::ClockResponder::start((*joined)->participant, supervisor.identity());
  if (!clock) {
    return services::report_error(clock.error());
  }
  services::AnalysisIdentity identity;
  identity.host = supervisor.identity().host;
  identity.process_id = supervisor.identity().process_id;
  identity.service =
      fmt::format("analysis@{}:{}", identity.host, identity.process_id).substr(0, 64);
  identity.dds = network.dds;
  supervisor.describe(fmt::format("{} on {}", identity.dds, identity.service));
  auto service =
      services::AnalysisService::create(std::move((*joined)->participant), std::move(identity));
  if (!service) {
    return services::report_error(service.error());
  }
  const std::stop_callback stopping(stop, [&] { supervisor.stopping(); });
  supervisor.serving();
  (*service)->serve(stop, [&](const services::AnalysisFigures& figures) {
    supervisor.report(figures);
    supervisor.turned();
  });
  const auto served = (*joined)->outcome({});
  return served ? 0 : services::report_error(served.error());
}
