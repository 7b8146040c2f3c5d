// The contract's SampleClockReport: made from a report where it leaves, read where it comes in.
// Plain functions, any thread.
#pragma once

#include "idl/dyncal.h"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/clock_report.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] wire::SampleClockReport to_message(const Recipe& recipe, const ClockReport& report);
// Without what the message does not carry: statistics without events, number and regularity of
// pairs, untrusted samples.
[[nodiscard]] ClockReport from_message(const wire::SampleClockReport& message);

} // namespace dyncal::inline evaluation
