// What the virtual bench excites, from the options --frequencies, --levels and --multisine: sines
// one after the other, or all at once as lines of a waveform.
//
// Plain function; any thread.
#pragma once

#include <string>
#include <vector>

#include "drivers/virtual_bench/model/recording.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline programs::virtual_bench {

struct ExcitationWords {
  std::vector<std::string> frequencies{"10", "20", "40", "80", "160"}; // in Hz, decimal text
  std::vector<double> levels{10.0}; // in m/s^2, one, or one for each frequency
  double multisine_period_s = 0.0;  // 0: no multi-sine
};

// Frequencies, levels and phases of `programme`. Returns the highest acceleration in m/s^2, which
// the ranges of the instruments are for. Fails with bad_argument, and the option.
[[nodiscard]] Expected<double> read_excitation(const ExcitationWords& words,
                                               drivers::virtual_bench::Programme& programme);

} // namespace dyncal::inline programs::virtual_bench
