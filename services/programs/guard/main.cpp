// dyncal-guard BENCH.toml...: runs where the generators of these benches can be reached, and
// switches an exciter off when the run that drives it has no conductor any more.
#include <charconv>
#include <memory>
#include <thread>
#include <vector>

#include <spdlog/spdlog.h>

#include "services/daemon/program/bench_program.hpp"
#include "services/daemon/program/daemon.hpp"
#include "services/daemon/supervision/supervisor.hpp"
#include "services/programs/guard/exciter_guard.hpp"

namespace dyncal::inline programs {
namespace {

// The settings of the generator that a bench file plans, and the reference that shows them.
GuardedExciter exciter_of(const BenchFile& bench) {
  GuardedExciter exciter;
  exciter.bench = bench.bench;
  exciter.generator = bench.generator.address;
  exciter.level_per_volt = bench.generator.level_per_volt;
  exciter.has_closed_loop = bench.generator.level_tolerance_rel.has_value();
  const SourceSettings* acs = bench.source(bench.method.reference.source);
  if (acs != nullptr && (acs->is<SocketSourceSettings>() || acs->is<AlsaSourceSettings>() ||
                         acs->is<AcsSourceSettings>())) {
    exciter.reference = bench.method.reference;
  }
  for (std::size_t i = 0; i < bench.excitation.frequencies_hz.size(); ++i) {
    OutputSettings settings;
    const std::string& text = bench.excitation.frequencies_hz[i];
    std::from_chars(text.data(), text.data() + text.size(), settings.frequency_hz);
    const bool has_own_voltage = !exciter.has_closed_loop && !bench.excitation.multisine;
    if (has_own_voltage && i < bench.excitation.levels_m_s2.size()) {
      settings.voltage_vpp = 2.0 * bench.excitation.levels_m_s2[i] / exciter.level_per_volt;
    }
    exciter.planned.push_back(settings);
  }
  return exciter;
}

Expected<void> serve(const std::vector<BenchFile>& benches, Daemon& daemon) {
  DYNCAL_TRY(daemon.join());
  const std::stop_token stop = daemon.stop();
  std::vector<std::unique_ptr<ExciterGuard>> guards;
  for (const BenchFile& bench : benches) {
    if (!is_instrument(bench.generator.driver)) {
      return fail(ErrorCode::bad_argument,
                  "bench '" + bench.bench +
                      "' has no generator that a program can switch off ([generator] driver): "
                      "there is nothing to guard");
    }
    DYNCAL_TRY(auto guard,
               ExciterGuard::create(
                   daemon.participant(), daemon.identity(), exciter_of(bench),
                   std::make_unique<GeneratorOutput>(bench.generator.address),
                   DrivenRecord(guard_state_folder(), bench.bench, bench.generator.address)));
    guards.push_back(std::move(guard));
    spdlog::info("bench {}: guarding the output of the generator {}", bench.bench,
                 bench.generator.address);
  }
  {
    std::vector<std::jthread> threads; // one a bench: a generator that does not answer takes time
    threads.reserve(guards.size());
    for (const auto& guard : guards) {
      threads.emplace_back([&] {
        guard->serve(stop, [&] {
          daemon.turned();
          daemon.supervisor().report(guard->figures());
        });
      });
    }
    daemon.supervisor().serving();
  }
  return {};
}

} // namespace
} // namespace dyncal::inline programs

int main(int argc, char** argv) {
  return dyncal::daemon::run_bench_program(
      argc, argv,
      {"dyncal-guard",
       "Switches the exciter of a bench off when nobody attends its run any more; runs on the "
       "bench's side, where the generator can be reached.",
       dyncal::serve});
}
