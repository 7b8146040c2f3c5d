// From the samples of one excitation step to its results: cuts the four series out of the records,
// corrects the sync ADC, evaluates paper eqs. (1), (3), (4) and fills one CalibrationResult per
// channel.
//
// Samples whose stamp is not trusted (flags), whose stamp does not increase, or that were not
// measured (NaN) are left out and counted. A step that cannot be evaluated gives results that are
// not valid and name the reason; never a number. No state; belongs to the caller's thread. The same
// samples give the same bits.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "idl/dyncal.h"
#include "services/evaluation/recipe.hpp"
#include "services/evaluation/source_record.hpp"
#include "services/evaluation/step_message.hpp"

namespace dyncal::services {

// The channels under calibration: the recipe's, or all of the DAU but sync and temperature.
[[nodiscard]] std::vector<ChannelName> channels_under_calibration(const Recipe& recipe,
                                                                  const SourceRecord& dau);

[[nodiscard]] std::vector<wire::CalibrationResult>
evaluate_step(const Recipe& recipe, const RecipeStep& step, const SourceRecord& acs,
              const StretchOfTime& acs_stretch, const SourceRecord& dau,
              const StretchOfTime& dau_stretch, const std::vector<std::string>& flags);

// Of the DAU's sync ADC at the step's frequency, by the recipe's calibration; without one: no
// correction.
[[nodiscard]] analysis::Expected<analysis::AdcResponse> adc_response(const Recipe& recipe,
                                                                     const RecipeStep& step);

// What is published for a step that has no samples to evaluate.
[[nodiscard]] std::vector<wire::CalibrationResult>
results_of_missing_step(const Recipe& recipe, const RecipeStep& step, const SourceRecord& dau,
                        const std::string& problem);

} // namespace dyncal::services
