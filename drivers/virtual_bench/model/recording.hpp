// A whole programme of steps run without network and written as files, acs.csv and dau.csv, to play
// the same samples again and again.
//
// The steps follow the recipe of a run: all frequencies, then all again for the next repetition;
// the generator is off for 0.3 s before each step and at the end. Those of a multi-sine are excited
// at once, 3 s longer than is evaluated, for a search that looks at frames of a second. Stamps are
// the instruments' own; `sample_number` in dau.csv shows what the unit lost.
//
// Fails: refused when a file cannot be written. One thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/error.hpp"
#include "drivers/virtual_bench/model/virtual_bench.hpp"

namespace dyncal::drivers::virtual_bench {

struct Programme {
  std::vector<std::string> frequencies_hz; // decimal text
  std::vector<double> levels_m_s2;         // one per frequency
  int repetitions = 1;
  double settling_s = 0.5;
  double duration_s = 3.0; // per step, after settling
  // Of a multi-sine, of its voltages, one per frequency; empty: one frequency after the other.
  std::vector<double> phases_rad{};
};

[[nodiscard]] Expected<void> record_csv(VirtualBench& bench, const Programme& programme,
                                        const std::filesystem::path& folder);

} // namespace dyncal::drivers::virtual_bench
