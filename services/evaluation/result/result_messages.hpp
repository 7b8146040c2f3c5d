// Results as the contract's messages: made from them where they leave, and read where they come in.
//
// What a member appended to the contract carries is missing in messages of older writers: then
// covariances of fitted coefficients are 0, flags have no name, there is no temperature, and a mean
// has k = 2 with infinite degrees of freedom. Plain functions, any thread.
#pragma once

#include <optional>

#include "analysis/uncertainty/contribution.hpp"
#include "idl/dyncal.h"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/clock_report.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/evaluation/result/step_result.hpp"
#include "services/evaluation/result/transfer_function.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] wire::CalibrationResult to_message(const Recipe& recipe, const StepResult& result);
[[nodiscard]] StepResult from_message(const wire::CalibrationResult& message);

[[nodiscard]] wire::TransferFunction to_message(const Recipe& recipe,
                                                const TransferFunction& function);
// Without the unwrapped phases of the group delay, which stand in the points.
[[nodiscard]] TransferFunction from_message(const wire::TransferFunction& message);

[[nodiscard]] wire::SampleClockReport to_message(const Recipe& recipe, const ClockReport& report);
// Without what the message does not carry: statistics without events, number and regularity of
// pairs, untrusted samples.
[[nodiscard]] ClockReport from_message(const wire::SampleClockReport& message);

// A row of the uncertainty budget. What a program decides by travels as enums; the name goes with
// it for people. Infinite degrees of freedom are infinity in both. A message of a later version may
// have values that this one does not know: such a kind is read as `other` with the name as its
// subject, such a distribution as normal, and what repeats as common, which never averages.
[[nodiscard]] wire::BudgetContribution to_message(const analysis::Contribution& row);
[[nodiscard]] analysis::Contribution from_message(const wire::BudgetContribution& message);

// Which file the sync ADC was corrected by, so that whoever evaluates the run again can name it.
void add_adc_file(const std::optional<AdcFile>& file, wire::Measurement& measurement);
[[nodiscard]] std::optional<AdcFile> adc_file_of(const wire::Measurement& measurement);

} // namespace dyncal::inline evaluation
