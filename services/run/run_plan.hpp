// The plan of a run, from the bench file to the message that announces it: all frequencies in the
// order of the bench file, then all again for the next repetition; method, roles, corrections and
// uncertainties as the bench file gives them. Plain functions, any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/instrument/adc_calibration.hpp"
#include "idl/dyncal.h"
#include "services/bench/bench_file.hpp"

namespace dyncal::services {

[[nodiscard]] wire::Measurement
plan_measurement(const BenchFile& file, const std::string& run, std::int64_t now_utc_ns,
                 const std::vector<analysis::AdcCalibrationPoint>& adc_calibration);

} // namespace dyncal::services
