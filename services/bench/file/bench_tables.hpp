// The tables of a bench file. What cannot be is refused in the table; files that it names are
// looked up in `files`. Any thread.
#pragma once

#include <vector>

#include "services/bench/file/bench_file.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// [sources]: one source a table, with the keys that all have (driver, channels, units, time_base)
// and those of its driver. Instruments (smartup, socket) may have
//
//   nominal_rate_hz = 1000.0   as the instrument is set; 'dyncal check' holds the excitation list
//                              against half of it, and nothing else uses it
[[nodiscard]] std::vector<SourceSettings> read_sources(TomlTable table, NamedFiles& files);

// [method]: how the bench is evaluated, and which channel has which role.
//
//   kind = "analogue"              reference, dut: channels of one system
//   kind = "sample-timestamping"   reference, sync_acs, sync_dau, dut; in place of the first two
//                                  reference_table: a source with driver = "table"
//   kind = "series-timestamping"   reference, sync_acs, sync_dso, dut, shots = 5 (a step),
//                                  trigger_phase_correction = true
//   kind = "absolute-time"         reference, dut: stamped in UTC
//   temperature, frequency_search_rel, mains_hz, clock_tolerance_ppm, dut_phase:
//                                  with every kind
[[nodiscard]] MethodSettings read_method(TomlTable table,
                                         const std::vector<SourceSettings>& sources);

// [excitation]: which steps a run has, and what part of them is evaluated.
[[nodiscard]] ExcitationSettings read_excitation(TomlTable table);

// [generator]: what excites the bench, and the limits of its level. What cannot go together with
// this excitation is refused.
[[nodiscard]] GeneratorSettings read_generator(TomlTable table,
                                               const ExcitationSettings& excitation);
// The same table: what cannot go together with the sources and the method is refused.
void check_generator(TomlTable table, const BenchFile& file);

// [corrections]: what is known of ADC, trigger and delays beforehand.
//
//   adc = { file = "sync-adc.json", channel = "sync", phase_sign = "lag", test_amplitude_vpp = 2 }
//   reference = "reference.toml"                      the reference by its certificate, or its
//                                                     response alone (reference_file.hpp)
//   reference_delay_s = 0.0
//   dso_delay = { file = "dso-delay.json" }           value_s and u_s (standard uncertainty), as
//                                                     `dyncal calibrate dso-delay` writes them,
//   dso_delay = { value_s = 236e-9, u_s = 1e-9 }      or by hand
[[nodiscard]] CorrectionSettings read_corrections(TomlTable table, NamedFiles& files);

} // namespace dyncal::inline bench
