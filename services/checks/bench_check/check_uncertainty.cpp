#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "services/checks/bench_check/checks.hpp"
#include "services/contract/role_rules.hpp"

namespace dyncal::inline checks::bench_check {
namespace {

// Whether the calibration of the reference states this uncertainty.
bool is_stated(const std::vector<analysis::ReferenceCalibrationPoint>& points,
               double analysis::ReferenceContribution::*u) {
  return std::ranges::any_of(points, [u](const analysis::ReferenceCalibrationPoint& point) {
    return std::ranges::any_of(point.contributions, [u](const auto& one) { return one.*u > 0.0; });
  });
}

// A misspelt key says it better.
bool is_misspelt(const BenchView& view, const std::string& key) {
  return std::ranges::any_of(view.problems, [&](const BenchProblem& problem) {
    return problem.key.starts_with("uncertainty.") &&
           problem.sentence.find(fmt::format("did you mean '{}'?", key)) != std::string::npos;
  });
}

void warn_without(const BenchView& view, const char* key, double value, const std::string& what,
                  Findings& findings) {
  if (value == 0.0 && !is_misspelt(view, key)) {
    findings.push_back(view.at(Severity::warning, {"uncertainty", key},
                               "is missing or zero: results state no uncertainty of " + what));
  }
}

// What no reference transducer in use is as bad as: certificates state per cents and degrees.
constexpr double doubtful_magnitude_rel = 0.05;
constexpr double doubtful_phase_rad = 0.1;

double largest(const std::vector<analysis::ReferenceCalibrationPoint>& points,
               double analysis::ReferenceContribution::*u) {
  double result = 0.0;
  for (const analysis::ReferenceCalibrationPoint& point : points) {
    for (const analysis::ReferenceContribution& one : point.contributions) {
      result = std::max(result, one.*u);
    }
  }
  return result;
}

void warn_if_doubtful(const BenchView& view, const KeyPath& key, double value, double doubtful,
                      const std::string& hint, Findings& findings) {
  if (value > doubtful) {
    findings.push_back(
        view.at(Severity::warning, key,
                fmt::format("states {:.3g} as standard uncertainty, more than {:g}: {}", value,
                            doubtful, hint)));
  }
}

void check_reference(const BenchView& view, Findings& findings) {
  using Contribution = analysis::ReferenceContribution;
  const char* const per_cent = "is it given in per cent, or with k = 2?";
  const char* const degrees = "is it given in degrees, or with k = 2?";
  const BenchFile& bench = view.bench;
  warn_if_doubtful(view, {"uncertainty", "reference_magnitude_rel"},
                   bench.uncertainty.reference_magnitude_rel, doubtful_magnitude_rel, per_cent,
                   findings);
  warn_if_doubtful(view, {"uncertainty", "reference_phase_rad"},
                   bench.uncertainty.reference_phase_rad, doubtful_phase_rad, degrees, findings);
  const auto& points = bench.corrections.reference;
  warn_if_doubtful(view, {"corrections", "reference"},
                   largest(points, &Contribution::u_magnitude_rel), doubtful_magnitude_rel,
                   per_cent, findings);
  warn_if_doubtful(view, {"corrections", "reference"}, largest(points, &Contribution::u_phase_rad),
                   doubtful_phase_rad, degrees, findings);
}

// How far a phase is from that of a chain that delays nothing, inverted or not.
double from_straight_rad(double phase_rad) {
  return std::abs(std::remainder(phase_rad, std::numbers::pi));
}

// What its file says beside the values, and how it says them.
void check_reference_file(const BenchView& view, Findings& findings) {
  const CorrectionSettings& corrections = view.bench.corrections;
  const KeyPath key{"corrections", "reference"};
  for (const std::string& note : corrections.reference_notes) {
    findings.push_back(view.at(Severity::note, key, "names a certificate that says: " + note));
  }
  if (!corrections.reference.empty() && corrections.reference_standard.devices.empty()) {
    findings.push_back(view.at(
        Severity::note, key,
        "names a table alone; in a reference file (reference.toml) it would stand beside the "
        "certificate, of which documents take name, number and days"));
  }
  const auto furthest = std::ranges::max_element(corrections.reference, {}, [](const auto& point) {
    return from_straight_rad(point.phase_rad);
  });
  if (corrections.reference_phase_in_rad && furthest != corrections.reference.end() &&
      from_straight_rad(furthest->phase_rad) > doubtful_phase_rad) {
    findings.push_back(view.at(Severity::warning, key,
                               fmt::format("states a phase of {:.3g} rad at {} Hz: is it given in "
                                           "degrees? then name the column phase_deg",
                                           furthest->phase_rad, furthest->frequency_hz)));
  }
}

void check_delays(const BenchView& view, Findings& findings) {
  const BenchFile& bench = view.bench;
  const EvaluationMethod kind = bench.method.kind;
  const bool own_clocks = has_own_clocks(bench.method.dut, bench.method.sync_dau);
  if (kind == EvaluationMethod::sample_timestamping && !own_clocks && !bench.corrections.adc) {
    warn_without(view, "adc_delay_s", bench.uncertainty.adc_delay_s,
                 "the delay of the unit's sync ADC, which has no calibration", findings);
  }
  if (kind == EvaluationMethod::absolute_time) {
    warn_without(view, "acs_delay_s", bench.uncertainty.acs_delay_s,
                 "the delay of the reference's channel and the ACS's clock", findings);
  } else {
    warn_without(view, "acs_delay_s", bench.uncertainty.acs_delay_s,
                 "the delay between the channels of the ACS", findings);
  }
  if (kind == EvaluationMethod::series_timestamping) {
    warn_without(view, "acs_rate_rel", bench.uncertainty.acs_rate_rel, "the ACS's clock", findings);
    if (bench.corrections.u_dso_delay_s == 0.0) {
      findings.push_back(view.at(
          Severity::warning, {"corrections", "dso_delay"},
          "is missing or has no uncertainty: results state none of the oscilloscope's trigger "
          "output; 'dyncal calibrate dso-delay' measures it"));
    }
  }
}

void check_can(const BenchView& view, Findings& findings) {
  for (const SourceSettings& source : view.bench.sources) {
    const auto* can = source.as<CanSourceSettings>();
    if (can != nullptr && can->latency_s != 0.0 && can->u_latency_s.value_or(0.0) == 0.0) {
      findings.push_back(view.at(Severity::warning, {"sources", source.name, "latency_s"},
                                 "has no u_latency_s: write the standard uncertainty of the "
                                 "latency, in seconds"));
    }
  }
}

} // namespace

Findings check_uncertainty(const BenchView& view) {
  Findings findings;
  const BenchFile& bench = view.bench;
  const auto& reference = bench.corrections.reference;
  using Contribution = analysis::ReferenceContribution;
  if (!is_stated(reference, &Contribution::u_magnitude_rel)) {
    warn_without(view, "reference_magnitude_rel", bench.uncertainty.reference_magnitude_rel,
                 "the reference's magnitude, which is the larger part of most budgets", findings);
  }
  if (!is_stated(reference, &Contribution::u_phase_rad)) {
    warn_without(view, "reference_phase_rad", bench.uncertainty.reference_phase_rad,
                 "the reference's phase", findings);
  }
  check_reference(view, findings);
  check_reference_file(view, findings);
  check_delays(view, findings);
  check_can(view, findings);
  return findings;
}

} // namespace dyncal::inline checks::bench_check
