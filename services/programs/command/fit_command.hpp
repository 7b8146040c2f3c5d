// `dyncal fit DATA.csv`: one sine approximation (paper eq. (1)) of a recorded series, for checking.
//
// With a frequency three parameters are fitted, without one four, the frequency shared by all
// columns. Phase is lead at the reference time: y = amplitude sin(w (t - t_ref) + phase_rad).
// Prints a table, or JSON with 17 digits. Belongs to one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dyncal::inline programs {

struct FitCommand {
  std::filesystem::path file;
  std::string frequency;                         // decimal text; empty: estimated
  std::vector<std::string> columns;              // empty: all
  std::optional<std::int64_t> reference_time_ns; // default: the first stamp
  int drift = 0;
  int harmonics = 1;                     // highest harmonic in the model
  std::vector<std::string> hum;          // decimal text of further lines
  std::optional<double> nominal_rate_hz; // the stamps are replaced by n / rate (paper section 3)
  bool json = false;
};

[[nodiscard]] int run_fit(const FitCommand& command);

} // namespace dyncal::inline programs
