// What a bench must be for `dyncal calibrate adc` (calibrate_adc_command.cpp), and the bench file
// of one pass of it. Plain functions, any thread.
#pragma once

#include <optional>
#include <string>

#include "services/bench/file/bench_file.hpp"

namespace dyncal::inline programs {

// Of a source that does not stamp in UTC.
[[nodiscard]] std::string no_time_scale(const std::string& source);

// Fails (bad_file, bad_argument) with what is wrong and why.
[[nodiscard]] Expected<void> check_bench_for_adc(const BenchFile& bench, bool sets_amplitude);

// Sync is reference and channel under calibration, at that amplitude where one is given.
[[nodiscard]] BenchFile bench_of_adc_pass(const BenchFile& bench,
                                          std::optional<double> amplitude_vpp);

} // namespace dyncal::inline programs
