#include <fmt/format.h>

#include "services/bench/file/generator_address.hpp"
#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/laboratory_view.hpp"

namespace dyncal::inline checks::doctor {
namespace {

Finding check_guard(const std::string& bench, const network::Service& guard) {
  const std::string subject = fmt::format("bench {}: dyncal-guard on {}", bench, guard.host);
  if (guard.health == network::Health::failed) {
    return {Severity::error, "guards", subject + ": " + guard.message};
  }
  return {Severity::ok, "guards",
          fmt::format("{} guards the output of the generator {}{}", subject,
                      guard.guarded_generator, guard.message.empty() ? "" : "; " + guard.message)};
}

std::optional<Finding> check_against(const BenchFile& bench, const LaboratoryView& view) {
  if (!is_instrument(bench.generator.driver)) {
    return std::nullopt;
  }
  std::string other_address;
  for (const auto& [key, guard] : view.guards) {
    if (key.first != bench.bench) {
      continue;
    }
    if (may_be_one_generator(guard.guarded_generator, bench.generator.address)) {
      return std::nullopt;
    }
    other_address = guard.guarded_generator;
  }
  if (!other_address.empty()) {
    return Finding{
        Severity::warning, "guards",
        fmt::format("bench {}: this bench file has the generator at {}, and dyncal-guard "
                    "switches off the one at {}: give both the same bench file",
                    bench.bench, bench.generator.address, other_address)};
  }
  return Finding{Severity::warning, "guards",
                 fmt::format("bench {}: no dyncal-guard is there: should the conductor of a run, "
                             "its host or its link fail, the exciter stays on; start dyncal-guard "
                             "with this bench file on a machine beside the generator",
                             bench.bench)};
}

} // namespace

Findings check_guards(const LaboratoryView& view, const std::optional<BenchFile>& bench) {
  Findings findings;
  for (const auto& [key, guard] : view.guards) {
    findings.push_back(check_guard(key.first, guard));
  }
  if (const auto lack = bench ? check_against(*bench, view) : std::nullopt) {
    findings.push_back(*lack);
  }
  if (findings.empty()) {
    findings.push_back({Severity::ok, "guards",
                        bench ? "nothing to guard: this bench drives no generator"
                              : "no dyncal-guard is there; a bench file tells whether one should"});
  }
  return findings;
}

} // namespace dyncal::inline checks::doctor
