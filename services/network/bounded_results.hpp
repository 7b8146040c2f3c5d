// Shortens what came from the network to what is held of it: lists to their limits, texts to
// max_line_bytes (printable_text.hpp). Plain functions; any thread.
#pragma once

#include "services/evaluation/result/clock_report.hpp"
#include "services/evaluation/result/step_result.hpp"
#include "services/evaluation/result/transfer_function.hpp"
#include "services/network/limits.hpp"

namespace dyncal::network {

void bound(StepResult& result, const Limits& limits);
// The phase covariance, which is as large as the square of its points, is dropped.
void bound(TransferFunction& function, const Limits& limits);
void bound(ClockReport& report, const Limits& limits);

} // namespace dyncal::network
