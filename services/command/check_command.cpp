#include "services/command/check_command.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/bench_check/checks.hpp"
#include "services/bench_check/report.hpp"
#include "services/command/work_progress.hpp"
#include "services/json_text.hpp"

namespace dyncal::services {

namespace {} // namespace

int run_check(const CheckCommand& command) {
  std::vector<bench_check::BenchView> views;
  bench_check::Findings findings;
  {
    const WorkProgress progress("reading what the bench names");
    for (const std::filesystem::path& path : command.bench_files) {
      views.push_back(bench_check::look_at_bench(path));
    }
    findings = bench_check::check_benches(views);
  }
  fmt::print("{}", command.json ? json_text(bench_check::as_json(findings, views), 2) + "\n"
                                : bench_check::as_text(findings));
  return bench_check::exit_status(findings);
}

} // namespace dyncal::services
