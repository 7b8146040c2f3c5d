#include "drivers/can/time/system_clock.hpp"

#include <cmath>

#include <sys/timex.h>

namespace dyncal::drivers::can {

namespace {

constexpr double no_discipline_s =
    16.0; // the kernel's own bound for a clock that nobody looks after

} // namespace

double u_undisciplined_clock_s() {
  return no_discipline_s / std::sqrt(3.0);
}

ClockQuality system_clock_quality() {
  timex state{};
  const int status = ::adjtimex(&state);
  const double bound_s = status < 0 ? no_discipline_s : static_cast<double>(state.maxerror) * 1e-6;
  const bool synchronized = status >= 0 && status != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
  return {synchronized, (synchronized ? bound_s : no_discipline_s) / std::sqrt(3.0)};
}

} // namespace dyncal::drivers::can
