// The table [corrections] of a bench file: what is known of ADC, trigger and delays beforehand.
//
//   adc = { file = "sync-adc.json", channel = "sync", phase_sign = "lag", test_amplitude_vpp = 2 }
//   reference = "reference.csv"                      response of the reference (reference_file.hpp)
//   reference_delay_s = 0.0
//   dso_delay = { file = "dso-delay.json" }           as `dyncal calibrate dso-delay` writes it,
//   dso_delay = { value_s = 236e-9, u_s = 1e-9 }      or by hand
#pragma once

#include <filesystem>

#include "services/bench/file/bench_file.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// Files are looked up in `files`. What is not valid is refused in the table.
[[nodiscard]] CorrectionSettings read_corrections(TomlTable table, NamedFiles& files);

} // namespace dyncal::inline bench
