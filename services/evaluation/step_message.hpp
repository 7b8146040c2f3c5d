// The parts of a CalibrationResult message that results of every method are made of.
// Plain functions, any thread.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "analysis/method/transfer_point.hpp"
#include "idl/dyncal.h"
#include "services/evaluation/recipe.hpp"
#include "services/evaluation/source_record.hpp"
#include "services/evaluation/step_samples.hpp"

namespace dyncal::services {

// Everything but the numbers: not valid, magnitude and phase NaN.
[[nodiscard]] wire::CalibrationResult result_head(const Recipe& recipe, const RecipeStep& step,
                                                  const std::string& channel);
[[nodiscard]] wire::SineFit fit_message(const analysis::ChannelFit& channel);
[[nodiscard]] wire::SourceSamples samples_message(const SourceRecord& record,
                                                  const StepSamples& series,
                                                  const StretchOfTime& stretch);
void add_budget(std::span<const analysis::Contribution> budget, wire::CalibrationResult& result);

// The result of one channel: value, fits (those common to all channels first), budget. What it was
// made of is the caller's to add.
[[nodiscard]] wire::CalibrationResult
point_result(const Recipe& recipe, const RecipeStep& step, const ChannelName& name,
             const analysis::TransferPoint& point,
             std::span<const analysis::ChannelFit> common_fits);

// SHA-256 over stamps and values of all parts in their order.
[[nodiscard]] std::string digest_of(std::initializer_list<const StepSamples*> parts);

// Output per input, as D-SI knows it: "\one" when both are the same.
[[nodiscard]] std::string ratio_unit(const SourceRecord& acs, const std::string& reference,
                                     const SourceRecord& dut, const std::string& channel);

} // namespace dyncal::services
