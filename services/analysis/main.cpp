// dyncal-analysis: computes transfer functions from the samples that sources publish, and publishes
// the results.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "services/analysis/analysis_service.hpp"
#include "services/bus/host_network.hpp"
#include "services/program/program.hpp"
#include "services/version.hpp"

int main(int argc, char** argv) {
  using namespace dyncal;
  CLI::App app{"Computes the complex transfer function of digital sensors from samples on DDS and "
               "publishes it."};
  app.set_version_flag("--version", services::build_description());
  services::NetworkOptions network;
  services::add_network_options(app, network);
  CLI11_PARSE(app, argc, argv);

  services::set_up_log("dyncal-analysis");
  const std::stop_token stop = services::stop_on_signals();
  auto participant = services::join_network(network, "dyncal-analysis");
  if (!participant) {
    return services::report_error(participant.error());
  }
  services::AnalysisIdentity identity;
  identity.host = bus::host_name();
  identity.process_id = static_cast<std::uint32_t>(getpid());
  identity.service =
      fmt::format("analysis@{}:{}", identity.host, identity.process_id).substr(0, 64);
  identity.dds = network.dds;
  auto service = services::AnalysisService::create(std::move(*participant), std::move(identity));
  if (!service) {
    return services::report_error(service.error());
  }
  (*service)->serve(stop);
  return 0;
}
