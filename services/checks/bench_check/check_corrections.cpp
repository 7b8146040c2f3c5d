#include <fmt/core.h>

#include "analysis/base/frequency.hpp"
#include "services/checks/bench_check/checks.hpp"
#include "services/contract/transverse_motion.hpp"

namespace dyncal::inline checks::bench_check {
namespace {

void check_reference(const BenchView& view, const analysis::Frequency& frequency, std::size_t entry,
                     Findings& findings) {
  const ExcitationSettings& excitation = view.bench.excitation;
  if (view.bench.corrections.reference.empty() || entry >= excitation.levels_m_s2.size()) {
    return;
  }
  const auto response = analysis::reference_response_at(
      view.bench.corrections.reference, frequency.hz(), excitation.levels_m_s2[entry]);
  if (!response) {
    findings.push_back(
        view.at(Severity::error, {"excitation", "frequencies_hz"},
                fmt::format("holds \"{}\", which corrections.reference does not "
                            "cover: {}",
                            excitation.frequencies_hz[entry], response.error().message),
                entry));
  }
}

void check_adc(const BenchView& view, const analysis::Frequency& frequency, std::size_t entry,
               Findings& findings) {
  if (view.adc.empty()) {
    return;
  }
  const auto response = analysis::adc_response_at(view.adc, frequency.hz());
  if (!response) {
    findings.push_back(
        view.at(Severity::error, {"excitation", "frequencies_hz"},
                fmt::format("holds \"{}\", which corrections.adc does not cover: {}",
                            view.bench.excitation.frequencies_hz[entry], response.error().message),
                entry));
  }
}

// A channel across the excited axis has no certificate at a frequency without it.
void check_transverse_motion(const BenchView& view, const analysis::Frequency& frequency,
                             std::size_t entry, Findings& findings) {
  const TransverseMotion& motion = view.bench.excitation.transverse_motion;
  if (!motion.points.empty() && !ratio_at(motion.points, frequency.hz())) {
    findings.push_back(
        view.at(Severity::warning, {"excitation", "frequencies_hz"},
                fmt::format("holds \"{}\", which excitation.transverse_motion does not cover: "
                            "documents will refuse channels across the axis",
                            view.bench.excitation.frequencies_hz[entry]),
                entry));
  }
}

} // namespace

Findings check_corrections(const BenchView& view) {
  Findings findings;
  const auto& frequencies = view.bench.excitation.frequencies_hz;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    if (const auto frequency = analysis::Frequency::parse(frequencies[i])) {
      check_reference(view, *frequency, i, findings);
      check_adc(view, *frequency, i, findings);
      check_transverse_motion(view, *frequency, i, findings);
    }
  }
  return findings;
}

} // namespace dyncal::inline checks::bench_check
