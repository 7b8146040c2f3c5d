// A bench file as a text, changed for one case each, and what the check finds in it.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/checks/bench_check/checks.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline checks::bench_check {

// Of a SmartUp Unit and an ACS; there is nothing to find but notes.
inline const std::string smartup_bench = R"(bench = "acc-1"
[excitation]
frequencies_hz = ["10", "80", "250"]
level = 10.0
repetitions = 2
duration_s = 3.0
[generator]
driver = "scpi"
address = "192.0.2.11:5025"
level_per_volt = 10.0
maximum_voltage_v = 5.0
maximum_level_m_s2 = 20.0
[sources.dau]
driver = "smartup"
listen = "0.0.0.0:7654"
sensor = "0xbccb0100"
nominal_rate_hz = 1000.0
[sources.acs]
driver = "socket"
address = "192.0.2.12:5026"
nominal_rate_hz = 10000.0
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_z"]
[uncertainty]
reference_magnitude_rel = 1e-3
reference_phase_rad = 1e-3
adc_delay_s = 1e-6
acs_delay_s = 1e-7
)";

inline std::string with(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  if (at == std::string::npos) {
    throw std::runtime_error("the bench has no " + what);
  }
  return text.replace(at, what.size(), by);
}

inline Findings check_text(const std::string& text, const std::string& path = "bench.toml") {
  const std::vector<BenchView> views{look_at_bench_text(text, path)};
  return check_benches(views);
}

inline std::vector<Finding> of(const Findings& findings, Severity severity) {
  std::vector<Finding> chosen;
  std::copy_if(findings.begin(), findings.end(), std::back_inserter(chosen),
               [&](const Finding& finding) { return finding.severity == severity; });
  return chosen;
}

} // namespace dyncal::inline checks::bench_check
