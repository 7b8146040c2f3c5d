// dyncal-recorder: records what the benches of a laboratory tell each other, in MCAP files.
#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "services/host_clocks/clock_responder.hpp"
#include "services/program/command_line.hpp"
#include "services/program/program.hpp"
#include "services/program/watched_network.hpp"
#include "services/recorder/bench_recordings.hpp"
#include "services/supervision/supervisor.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

struct RecorderProgram {
  NetworkOptions network;
  std::string metrics;
  RecordingPlan plan;
  std::vector<std::string> benches;
  std::string compression = "none";
  double min_free_mb = 256.0;
};

void add_options(CLI::App& app, RecorderProgram& program) {
  app.add_option("--folder", program.plan.folder, "where the recordings go: FOLDER/BENCH/RUN.mcap")
      ->required();
  app.add_option("--bench", program.benches,
                 "record this bench (repeatable; default: every one that is heard of)");
  app.add_flag("--runs-only", program.plan.runs_only, "record nothing between runs");
  app.add_option("--compression", program.compression, "none or zstd")->capture_default_str();
  app.add_option("--min-free-mb", program.min_free_mb,
                 "end the recording in order when the disk has less room than this, in MB")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  add_network_options(app, program.network);
  add_metrics_option(app, program.metrics);
}

Expected<void> serve(RecorderProgram& program, const std::stop_token& asked) {
  const auto compression = recording::parse_compression(program.compression);
  if (!compression) {
    return fail(compression.error());
  }
  for (const std::string& bench : program.benches) {
    if (const auto checked = bus::check_bench_name(bench); !checked) {
      return fail(checked.error());
    }
    program.plan.benches.insert(bench);
  }
  program.plan.options.compression = *compression;
  program.plan.options.min_free_bytes = static_cast<std::uint64_t>(program.min_free_mb * 1e6);
  program.plan.options.dds = program.network.dds;
  program.plan.options.domain = program.network.domain;
  auto joined = WatchedNetwork::join(program.network, "dyncal-recorder", asked);
  if (!joined) {
    return fail(joined.error());
  }
  bus::Participant& participant = (*joined)->participant;
  const std::stop_token stop = (*joined)->stop();
  const auto supervisor = Supervisor::create(
      this_program("dyncal-recorder", software_version(), program.network.dds), program.metrics);
  if (!supervisor) {
    return fail(supervisor.error());
  }
  const auto clock = ClockResponder::start(participant, (*supervisor)->identity());
  if (!clock) {
    return fail(clock.error());
  }
  auto recordings = BenchRecordings::create(participant, program.plan);
  if (!recordings) {
    return fail(recordings.error());
  }
  (*supervisor)->describe("recordings in " + program.plan.folder.string());
  const std::stop_callback stopping(stop, [&] { (*supervisor)->stopping(); });
  (*supervisor)->serving();
  spdlog::info("recorder ready ({}), recordings in {}", program.network.dds,
               program.plan.folder.string());
  while (!stop.stop_requested()) {
    (*recordings)->work();
    for (const RecorderFigures& figures : (*recordings)->figures()) {
      (*supervisor)->report(figures);
    }
    (*supervisor)->report_malformed_messages(participant.malformed_messages());
    (*supervisor)->report_refused_packets(participant.refused_packets()->count());
    (*supervisor)->turned();
  }
  return (*joined)->outcome((*recordings)->stop());
}

} // namespace
} // namespace dyncal::services

int main(int argc, char** argv) {
  using namespace dyncal;
  CLI::App app{"Records every message of the benches of a laboratory in MCAP files, which 'dyncal "
               "analyse' evaluates again and many viewers open.",
               "dyncal-recorder"};
  app.set_version_flag("--version", services::build_description());
  services::RecorderProgram program;
  services::add_options(app, program);
  if (const auto status = services::read_command_line(app, argc, argv)) {
    return *status;
  }
  services::set_up_log("dyncal-recorder");
  const std::stop_token stop = services::stop_on_signals();
  const auto served = services::serve(program, stop);
  if (!served) {
    return services::report_error(served.error());
  }
  services::finish_log();
  return 0;
}
