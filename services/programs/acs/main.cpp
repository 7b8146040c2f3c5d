// dyncal-acs BENCH.toml...: publishes analogue calibration systems (their TCP streams, sound
// devices, or the tables that they write) and recorded series of any source.
#include <utility>
#include <variant>
#include <vector>

#include <fmt/core.h>

#include "services/daemon/program/bench_program.hpp"
#include "services/daemon/program/daemon.hpp"
#include "services/daemon/supervision/supervisor.hpp"
#include "services/instruments/played_source.hpp"
#include "services/instruments/table_source.hpp"
#include "services/stream/run_sources.hpp"

namespace {

using namespace dyncal;
using dyncal::fail;

// What gives samples, or evaluated steps.
class AcsSource {
public:
  explicit AcsSource(std::variant<PlayedSource, TableSource> source) : source_(std::move(source)) {}
  Expected<void> run(SourcePublisher& publisher, const std::stop_token& stop) {
    return std::visit([&](auto& source) { return source.run(publisher, stop); }, source_);
  }

private:
  std::variant<PlayedSource, TableSource> source_;
};

using Sources = std::vector<RunnableSource<AcsSource>>;

bool is_ours(const SourceSettings& settings) {
  return settings.is<SocketSourceSettings>() || settings.is<AlsaSourceSettings>() ||
         settings.is<FileSourceSettings>() || settings.is<AcsSourceSettings>() ||
         settings.is<TableSourceSettings>();
}

Expected<AcsSource> prepare(const SourceSettings& settings, const std::stop_token& stop) {
  if (settings.is<TableSourceSettings>()) {
    DYNCAL_TRY(auto table, TableSource::prepare(settings));
    return AcsSource(std::move(table));
  }
  DYNCAL_TRY(auto played, PlayedSource::prepare(settings, stop));
  return AcsSource(std::move(played));
}

Expected<Sources> prepare(const std::vector<BenchFile>& benches, const std::stop_token& stop) {
  Sources sources;
  for (const BenchFile& bench : benches) {
    for (const SourceSettings& settings : bench.sources) {
      if (!is_ours(settings)) {
        continue; // dyncal-dau, dyncal-can or dyncal-dso publishes it
      }
      auto source = prepare(settings, stop);
      if (!source) {
        return fail(source.error().code,
                    fmt::format("{}: {}", bench.path.string(), source.error().message));
      }
      sources.push_back({std::move(*source), options_of(bench, settings)});
    }
  }
  if (sources.empty()) {
    return fail(
        ErrorCode::bad_argument,
        "no source in the bench files given is an analogue calibration system, a sound "
        "device, a table or a file (driver \"socket\", \"alsa\", \"table\", \"file\", ...)");
  }
  return sources;
}

Expected<void> serve(const std::vector<BenchFile>& benches, Daemon& daemon) {
  DYNCAL_TRY(auto sources, prepare(benches, daemon.stop()));
  DYNCAL_TRY(daemon.join());
  return run_sources(daemon, sources);
}

} // namespace

int main(int argc, char** argv) {
  return run_bench_program(
      argc, argv,
      {.name = "dyncal-acs",
       .description =
           "Publishes the sources of bench files whose driver is \"socket\" (an analogue "
           "calibration system's TCP stream), \"alsa\" (a sound device), \"text-stream\" (lines of "
           "numbers), \"table\" (the table of a system that evaluates itself) or \"file\" (a "
           "recorded series).",
       .serve = serve,
       .publishes_samples = true});
}
