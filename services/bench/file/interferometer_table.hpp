// The table [sources.NAME.interferometer] of a device that records the two quadrature signals of a
// laser interferometer (drivers/interferometer/README.md):
//
//   u1 = "u1"                       channels, as they are named after `channels`
//   u2 = "u2"
//   channel = "displacement"        that is made of them
//   direction = 1                   -1: the displacement has the other sign
//   passes = 1                      of the beam to the mirror and back; 2: double path
//   wavelength_vacuum_nm = 632.9908 that of a He-Ne laser where neither is stated
//   air = { temperature_degc = 23.0, pressure_pa = 101325.0, humidity_rel = 0.5 }
//                                   and their u_temperature_k, u_pressure_pa, u_humidity_rel
//   wavelength_nm = 632.8211        in air, in place of both
//   u_wavelength_rel = 1.5e-6       of the laser in vacuum, or of the wavelength in air
//   ellipse = "auto"                or a file (below)
//   detector_bandwidth_hz = 5e6     u_skew_s = 2e-9
//   output_rate_hz = 100000         record = "pairs"
//
// A file of an ellipse (TOML): p, q, R in the unit of the signals, r, alpha_rad; u_p, u_q, u_r,
// u_alpha_rad; periodic_error_rad, four amplitudes; turns_covered and `from`, in words.
//
// What cannot be is refused with its key. Any thread.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "drivers/interferometer/interferometer_settings.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// Of a source, where it has the table. The ranges of u1 and u2 become the interferometer's, and the
// nominal rate that which is published. REQUIRES: these have been read.
void read_interferometer(TomlTable& source_table, NamedFiles& files, SourceSettings& source);

// Fails (bad_file) with file, line and key.
[[nodiscard]] Expected<drivers::interferometer::StatedEllipse>
parse_ellipse_file(std::string_view text, const std::filesystem::path& path);

} // namespace dyncal::inline bench
