// `dyncal calibrate INSTRUMENT`: the command line of the calibrations of single instruments of a
// bench; each has a file of its own.
#pragma once

#include <stop_token>

#include "services/programs/command/calibrate_adc_command.hpp"
#include "services/programs/command/calibrate_dso_delay_command.hpp"
#include "services/programs/command/calibrate_time_command.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
}

namespace dyncal::inline programs {

struct CalibrateCommands {
  CalibrateAdcCommand adc;
  CalibrateDsoDelayCommand dso_delay;
  CalibrateTimeCommand time;
};

// The options are kept in `commands`, which must outlive the parsing.
void add_calibrate(CLI::App& app, CalibrateCommands& commands);

// REQUIRES: the command line was parsed and has the sub-command.
[[nodiscard]] int run_calibrate(const CLI::App& app, const CalibrateCommands& commands,
                                const std::stop_token& stop);

} // namespace dyncal::inline programs
