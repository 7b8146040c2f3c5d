#include "services/checks/bench_check/checks.hpp"

#include <algorithm>
#include <set>
#include <tuple>

namespace dyncal::inline checks::bench_check {

Findings check_benches(std::span<const BenchView> views) {
  Findings findings;
  std::set<std::pair<std::string, std::string>> refused; // files and keys
  for (const BenchView& view : views) {
    for (const BenchProblem& problem : view.problems) {
      findings.push_back(
          {Severity::error, problem.key, problem.sentence, problem.file, problem.line});
      refused.emplace(problem.file, problem.key);
    }
  }
  const auto add = [&](const Findings& more) {
    std::copy_if(more.begin(), more.end(), std::back_inserter(findings), [&](const Finding& one) {
      return !refused.contains({one.file, one.subject});
    });
  };
  for (const BenchView& view : views) {
    if (view.bench.sources.empty()) {
      continue; // not valid TOML, or nothing to look at
    }
    for (const auto check : {check_files, check_channels, check_rates, check_corrections,
                             check_levels, check_uncertainty, check_plan}) {
      add(check(view));
    }
  }
  add(check_collisions(views));
  std::stable_sort(findings.begin(), findings.end(), [&](const Finding& a, const Finding& b) {
    const auto place = [&](const Finding& one) {
      const auto of_file = std::ranges::find(
          views, one.file, [](const BenchView& view) { return view.bench.path.string(); });
      return std::tuple(of_file - views.begin(), one.line);
    };
    return place(a) < place(b);
  });
  return findings;
}

Findings find_errors_before_run(const BenchView& view) {
  Findings findings;
  for (const auto check :
       {check_channels, check_rates, check_corrections, check_levels, check_plan}) {
    for (Finding& finding : check(view)) {
      if (finding.severity == Severity::error) {
        findings.push_back(std::move(finding));
      }
    }
  }
  std::ranges::stable_sort(findings, {}, &Finding::line);
  return findings;
}

} // namespace dyncal::inline checks::bench_check
