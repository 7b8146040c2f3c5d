// `dyncal check BENCH.toml...`: all that is wrong with bench files, and with them together
// (services/checks/bench_check); nothing is driven, and no network is used. Belongs to one thread.
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "drivers/generator/generator_identity.hpp"
#include "drivers/generator/left_over_state.hpp"
#include "drivers/link/scpi_answer.hpp"
#include "services/base/json_text.hpp"
#include "services/checks/bench_check/checks.hpp"
#include "services/checks/bench_check/report.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/work_progress.hpp"

namespace dyncal::inline programs {
namespace {

struct CheckOptions {
  std::vector<std::filesystem::path> bench_files;
  bool json = false;
  bool asks_generator = false; // who it is; nothing else is asked or driven
};

void add_check(CLI::App& command, CheckOptions& check) {
  command
      .add_option("BENCH.toml", check.bench_files,
                  "bench files; several are also held against each other")
      ->required();
  command.add_flag("--json", check.json, "print JSON");
  command.add_flag("--ask-generator", check.asks_generator,
                   "ask the generator who it is: another program's settings are read back only "
                   "where its family is known");
  command.footer(
      "Exit status: 0 no errors (there may be warnings), 2 wrong command line, 3 errors.");
}

// One of no known family may keep what another program left in it without a word.
void ask_generator(const bench_check::BenchView& view, Findings& findings) {
  const GeneratorSettings& generator = view.bench.generator;
  if (!is_instrument(generator.driver) || view.refused("generator.address")) {
    return;
  }
  const auto identity = drivers::generator::read_identity(generator.address);
  if (!identity) {
    findings.push_back(view.at(Severity::warning, {"generator", "address"},
                               fmt::format("cannot be asked: {}", identity.error().message)));
  } else if (!drivers::generator::family_of(*identity).is_known) {
    findings.push_back(view.at(
        Severity::warning, {"generator", "address"},
        fmt::format("is a generator of no family that dyncal knows ({}): a DC offset, burst, sweep "
                    "or modulation that another program left in it may not be read back; look at "
                    "its front panel before a run",
                    drivers::shown(*identity))));
  }
}

Expected<int> run_check(const CheckOptions& check) {
  std::vector<bench_check::BenchView> views;
  Findings findings;
  {
    const WorkProgress progress("reading what the bench names");
    for (const std::filesystem::path& path : check.bench_files) {
      views.push_back(bench_check::look_at_bench(path));
    }
    findings = bench_check::check_benches(views);
    for (const bench_check::BenchView& view : views) {
      if (check.asks_generator) {
        ask_generator(view, findings);
      }
    }
  }
  fmt::print("{}", check.json ? json_text(bench_check::as_json(findings, views), 2) + "\n"
                              : bench_check::as_text(findings));
  return worst(findings) >= Severity::error ? problems_found : 0;
}

const Command check_command{30, "check",
                            "validate bench files and the files they reference (dry run)",
                            add_check, run_check};

} // namespace
} // namespace dyncal::inline programs
