// Bench files for tests of dyncal-dau.
#pragma once

#include <cstdint>
#include <string>

namespace dyncal::tests {

// A bench with its sources given as TOML, and a file as its analogue system.
inline std::string bench_text(const std::string& bench, const std::string& sources,
                              const std::string& dau = "dau") {
  return "bench = \"" + bench +
         "\"\n"
         "[excitation]\nfrequencies_hz = [\"10\"]\nlevel = 10.0\nrepetitions = 1\nsettling_s = "
         "0.5\nduration_s = 3.0\n"
         "[generator]\ndriver = \"none\"\n" +
         sources +
         "[sources.acs]\ndriver = \"socket\"\naddress = \"127.0.0.1:5026\"\n"
         "[method]\nkind = \"sample-timestamping\"\nreference = \"acs/reference\"\nsync_acs = "
         "\"acs/sync\"\nsync_dau = \"" +
         dau +
         "/sync\"\n"
         "[uncertainty]\nreference_magnitude_rel = 1e-3\nreference_phase_rad = 1e-3\n";
}

inline std::string smartup_source(const std::string& name, const std::string& listen,
                                  const std::string& sensor) {
  return "[sources." + name + "]\ndriver = \"smartup\"\nlisten = \"" + listen + "\"\nsensor = \"" +
         sensor + "\"\nchannels = { Data_11 = \"sync\" }\n";
}

} // namespace dyncal::tests
