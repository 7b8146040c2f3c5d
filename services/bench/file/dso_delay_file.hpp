// The file that `dyncal calibrate dso-delay` writes and [corrections] dso_delay = { file = ... }
// names: JSON with "value_s" and "u_s", the delay of an oscilloscope's trigger output and its
// standard uncertainty in seconds; what else it holds is for people. Fails (bad_file), one
// sentence: missing or no JSON, one of the two is missing, not finite, or the uncertainty negative.
#pragma once

#include <filesystem>

#include "services/base/error.hpp"

namespace dyncal::inline bench {

struct DsoDelay {
  double value_s = 0.0;
  double u_s = 0.0;
};

[[nodiscard]] Expected<DsoDelay> read_dso_delay_file(const std::filesystem::path& path);

} // namespace dyncal::inline bench
