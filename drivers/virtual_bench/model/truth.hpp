// What the virtual bench knows and no service may see: the true transfer functions and everything
// that was drawn, as JSON for tests.
//
// Also the calibration of the sync ADC, which a laboratory does have, in the form of the public
// calibration files. Phase is lead in radians, within -pi..pi; the ADC file gives its phase as lag.
// Any thread.
#pragma once

#include <string>
#include <vector>

#include "drivers/virtual_bench/model/virtual_bench.hpp"

namespace dyncal::drivers::virtual_bench {

// `frequencies_hz` are decimal texts. REQUIRES: positive numbers.
[[nodiscard]] std::string truth_json(const VirtualBench& bench,
                                     const std::vector<std::string>& frequencies_hz);

// Three rows a frequency with the small scatter of a real calibration, test amplitude 19.5 V peak
// to peak, channel ADC1.
[[nodiscard]] std::string adc_calibration_json(const VirtualBench& bench,
                                               const std::vector<std::string>& frequencies_hz);

} // namespace dyncal::drivers::virtual_bench
