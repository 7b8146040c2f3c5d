// `dyncal calibrate INSTRUMENT`: the calibrations of single instruments of a bench, each in a file
// of its own.
#include "services/programs/command/command.hpp"

namespace dyncal::inline programs {
namespace {

const Command calibrate_command{260, "calibrate", "calibrate an instrument of the bench"};

} // namespace
} // namespace dyncal::inline programs
