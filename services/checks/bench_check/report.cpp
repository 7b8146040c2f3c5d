#include "services/checks/bench_check/report.hpp"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/printable_text.hpp"

namespace dyncal::inline checks::bench_check {
namespace {

std::size_t count(const Findings& findings, Severity severity) {
  return static_cast<std::size_t>(std::ranges::count(findings, severity, &Finding::severity));
}

std::string counted(std::size_t number, const char* what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

} // namespace

std::string as_text(const Findings& findings) {
  std::string text;
  for (const Finding& finding : findings) {
    const BenchProblem problem{finding.file, finding.line, finding.subject, finding.sentence};
    text += fmt::format("{}\n", one_line(problem.text(to_string(finding.severity))));
  }
  return text + fmt::format("{}, {}, {}\n", counted(count(findings, Severity::error), "error"),
                            counted(count(findings, Severity::warning), "warning"),
                            counted(count(findings, Severity::note), "note"));
}

nlohmann::ordered_json as_json(const Findings& findings, std::span<const BenchView> views) {
  using Json = nlohmann::ordered_json;
  Json benches = Json::array();
  for (const BenchView& view : views) {
    benches.push_back({{"file", view.bench.path.string()},
                       {"bench", view.bench.bench},
                       {"sha256", view.bench.sha256}});
  }
  Json list = Json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"severity", to_string(finding.severity)},
                    {"file", finding.file},
                    {"line", finding.line},
                    {"key", finding.subject},
                    {"sentence", finding.sentence}});
  }
  return {{"status", to_string(worst(findings))},
          {"benches", std::move(benches)},
          {"findings", std::move(list)}};
}

} // namespace dyncal::inline checks::bench_check
