// A bench whose plan has two steps, 40 and 80 Hz at 10 m/s^2, with a generator over TCP: for tests
// of runs that play the analysis.
#pragma once

#include <string>

#include "services/bench/file/bench_file.hpp"

namespace dyncal::tests {

inline bench::BenchFile bench_of_two_steps(const std::string& name) {
  bench::BenchFile bench;
  bench.bench = name;
  bench.excitation.frequencies_hz = {"40", "80"};
  bench.excitation.levels_m_s2 = {10.0, 10.0};
  bench.excitation.settling_s = 0.5;
  bench.excitation.duration_s = 2.0;
  bench.generator.driver = bench::GeneratorDriver::scpi;
  bench.generator.level_per_volt = 5.0;
  bench.method.reference = {"acs", "reference"};
  bench.method.sync_acs = {"acs", "sync"};
  bench.method.sync_dau = {"dau", "sync"};
  bench.method.dut = {{"dau", "acceleration_x"}};
  return bench;
}

} // namespace dyncal::tests
