// dyncal-recorder: records what the benches of a laboratory tell each other, in MCAP files.
#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "services/daemon/program/daemon.hpp"
#include "services/daemon/program/options.hpp"
#include "services/daemon/supervision/supervisor.hpp"
#include "services/programs/recorder/bench_recordings.hpp"

namespace dyncal::inline programs {
namespace {

struct RecorderOptions {
  RecordingPlan plan;
  std::vector<std::string> benches;
  std::string compression = "none";
  double min_free_mb = 256.0;
};

void add_options(CLI::App& app, RecorderOptions& options) {
  app.add_option("--folder", options.plan.folder, "where the recordings go: FOLDER/BENCH/RUN.mcap")
      ->required();
  app.add_option("--bench", options.benches,
                 "record this bench (repeatable; default: every one that is heard of)");
  app.add_flag("--runs-only", options.plan.runs_only, "record nothing between runs");
  add_default(app, "--compression", options.compression, "none or zstd");
  add_default(app, "--min-free-mb", options.min_free_mb,
              "end the recording in order when the disk has less room than this, in MB",
              CLI::NonNegativeNumber);
}

Expected<void> serve(RecorderOptions& options, Daemon& daemon) {
  DYNCAL_TRY(const auto compression, recording::parse_compression(options.compression));
  for (const std::string& bench : options.benches) {
    DYNCAL_TRY(bus::check_bench_name(bench));
    options.plan.benches.insert(bench);
  }
  options.plan.options.compression = compression;
  options.plan.options.min_free_bytes = static_cast<std::uint64_t>(options.min_free_mb * 1e6);
  options.plan.options.dds = daemon.network.dds;
  options.plan.options.domain = daemon.network.domain;
  DYNCAL_TRY(daemon.join());
  DYNCAL_TRY(auto recordings, BenchRecordings::create(daemon.participant(), options.plan));
  daemon.supervisor().describe("recordings in " + options.plan.folder.string());
  daemon.supervisor().serving();
  spdlog::info("recorder ready ({}), recordings in {}", daemon.network.dds,
               options.plan.folder.string());
  for (const std::stop_token stop = daemon.stop(); !stop.stop_requested();) {
    recordings->work();
    for (const RecorderFigures& figures : recordings->figures()) {
      daemon.supervisor().report(figures);
    }
    daemon.turned();
  }
  return recordings->stop();
}

} // namespace
} // namespace dyncal::inline programs

int main(int argc, char** argv) {
  using namespace dyncal;
  RecorderOptions options;
  return run_daemon(
      argc, argv,
      {.name = "dyncal-recorder",
       .description = "Records every message of the benches of a laboratory in MCAP files, which "
                      "'dyncal analyse' evaluates again and many viewers open.",
       .add_options = [&](CLI::App& app) { add_options(app, options); },
       .serve = [&](Daemon& daemon) { return serve(options, daemon); }});
}
