#include "services/programs/command/clock_offset_text.hpp"

#include <fmt/core.h>

#include "services/base/rounding.hpp"

namespace dyncal::inline programs {

std::string clock_offset_text(const ClockOffset& clock) {
  const RoundedValue offset = round_by_uncertainty(clock.offset_s, clock.bound_s);
  return fmt::format("{}{} s from ours (within {} s)", clock.offset_s > 0.0 ? "+" : "",
                     offset.value, offset.u);
}

} // namespace dyncal::inline programs
